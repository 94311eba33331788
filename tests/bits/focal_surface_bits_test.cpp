// SPDX-License-Identifier: Apache-2.0
// Focal surfaces have the same bits on every instruction set and compiler, so that an image rendered on several
// machines shows no seams.
#include <gtest/gtest.h>

#include <vector>

#include "hash.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/film.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace focal_surface_bits_test {

TEST(FocalSurfaceBits, EqualTheTable) {
  const Film film{.width_mm = 36, .height_mm = 24, .columns = 90, .rows = 60, .z_mm = 50};
  std::vector<FocalPoint> points;
  for (int i = 0; i < 70; ++i) {
    points.push_back(
        {.film_point = {-17 + 7 * (i % 6) * 0.9, -11 + 0.3125 * i}, .inverse_distance = 0.0005 + 0.00001 * (i % 13)});
  }
  testing_bits::Hash hash;
  for (const SurfaceKind kind : {SurfaceKind::affine, SurfaceKind::shepard}) {
    for (const double beta : {2.0, 2.5, 3.0}) {
      const FocalSurface surface(thin_lens(50, 2), film, points, {.kind = kind, .beta = beta});
      std::vector<double> distances(static_cast<std::size_t>(film.columns * film.rows));
      surface.frame<double>(film, 1, distances.data(), nullptr);
      for (const double value : distances) hash.take(value);
    }
  }
  EXPECT_EQ(hash.value(), 17889357273939156048u);
}

}  // namespace focal_surface_bits_test
}  // namespace petzval
