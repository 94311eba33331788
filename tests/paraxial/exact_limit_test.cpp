// SPDX-License-Identifier: Apache-2.0
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../data_lenses.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace exact_limit_test {

using Jet = ceres::Jet<double, 2>;

// The derivatives of the exact ray at the axis with respect to height and slope are the paraxial matrix.
TEST(RayMatrix, EqualsTheDerivativeOfTheExactRay) {
  for (const Prescription& prescription : testing::data_prescriptions()) {
    const Lens lens = compile(prescription);
    const double n = signed_index(lens, 0), n_image = signed_index(lens, lens.surface_count());
    double track = 1;
    for (const LensSurface& s : lens.surfaces()) track += std::abs(s.thickness);
    for (const Meridian meridian : {Meridian::y, Meridian::x}) {
      SCOPED_TRACE(prescription.id + (meridian == Meridian::y ? " y" : " x"));
      const Jet zero(0.0), height(0.0, 0), slope(0.0, 1);
      const bool y = meridian == Meridian::y;
      const kernel::Vec<Jet> origin{y ? zero : height, y ? height : zero, zero};
      const kernel::Vec<Jet> direction{y ? zero : slope, y ? slope : zero, Jet(1.0)};
      const auto end = kernel::trace(petzval::kernel::view<double>(lens), origin, direction, {.apertures = false});
      ASSERT_EQ(end.fate, RayFate::transmitted);
      const Jet at_last = y ? end.origin.y : end.origin.x;
      const Jet slope_behind = (y ? end.direction.y : end.direction.x) / end.direction.z;

      const RayMatrix m = ray_matrix(lens, 0, lens.surface_count(), 0, meridian);
      const double bound = 1e-12 * std::max(1.0, std::max(std::abs(m.a), std::abs(m.d)));
      EXPECT_NEAR(at_last.v[0], m.a, bound);
      EXPECT_NEAR(at_last.v[1], m.b * n, bound * track);
      EXPECT_NEAR(slope_behind.v[0], m.c / n_image, 1e-12 * std::max(std::abs(m.c), 1 / track));
      EXPECT_NEAR(slope_behind.v[1], m.d * n / n_image, bound);
    }
  }
}

}  // namespace exact_limit_test
}  // namespace petzval
