// SPDX-License-Identifier: Apache-2.0
// Camera tables for another processor.
#include "camera/camera_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

using testing::expect_error;

constexpr Film film{.width_mm = 24, .height_mm = 16, .shift_x_mm = 2};

TEST(CameraTables, RoundTripKeepsEveryByte) {
  const std::vector<float> tables =
      camera_tables(Camera(testing::data_lens("tessar_100mm_f2.8"), film, {.model = ModelKind::polynomial(5)}));
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_camera_tables.bin";
  write_floats(tables, file);
  EXPECT_EQ(std::filesystem::file_size(file), 4 * tables.size());
  EXPECT_EQ(read_floats(file), tables);
  write_file("12345", file);
  testing::expect_error([&] { read_floats(file); }, {file, 5, "bytes"});
  std::filesystem::remove(file);
}

TEST(CameraTables, InvalidTablesAreRefused) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const auto check = [](const std::vector<float>& tables) { CameraTables::check(tables, "file"); };
  const Lens cylinders = testing::data_lens("anamorphic_60mm_2x");
  for (const Camera& camera :
       {Camera(lens, film, {.model = ModelKind::thick}), Camera(lens, film, {.model = ModelKind::polynomial(5)}),
        Camera(lens, film, {.model = ModelKind::exact_float}),
        Camera(cylinders, film, {.model = ModelKind::polynomial(5)}),
        Camera(with_iris(lens, {.blades = 7, .rotation_rad = 1}), film, {.model = ModelKind::exact_float})}) {
    const std::vector<float> good = camera_tables(camera);
    EXPECT_NO_THROW(check(good));
    expect_error([&] { check({good.begin(), good.end() - 1}); }, {"file"});
    for (std::size_t at = 0; at < CameraTables::head_size; ++at) {
      for (const float value : {std::nanf(""), 0.f, 1.f, 7.f, 31.f, 1000.f, 1e6f}) {
        std::vector<float> bad = good;
        bad[at] = value;
        try {
          check(bad);  // must not read beyond the list
        } catch (const Error&) {
        }
      }
    }
    const auto changed = [&](CameraTables::Position at, float value) {
      std::vector<float> bad = good;
      bad[at] = value;
      return [&check, bad] { check(bad); };
    };
    expect_error(changed(CameraTables::primary_wavelength, 7), {"file", 7, 3, 0});
    expect_error(changed(CameraTables::wavelengths, 3), {"file", 3});
    expect_error(changed(CameraTables::wavelength_count, 0), {"file"});
    expect_error(changed(CameraTables::model, 77), {"file"});
  }
  expect_error([&] { check({}); }, {"file", "format", 4});
  const Camera tilted(lens, {.tilt_rad = 0.1}, {.model = ModelKind::thick});
  expect_error([&] { camera_tables(tilted); }, {lens.name(), "tilted"});
}

}  // namespace
}  // namespace petzval
