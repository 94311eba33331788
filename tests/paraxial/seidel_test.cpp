// SPDX-License-Identifier: Apache-2.0
// Seidel sums, compared with limits of real rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../seidel.hpp"
#include "../trace/extended.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace seidel_test {

using L = long double;

/// The hit of a ray from infinity on the paraxial image plane, minus its first-order hit. x, y: position in the plane
/// of the entrance pupil; slope: tangent of the field, for light that travels towards +y.
class RealRays {
 public:
  RealRays(const Lens& lens, const testing::SeidelSums& sums, L pupil_z)
      : tables_(testing_lenses::extended(petzval::kernel::view<double>(lens))), sums_(sums), pupil_z_(pupil_z) {}

  std::array<L, 2> operator()(L x, L y, L slope) const {
    const L length = std::sqrt(1 + slope * slope);
    const auto end = kernel::trace(tables_.view(), kernel::Vec<L>{x, y, pupil_z_},
                                   kernel::Vec<L>{0, slope / length, 1 / length}, {.apertures = false});
    EXPECT_EQ(end.fate, RayFate::transmitted);
    const L t = (sums_.image_z - end.origin.z) / end.direction.z;
    return {end.origin.x + t * end.direction.x, end.origin.y + t * end.direction.y - sums_.chief_height * slope};
  }

 private:
  testing_lenses::Tables<L> tables_;
  const testing::SeidelSums& sums_;
  L pupil_z_;
};

/// Third-order coefficient of an odd function: f(t) / t^3 at t, t/2 and t/4, extrapolated to 0 in t^2.
template <class Function>
L third_order(const Function& f, L t) {
  const auto part = [&](L s) { return f(s) / (s * s * s); };
  const L a = part(t), b = part(t / 2), c = part(t / 4);
  const L ab = b + (b - a) / 3, bc = c + (c - b) / 3;
  return bc + (bc - ab) / 15;
}

/// Cylinders have no Seidel sums, and odd aspheric terms belong to other orders.
bool has_sums(const Lens& lens) {
  return lens.rotationally_symmetric() &&
         std::none_of(lens.surfaces().begin(), lens.surfaces().end(), [](const LensSurface& s) {
           return std::any_of(s.aspheric.begin(), s.aspheric.end(), [](const AsphereTerm& t) { return t.order % 2; });
         });
}

// Transverse aberrations are the derivatives of
// W = S1/8 r^4 + S2/2 h y r^2 + S3/2 h^2 y^2 + (S3 + S4)/4 h^2 r^2 + S5/2 h^3 y over n' u'.
TEST(Seidel, SumsEqualLimitsOfExactRays) {
  int lenses = 0;
  double worst = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!has_sums(lens)) continue;
    ++lenses;
    const Pupils pupil = pupils(lens);
    const L pupil_z = pupil.entrance.z;
    const testing::SeidelSums s = testing::seidel_sums(lens, pupil_z);
    const RealRays real(lens, s, pupil_z);
    const L r = pupil.entrance.diameter / 2, h = std::tan(radians(std::min(p.half_field_deg.value_or(1), 30.0)));
    const L per = 1 / s.image_nu, start = 1.0L / 32;

    struct Row {
      const char* name;
      L found, expected;
    };
    const auto y_of = [&](L t, L x, L y, L field) { return real(x * t * r, y * t * r, field * t * h)[1]; };
    const auto x_of = [&](L t, L x, L y, L field) { return real(x * t * r, y * t * r, field * t * h)[0]; };
    const std::array<Row, 6> rows{{
        {"spherical aberration", third_order([&](L t) { return y_of(t, 0, 1, 0); }, start), per * s.s1 / 2 * r * r * r},
        {"tangential coma",
         third_order([&](L t) { return (y_of(t, 0, 1, 1) + y_of(t, 0, -1, 1)) / 2 - y_of(t, 0, 0, 1); }, start),
         per * 3 * s.s2 / 2 * r * r * h},
        {"sagittal coma", third_order([&](L t) { return y_of(t, 1, 0, 1) - y_of(t, 0, 0, 1); }, start),
         per * s.s2 / 2 * r * r * h},
        {"tangential focus",
         third_order([&](L t) { return (y_of(t, 0, 1, 1) - y_of(t, 0, -1, 1)) / 2 - y_of(t, 0, 1, 0); }, start),
         per * (3 * s.s3 + s.s4) / 2 * r * h * h},
        {"sagittal focus", third_order([&](L t) { return x_of(t, 1, 0, 1) - x_of(t, 1, 0, 0); }, start),
         per * (s.s3 + s.s4) / 2 * r * h * h},
        {"distortion", third_order([&](L t) { return y_of(t, 0, 0, 1); }, start), per * s.s5 / 2 * h * h * h},
    }};
    const L nothing = 1e-12L * std::abs(first_order(lens).effective_focal_length);  // sums that vanish by design
    for (const Row& row : rows) {
      const L error = std::abs(row.found - row.expected);
      EXPECT_LE(error, 1e-4L * std::abs(row.expected) + nothing)
          << p.id << ": " << row.name << ": " << static_cast<double>(row.found) << ", by the sums "
          << static_cast<double>(row.expected);
      if (error > nothing) worst = std::max(worst, static_cast<double>(error / std::abs(row.expected)));
    }
  }
  RecordProperty("worst", std::to_string(worst * 1e6) + "e-6");
  EXPECT_GE(lenses, 65);
}

}  // namespace seidel_test
}  // namespace petzval
