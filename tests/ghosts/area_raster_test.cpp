// SPDX-License-Identifier: Apache-2.0
// Sums of polygons over pixels, against polygons that are clipped at every pixel.
#include "ghosts/area_raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace petzval {
namespace area_raster_test {

using ghosts_detail::AreaRaster;
using Points = std::vector<Vec2<double>>;

double area(const Points& p) {
  double twice = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto &a = p[k], &b = p[(k + 1) % p.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

/// Sutherland and Hodgman's algorithm for one edge of a pixel: keeps sign * (p[axis] - limit) >= 0.
Points clipped(const Points& p, int axis, double limit, double sign) {
  Points result;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto &a = p[k], &b = p[(k + 1) % p.size()];
    const double u = sign * (a[axis] - limit), v = sign * (b[axis] - limit);
    if (u >= 0) result.push_back(a);
    if ((u >= 0) != (v >= 0)) result.push_back(a + (b - a) * (u / (u - v)));
  }
  return result;
}

double in_pixel(Points p, double column, double row) {
  p = clipped(clipped(p, 0, column, 1), 0, column + 1, -1);
  p = clipped(clipped(p, 1, row, 1), 1, row + 1, -1);
  return area(p);
}

TEST(AreaRaster, SumsEqualClippedPolygons) {
  constexpr std::size_t columns = 9, rows = 7;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-6, 14), size(-8, 8);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec2<double> at{place(random), place(random)}, a{size(random), size(random)}, b{size(random), size(random)};
    const double fraction = trial % 3 == 0 ? 0.02 : 1;
    const Points polygon{at, at + a * fraction, at + (a + b) * fraction, at + b * fraction};
    if (area(polygon) < 0.02 * 20) continue;
    AreaRaster raster(columns, rows);
    raster.add(polygon, 3, 0, 4);
    raster.add(polygon, 3, 4, rows);
    for (std::size_t row = 0; row < rows; ++row) {
      std::vector<double> values(columns);
      raster.read(row, values);
      for (std::size_t k = 0; k < columns; ++k) {
        const double expected = 3 * in_pixel(polygon, static_cast<double>(k), static_cast<double>(row)) / area(polygon);
        ASSERT_NEAR(values[k], expected, 1e-12) << "trial " << trial << ", pixel " << k << ", " << row;
      }
    }
  }
}

TEST(AreaRaster, LinesAndPointsKeepTheirEnergy) {
  const std::vector<Points> thin{{{2.3, 4.1}, {2.3, 4.1}, {2.3, 4.1}, {2.3, 4.1}},
                                 {{1, 1}, {6, 5}, {6, 5}, {1, 1}},
                                 {{1, 1}, {3, 3}, {5, 5}},
                                 {{3, 1}, {3, 6}, {3 + 1e-9, 6}, {3 + 1e-9, 1}},
                                 {{5.1, 5.1}, {5.1 + 1e-7, 5.1}, {5.1 + 1e-7, 5.1 + 1e-7}, {5.1, 5.1 + 1e-7}}};
  for (const Points& polygon : thin) {
    AreaRaster raster(8, 8);
    raster.add(polygon, 2, 0, 8);
    double sum = 0, least = 0;
    for (std::size_t row = 0; row < 8; ++row) {
      std::vector<double> values(8);
      raster.read(row, values);
      for (const double value : values) sum += value, least = std::min(least, value);
    }
    EXPECT_NEAR(sum, 2, 1e-12);
    EXPECT_GT(least, -1e-12);
  }
}

}  // namespace area_raster_test
}  // namespace petzval
