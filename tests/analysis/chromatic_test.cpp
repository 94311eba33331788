// SPDX-License-Identifier: Apache-2.0
// Longitudinal and lateral colour.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace chromatic_test {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array f_d_c{486.1327, 587.5618, 656.2725};

const GlassCatalogue& glasses() {
  static const auto all = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return all;
}

Lens compiled(const Prescription& prescription, std::span<const double> wavelengths_nm = f_d_c) {
  return compile(prescription, wavelengths_nm, {.glasses = &glasses()});
}

Lens compiled(const char* id) { return compiled(testing::data_prescription(id)); }

/// A thin singlet of f = 100 and V = 50 with a stop in front.
Lens thin_singlet(double stop_distance) {
  Prescription p;
  p.name = "thin";
  const Medium glass{.nd = 1.5, .vd = 50};
  p.surfaces = {{.thickness = stop_distance, .semi_diameter = 0.5, .stop = true},
                {.radius = 100, .medium = glass, .semi_diameter = 30},
                {.radius = -100, .thickness = 100, .semi_diameter = 30}};
  return compile(p, f_d_c, {.missing_glass = MissingGlass::abbe});
}

// The Gaussian lens equation for each wavelength; the focal lengths at F and C differ by f / V.
TEST(ChromaticAberration, ThinLensFollowsItsFocalLength) {
  const Lens lens = thin_singlet(0.1);
  const auto focal_length = [](double nm) { return 100 * 0.5 / (abbe_index(1.5, 50, nm) - 1); };
  EXPECT_NEAR(focal_length(f_d_c[2]) - focal_length(f_d_c[0]), 100.0 / 50, 0.02);
  for (const double subject_distance : {infinity, 300.0, 200.0}) {
    const auto image = [&](std::size_t w) { return 1 / (1 / focal_length(f_d_c[w]) - 1 / subject_distance); };
    const auto colour = chromatic_aberration(lens, 0.1 - subject_distance, {});
    for (const auto& shift : {colour.paraxial_focus_shift, colour.sharpest_focus_shift}) {
      EXPECT_EQ(shift[1].value(), 0);
      for (const std::size_t w : {std::size_t(0), std::size_t(2)}) {
        EXPECT_NEAR(*shift[w] / (image(w) - image(1)), 1, 1e-4) << subject_distance;
      }
      EXPECT_LT(*shift[0], 0);
    }
  }
}

// With the stop at a thin lens, chief rays are not bent. With the stop at d in front of the lens, the chief ray from
// above crosses the lens at -d tan w and is bent upwards by d tan w / f. At F the angle is larger than at C by a
// fraction 1 / V. The film is at distance f.
TEST(ChromaticAberration, LateralColourFollowsTheDistanceOfTheStop) {
  const std::array fields{0.0, 0.02, -0.02};
  for (const double distance : {1e-6, 10.0, 20.0}) {
    const Lens lens = thin_singlet(distance);
    const auto lateral = chromatic_aberration(lens, -infinity, fields).lateral;
    const double expected = -distance * std::tan(0.02) / 50;
    ASSERT_EQ(lateral.size(), 3u);
    EXPECT_EQ(lateral[1][1].value(), 0);
    EXPECT_NEAR(*lateral[1][2] - *lateral[1][0], expected, 1e-3 * std::abs(expected) + 1e-9) << distance;
    for (std::size_t w = 0; w < 3; ++w) {
      EXPECT_NEAR(*lateral[0][w], 0, 1e-12);
      EXPECT_NEAR(*lateral[1][w], -*lateral[2][w], 1e-12);
    }
  }
}

TEST(ChromaticAberration, AchromatHasAFractionOfTheSinglet) {
  const auto spread = [](const auto& shift) { return std::abs(*shift[2] - *shift[0]); };
  const Lens achromat = compiled("achromat_100mm"), singlet = compiled("singlet_50mm_biconvex");
  const double corrected = spread(chromatic_aberration(achromat, -infinity, {}).paraxial_focus_shift);
  const double single = spread(chromatic_aberration(singlet, -infinity, {}).paraxial_focus_shift);
  EXPECT_LT(corrected / 100, 0.1 * single / 50);
  EXPECT_NEAR(single, 49.83 / 64.17, 0.03);  // N-BK7
}

TEST(ChromaticAberration, ScalesWithTheLens) {
  const std::array fields{radians(10.0)};
  const Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  const auto one = chromatic_aberration(compiled(p), -1000, fields);
  const auto four = chromatic_aberration(compiled(scale(p, 4)), -4000, fields);
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_NEAR(*four.paraxial_focus_shift[w], 4 * *one.paraxial_focus_shift[w], 1e-10);
    EXPECT_NEAR(*four.sharpest_focus_shift[w], 4 * *one.sharpest_focus_shift[w], 1e-8);
    EXPECT_NEAR(*four.lateral[0][w], 4 * *one.lateral[0][w], 1e-10);
  }
}

TEST(ChromaticAberration, AgreesWithSpotsAndFirstOrder) {
  const std::array fields{0.0, radians(7.0), radians(12.0)};
  const Lens lens = with_focus(compiled("double_gauss_100mm_f1.35"), 1000);
  const auto colour = chromatic_aberration(lens, -1000, fields);
  const auto spots = spot_diagram(lens, -1000, fields, 64);
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_NEAR(*colour.paraxial_focus_shift[w], paraxial_image_z(lens, -1000, w) - paraxial_image_z(lens, -1000, 1),
                1e-12);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(*colour.lateral[i][w], *spots[i][w].chief_ray_height - *spots[i][1].chief_ray_height, 1e-12);
    }
  }
}

// Stopped down, the sharpest film is the paraxial film.
TEST(ChromaticAberration, SharpestFilmTendsToTheParaxialFilm) {
  const Lens open = compiled("double_gauss_100mm_f1.35");
  const auto distance = [&](double f_number) {
    const auto colour = chromatic_aberration(with_f_number(open, f_number), -infinity, {});
    return std::abs(*colour.sharpest_focus_shift[0] - *colour.paraxial_focus_shift[0]);
  };
  EXPECT_LT(distance(32), distance(8) / 10);  // as the square of the aperture
  EXPECT_LT(distance(32), 1e-3);
}

TEST(ChromaticAberration, LateralColourNeedsAChiefRay) {
  const std::array fields{radians(89.5)};
  const auto colour = chromatic_aberration(compiled("double_gauss_100mm_f2.0"), -infinity, fields);
  for (const auto& lateral : colour.lateral[0]) EXPECT_FALSE(lateral);
}

}  // namespace chromatic_test
}  // namespace petzval
