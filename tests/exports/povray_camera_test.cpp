// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <glm/geometric.hpp>
#include <sstream>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/exports/renderer_cameras.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace povray_camera_test {

TEST(PovrayCamera, RaysOfAPixelMeetInItsImage) {
  constexpr double subject_mm = 2000;
  const Camera camera(with_focus(testing::data_lens("double_gauss_100mm_f2.0"), subject_mm), {.columns = 12, .rows = 8},
                      {.model = ModelKind::exact_double, .normalisation = Normalisation::unity_on_axis});
  std::istringstream lines(format_povray_camera(camera, 4));
  int pixel = 0, kept = 0;
  for (std::string line; std::getline(lines, line);) {
    Vec3<double> a, b, c;
    if (line.starts_with("#declare petzval_mesh")) pixel = camera.film().columns;  // there is no first row
    if (std::sscanf(line.c_str(), "triangle{<%lf,%lf,%lf>,<%lf,%lf,%lf>,<%lf,%lf,%lf>}", &a.x, &a.y, &a.z, &b.x, &b.y,
                    &b.z, &c.x, &c.y, &c.z) != 9) {
      continue;
    }
    const int column = pixel % camera.film().columns, row = pixel / camera.film().columns;
    ++pixel;
    const Vec3<double> origin = (a + b + c) / 3.0, normal = glm::cross(c - a, b - a);
    if (origin.z < -1e4) continue;  // dropped
    ++kept;
    const Vec3<double> at = origin + normal * ((subject_mm - origin.z) / normal.z);
    const Vec2<double> raster = camera.project({at.x, at.y, -at.z}).raster;
    EXPECT_NEAR(raster.x, column + 0.5, 0.55);
    EXPECT_NEAR(raster.y, row + 0.5, 0.55);
  }
  EXPECT_GT(kept, 100);
  EXPECT_EQ(pixel, 96);
  testing::expect_error([&] { format_povray_camera(camera, 0); }, {"samples", 0});
}

}  // namespace povray_camera_test
}  // namespace petzval
