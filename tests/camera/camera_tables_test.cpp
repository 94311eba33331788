// SPDX-License-Identifier: Apache-2.0
// Tables of cameras for another processor.
#include "petzval/camera/camera_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../message.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/io/write_file.hpp"

namespace petzval {
namespace {

constexpr Film film{.width_mm = 24, .height_mm = 16, .shift_x_mm = 2};

TEST(CameraTables, ReadBackByteForByte) {
  const std::vector<float> tables =
      Camera(testing::data_lens("tessar_100mm_f2.8"), film, {.model = ModelKind::polynomial(5)}).tables();
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_camera_tables.bin";
  write_floats(tables, file);
  EXPECT_EQ(std::filesystem::file_size(file), 4 * tables.size());
  EXPECT_EQ(read_floats(file), tables);
  write_file("12345", file);
  EXPECT_NE(testing::message([&] { read_floats(file); }).find("size = 5 bytes"), std::string::npos);
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
        (void)fault(bad);  // throws or not, and reads nothing beyond the list
      }
    }
    const auto changed = [&](CameraTables::Position at, float value) {
      std::vector<float> bad = good;
      bad[at] = value;
      return fault(bad);
    };
    EXPECT_NE(changed(CameraTables::primary_wavelength, 7).find("7 at position 3, wanted 0 to 0"), std::string::npos);
    EXPECT_NE(changed(CameraTables::wavelengths, 3).find("begins at 3"), std::string::npos);
    EXPECT_NE(changed(CameraTables::wavelength_count, 0), "no error");
    EXPECT_NE(changed(CameraTables::model, 77), "no error");
  }
  EXPECT_NE(fault({}).find("camera tables of format 4"), std::string::npos);
  const auto refusal = [&](const Lens& of, const Film& on, ModelKind model) {
    return testing::message([&] { Camera(of, on, {.model = model}).tables(); });
  };
  EXPECT_NE(refusal(lens, {.tilt_rad = 0.1}, ModelKind::thick).find("tilted or travels"), std::string::npos);
}

}  // namespace
}  // namespace petzval
