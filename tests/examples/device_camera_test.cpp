// SPDX-License-Identifier: Apache-2.0
// Tables of cameras, and a camera that samples from nothing else.
#include "hosts/device_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/error.hpp"
#include "petzval/io/write_file.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace {

using testing::expect_error;
using testing::expect_tokens;

/// Every ray of the tables alone is the camera's.
void expect_same_rays(const Camera& camera) {
  const std::vector<float> tables = camera.tables();
  CameraTables::check(tables, "tables");
  const core_detail::Kronecker<4> random(4);
  constexpr int count = 2000;
  int passed = 0, others = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [a, b, u, v] = random(i);
    const FilmPoint film = camera.film().point(a * camera.film().columns, b * camera.film().rows);
    for (std::size_t w = 0; w < camera.lens().wavelengths_nm().size(); ++w) {
      const CameraRay wanted = camera.sample({film, u, v, w});
      const hosts::DeviceRay found =
          hosts::sample(tables.data(), static_cast<float>(film.x), static_cast<float>(film.y), static_cast<float>(u),
                        static_cast<float>(v), static_cast<int>(w));
      passed += wanted ? 1 : 0;
      if ((wanted.weight > 0) != (found.weight > 0)) {
        ++others;  // on a rim
        continue;
      }
      if (!wanted) continue;
      EXPECT_NEAR(found.weight / wanted.weight, 1, 1e-4);
      const auto vector = [](const float* p) { return Vec3<double>(p[0], p[1], p[2]); };
      EXPECT_NEAR(glm::length(vector(found.direction) - wanted.ray.direction), 0, 2e-5);
      const double size = 1 + glm::length(wanted.ray.origin);
      EXPECT_NEAR(glm::length(vector(found.origin) - wanted.ray.origin), 0, 3e-5 * size);
    }
  }
  EXPECT_GT(passed, count / 2);
  EXPECT_LE(others, count / 200);
}

constexpr Film film{.width_mm = 24, .height_mm = 16, .shift_x_mm = 2};

TEST(DeviceCamera, SamplesTheRaysOfEveryModel) {
  const Lens lens = compile(testing::data_prescription("double_gauss_100mm_f1.35"), std::array{486.1327, 587.5618},
                            {.missing_glass = MissingGlass::abbe});
  for (const ModelKind model : models()) {
    SCOPED_TRACE(name(model));
    expect_same_rays(Camera(lens, film, {.model = model, .normalisation = Normalisation::unity_on_axis}));
  }
}

TEST(DeviceCamera, SamplesBladesMirrorsAspheresAndCylinders) {
  const Lens blades =
      with_iris(testing::data_lens("double_gauss_100mm_f1.35"), {.blades = 5, .roundness = -0.5, .rotation_rad = 0.4});
  for (const ModelKind model :
       {ModelKind::thin_two_disc, ModelKind::thick, ModelKind::polynomial(7), ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    expect_same_rays(Camera(blades, film, {.model = model}));
  }
  const Film small{.width_mm = 12, .height_mm = 8};
  expect_same_rays(
      Camera(testing::data_lens("catadioptric_mangin_1000mm_f7.5"), small, {.model = ModelKind::exact_double}));
  expect_same_rays(Camera(testing::data_lens("phone_5.6mm_f3.5"), {.width_mm = 4, .height_mm = 3},
                          {.model = ModelKind::exact_double}));
  const Lens cylinders = with_f_number(testing::data_lens("anamorphic_60mm_2x"), 8);
  for (const ModelKind model : {ModelKind::thick, ModelKind::polynomial(3), ModelKind::polynomial(7),
                                ModelKind::polynomial(11), ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    expect_same_rays(Camera(cylinders, {.width_mm = 20, .height_mm = 14, .shift_y_mm = 1}, {.model = model}));
    expect_same_rays(Camera(testing::data_lens("anamorphic_60mm_2x"), small, {.model = model}));
  }
}

TEST(CameraTables, ReadBackByteForByte) {
  const std::vector<float> tables =
      Camera(testing::data_lens("tessar_100mm_f2.8"), film, {.model = ModelKind::polynomial(5)}).tables();
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_camera_tables.bin";
  write_floats(tables, file);
  EXPECT_EQ(std::filesystem::file_size(file), 4 * tables.size());
  EXPECT_EQ(read_floats(file), tables);
  write_file("12345", file);
  expect_error([&] { read_floats(file); }, {file, 5});
  std::filesystem::remove(file);
}

TEST(CameraTables, AreRefusedWhereTheyAreNone) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const auto fault = [](const std::vector<float>& tables) {
    return testing::message([&] { CameraTables::check(tables, "file"); });
  };
  const Lens cylinders = testing::data_lens("anamorphic_60mm_2x");
  for (const Camera& camera :
       {Camera(lens, film, {.model = ModelKind::thick}), Camera(lens, film, {.model = ModelKind::polynomial(5)}),
        Camera(lens, film, {.model = ModelKind::exact_float}),
        Camera(cylinders, film, {.model = ModelKind::polynomial(5)}),
        Camera(with_iris(lens, {.blades = 7, .rotation_rad = 1}), film, {.model = ModelKind::exact_float})}) {
    const std::vector<float> good = camera.tables();
    EXPECT_EQ(fault(good), "no error");
    EXPECT_NE(fault({good.begin(), good.end() - 1}), "no error");
    for (std::size_t at = 0; at < CameraTables::head_size; ++at) {
      for (const float value : {std::nanf(""), 0.f, 1.f, 7.f, 31.f, 1000.f, 1e6f}) {
        std::vector<float> bad = good;
        bad[at] = value;
        if (fault(bad) != "no error") continue;
        for (const float x : {0.f, 5.f, 17.f}) hosts::sample(bad.data(), x, -x / 2, 0.3f, 0.7f, 0);  // within bounds
      }
    }
    const auto changed = [&](CameraTables::Position at, float value) {
      std::vector<float> bad = good;
      bad[at] = value;
      return fault(bad);
    };
    expect_tokens(changed(CameraTables::primary_wavelength, 7), {"file", 7, "position 3"});
    expect_tokens(changed(CameraTables::wavelengths, 3), {"file", 3});
    EXPECT_NE(changed(CameraTables::wavelength_count, 0), "no error");
    EXPECT_NE(changed(CameraTables::model, 77), "no error");
  }
  expect_tokens(fault({}), {"file", "format", 3});
  const auto refusal = [&](const Lens& of, const Film& on, ModelKind model) {
    return testing::message([&] { Camera(of, on, {.model = model}).tables(); });
  };
  expect_tokens(refusal(lens, {.tilt_rad = 0.1}, ModelKind::thick), {"tilted"});
}

}  // namespace
}  // namespace petzval
