// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/spot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "analysis/points.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval {
namespace spot_test {

using testing::data_lens;

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(SpotSize, CrossOfPoints) {
  const std::vector<double> x{1, 3, 2, 2}, y{5, 5, 4, 6};
  const SpotSize size = spot_size(x, y);
  EXPECT_DOUBLE_EQ(size.centroid.x, 2);
  EXPECT_DOUBLE_EQ(size.centroid.y, 5);
  EXPECT_DOUBLE_EQ(size.rms_radius, 1);
  EXPECT_DOUBLE_EQ(size.max_radius, 1);
}

TEST(SpotSize, ZeroPointsAndOnePoint) {
  EXPECT_EQ(spot_size({}, {}).max_radius, 0);
  EXPECT_EQ(spot_size(std::array{4.0}, std::array{-7.0}).centroid, Vec2<double>(4, -7));
  EXPECT_EQ(spot_size(std::array{4.0}, std::array{-7.0}).rms_radius, 0);
}

TEST(SpotSize, IgnoresPointsWithoutBothCoordinates) {
  const std::vector<double> x{1, 3, 2, 2}, y{5, 5, 4, 6}, longer{1, 3, 2, 2, 1e9};
  EXPECT_EQ(spot_size(longer, y).rms_radius, spot_size(x, y).rms_radius);
  EXPECT_EQ(spot_size(y, longer).centroid, spot_size(y, x).centroid);
  EXPECT_EQ(spot_size(x, {}).centroid, Vec2<double>(0, 0));
  const std::vector<RayBundle> sets{{.x = {7}, .y = {}}, {.x = longer, .y = y, .weights = {1, 1}}};
  EXPECT_EQ(spot_size(sets).centroid, Vec2<double>(2, 5));
}

TEST(SpotSize, KeepsSmallSpotsFarFromTheAxis) {
  // A ring of 1 nm at a height of 40 mm, resolved by the coordinates to 1e-8.
  std::vector<double> x, y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(1e-6 * std::cos(radians(i * 0.36)));
    y.push_back(40 + 1e-6 * std::sin(radians(i * 0.36)));
  }
  const SpotSize size = spot_size(x, y);
  EXPECT_NEAR(size.rms_radius / 1e-6, 1, 2e-8);
  EXPECT_NEAR(size.max_radius / 1e-6, 1, 2e-8);
}

TEST(SpotSize, SetsAreCombined) {
  const std::vector<RayBundle> sets{{.x = {1, 3}, .y = {5, 5}}, {.x = {}, .y = {}}, {.x = {2, 2}, .y = {4, 6}}};
  EXPECT_DOUBLE_EQ(spot_size(sets).rms_radius, 1);
  EXPECT_DOUBLE_EQ(spot_size(sets).centroid.y, 5);
}

/// 0.61 wavelengths divided by the numerical aperture, from first-order slopes.
double radius_by_aperture(const Lens& lens, double wavelength_nm) {
  const Pupil exit = pupils(lens).exit;
  const double index = lens.index(lens.surface_count()), slope = exit.diameter / 2 / std::abs(lens.film_z() - exit.z);
  return 0.61 * 1e-6 * wavelength_nm / (index * slope);
}

TEST(AiryRadius, FollowsTheNumericalApertureOnTheFilm) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  EXPECT_NEAR(airy_radius(lens), 1.22 * 587.5618e-6 * 2, 4e-5);
  // Near objects, other stops, and media behind the lens.
  for (const Lens& other : {lens, with_film(lens, lens.film_z() + 40), with_f_number(lens, 11),
                            data_lens("eye_gullstrand_le_grand"), data_lens("mirror_newton_200mm_f8")}) {
    const double nm = other.wavelengths_nm()[other.primary_wavelength()];
    EXPECT_NEAR(airy_radius(other) / radius_by_aperture(other, nm), 1, 1e-9) << other.name();
  }
  EXPECT_GT(data_lens("eye_gullstrand_le_grand").index(5), 1.3);
  const Lens two = compile(testing::data_prescription("achromat_100mm"), std::array{450.0, 650.0},
                           {.missing_glass = MissingGlass::abbe});
  EXPECT_NEAR(airy_radius(two, 1) / airy_radius(two, 0), 650.0 / 450.0, 0.01);
  EXPECT_EQ(airy_radius(with_semi_diameter(lens, *lens.stop(), 0)), infinity);
}

TEST(AiryRadius, ComparedWithTheBlurShowsTheEffectOfDiffraction) {
  const SpotSize size{.centroid = {0, 0}, .rms_radius = 0.01, .max_radius = 0.02};
  const double blur = 0.01 * std::sqrt(2.0);  // radius of the uniform disc
  EXPECT_EQ(diffraction(0.099 * blur, size), Diffraction::negligible);
  EXPECT_EQ(diffraction(0.101 * blur, size), Diffraction::visible);
  EXPECT_EQ(diffraction(0.99 * blur, size), Diffraction::visible);
  EXPECT_EQ(diffraction(1.01 * blur, size), Diffraction::dominant);
  EXPECT_EQ(diffraction(infinity, size), Diffraction::dominant);
}

TEST(SpotDiagram, ImagesTheFieldUpsideDown) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const double f = first_order(lens).effective_focal_length;
  const std::array fields{radians(0.0), radians(5.0), radians(10.0), radians(-10.0)};
  const auto spots = spot_diagram(lens, -infinity, fields, 2048).values;
  ASSERT_EQ(spots.size(), 4u);
  EXPECT_NEAR(spots[0].chief_ray_height.value(), 0, 1e-12);
  for (std::size_t i = 1; i < 4; ++i) {
    const double ideal = -f * std::tan(fields[i]);
    EXPECT_EQ(spots[i].point.field_rad, fields[i]);
    EXPECT_NEAR(spots[i].chief_ray_height.value() / ideal, 1, 0.02);  // distortion
    EXPECT_NEAR(spots[i].size.centroid.y / ideal, 1, 0.03);
    EXPECT_NEAR(spots[i].size.centroid.x, 0, 2e-3);
    EXPECT_LE(spots[i].size.rms_radius, spots[i].size.max_radius);
    EXPECT_EQ(spots[i].sent, 2048u);
  }
  EXPECT_DOUBLE_EQ(spots[2].chief_ray_height.value(), -spots[3].chief_ray_height.value());
}

TEST(SpotDiagram, HasRowsOfFieldsAndColumnsOfWavelengths) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f2.0");
  for (auto& row : p.surfaces) {
    row.medium = {.nd = row.medium.nd, .vd = row.medium.vd};
    row.medium.vd = !row.medium.is_air() ? std::optional(50.0) : std::nullopt;
  }
  const std::array wavelengths{486.1, 587.5618, 656.3};
  const Lens lens = compile(p, wavelengths, {.missing_glass = MissingGlass::abbe});
  const std::array fields{0.0, 0.1};
  const auto spots = spot_diagram(lens, -1000, fields, 512);
  ASSERT_EQ(spots.size(), 2u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(spots[i / 3][i % 3].point.field_rad, fields[i / 3]);
    EXPECT_EQ(spots[i / 3][i % 3].wavelength, i % 3);
  }
  // One scene point for all wavelengths, so that differences on the film are chromatic aberration.
  EXPECT_NE(spots[1][0].chief_ray_height.value(), spots[1][2].chief_ray_height.value());
  EXPECT_NEAR(spots[1][0].chief_ray_height.value(), spots[1][2].chief_ray_height.value(), 0.1);
}

// Rays of a moved film are traced for comparison.
TEST(ThroughFocus, EqualsSpotsOnMovedFilms) {
  const std::array wavelengths{486.1327, 656.2725}, weights{1.0, 3.0};
  const Lens lens = compile(testing::data_prescription("double_gauss_100mm_f2.0"), wavelengths);
  const std::array fields{0.0, radians(9.0)};
  const std::array shifts{-0.2, 0.0, 0.35};
  const auto found = through_focus(spot_diagram(lens, -infinity, fields, 1024), shifts, weights).values;
  ASSERT_EQ(found.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(found[i].field_rad, fields[i / 3]);
    EXPECT_EQ(found[i].film_shift_mm, shifts[i % 3]);
    const Lens moved = with_film(lens, lens.film_z() + shifts[i % 3]);
    std::vector<RayBundle> hits;
    for (const Spot& spot : spot_diagram(moved, -infinity, std::array{fields[i / 3]}, 1024).values) {
      hits.push_back({.x = spot.x, .y = spot.y, .weights = std::vector(spot.x.size(), weights[spot.wavelength])});
    }
    const SpotSize size = spot_size(hits);
    EXPECT_NEAR(*found[i].rms_radius_mm, size.rms_radius, 1e-12);
    EXPECT_NEAR(found[i].centroid.y, size.centroid.y, 1e-11);
    EXPECT_NEAR(found[i].centroid.x, size.centroid.x, 1e-12);
  }
}

TEST(ThroughFocus, StatesItsError) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const std::array fields{0.0, radians(6.0), radians(12.0)};
  const std::array shifts{-0.5, 0.0, 0.5};
  const auto found = through_focus(spot_diagram(lens, -infinity, fields, 4096), shifts).values;
  const auto fine = through_focus(spot_diagram(lens, -infinity, fields, 65536), shifts).values;
  double stated = 0, error = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    stated = std::max(stated, found[i].sampling_error_mm);
    error = std::max(error, std::abs(*found[i].rms_radius_mm - *fine[i].rms_radius_mm));
  }
  EXPECT_LT(error, stated);
  EXPECT_LT(stated, 0.01 * *found[0].rms_radius_mm);
}

// A perfect mirror: the RMS radius grows as the shift on both sides.
TEST(ThroughFocus, OfAPerfectMirrorIsACone) {
  const Lens lens = data_lens("mirror_newton_200mm_f8");
  const std::array shifts{-0.5, 0.0, 0.5};
  const auto found = through_focus(spot_diagram(lens, -infinity, std::array{0.0}, 4096), shifts).values;
  EXPECT_NEAR(*found[0].rms_radius_mm, *found[2].rms_radius_mm, 1e-5);
  EXPECT_LT(*found[1].rms_radius_mm, 1e-2 * *found[2].rms_radius_mm);
  const Lens closed = with_semi_diameter(lens, *lens.stop(), 0);
  EXPECT_FALSE(through_focus(spot_diagram(closed, -infinity, std::array{0.0}, 64), shifts)[0][0].rms_radius_mm);
  auto without = spot_diagram(lens, -infinity, std::array{0.0}, 64);
  without.values[0].slope_y.clear();
  EXPECT_THROW(through_focus(without, shifts), Error);
}

// Two steps from the best film the blur is 2 to 4 times its least value, or the step reaches the depth of focus.
TEST(ThroughFocusStep, ShowsTheFocus) {
  for (const char* id :
       {"double_gauss_100mm_f1.35", "cooke_triplet_50mm_f5", "fisheye_8mm_f2.8", "singlet_50mm_biconvex"}) {
    const Lens sharp = data_lens(id);
    const std::array fields{0.0, radians(8.0)};
    const Lens lens = with_focus(sharp, infinity, {.fields = {{fields[0]}, {fields[1]}}});
    const auto spots = spot_diagram(lens, -infinity, fields, 1024);
    const double step = through_focus_step(lens, spots).value();
    const auto rms = [&](double shift) {
      double squares = 0;
      for (const auto& spot : through_focus(spots, std::array{shift}).values) {
        squares += *spot.rms_radius_mm * *spot.rms_radius_mm;
      }
      return std::sqrt(squares);
    };
    EXPECT_GT(rms(2 * step), 2 * rms(0)) << id;
    EXPECT_GT(rms(-2 * step), 2 * rms(0)) << id;
    EXPECT_LT(rms(2 * step), 5 * rms(0)) << id;
  }
  // Scale invariance, up to the rounding of steps.
  const Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  const auto step = [&](double factor) {
    const Lens lens = compile(scale(p, factor));
    return through_focus_step(lens, spot_diagram(lens, -infinity, std::array{0.0}, 512)).value();
  };
  EXPECT_NEAR(step(10) / step(1), 10, 1e-9);
  const Lens perfect = data_lens("analytic_plano_hyperbolic_100mm");
  const double n = paraxial_f_number(perfect), depth = 4 * perfect.wavelengths_nm()[0] * 1e-6 * n * n;
  EXPECT_NEAR(2 * through_focus_step(perfect, spot_diagram(perfect, -infinity, std::array{0.0}, 512)).value() / depth,
              1, 0.3);
  const Lens closed = with_semi_diameter(perfect, *perfect.stop(), 0);
  EXPECT_FALSE(through_focus_step(closed, spot_diagram(closed, -infinity, std::array{0.0}, 64)));
}

TEST(SpotDiagram, PerfectLensGivesAPoint) {
  const Lens lens = data_lens("analytic_plano_hyperbolic_100mm");
  const std::array axis{0.0};
  const auto spots = spot_diagram(lens, -infinity, axis);
  EXPECT_GT(spots[0][0].x.size(), 1000u);
  EXPECT_LT(spots[0][0].size.max_radius, 1e-12);
}

TEST(SpotDiagram, ChiefRayPassesAnObscuration) {
  const std::array fields{radians(0.5)};
  const auto spots = spot_diagram(data_lens("catadioptric_mangin_1000mm_f7.5"), -infinity, fields, 256);
  EXPECT_NEAR(spots[0][0].chief_ray_height.value(), -1000 * std::tan(radians(0.5)), 0.2);
}

TEST(SpotDiagram, ReachesTheEdgeOfA220DegreeFisheye) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  const std::array fields{radians(0.0), radians(60.0), radians(89.0), radians(110.0)};
  const auto spots = spot_diagram(lens, -infinity, fields, 1024);
  double height = 1, light = 1.1;
  for (const Spot& spot : spots.values) {
    EXPECT_GE(spot.x.size(), 0.95 * spot.sent);
    EXPECT_NEAR(spot.chief_ray_height.value(), spot.size.centroid.y, 0.02);
    EXPECT_LT(spot.chief_ray_height.value(), height);
    EXPECT_LT(spot.relative_illumination.value(), light);
    height = *spot.chief_ray_height;
    light = *spot.relative_illumination;
  }
  EXPECT_NEAR(height, -11.7, 0.2);  // half of the declared 23.4 mm
}

TEST(SpotDiagram, ChiefRayPassesTheCentreOfTheStop) {
  const Lens lens = data_lens("fisheye_10mm_f4");
  const std::array fields{radians(70.0)};
  const auto spots = spot_diagram(lens, -infinity, fields, 256);
  const AimedRay chief = chief_ray(lens, {radians(70.0), -infinity});
  ASSERT_LE(chief.residual, 1e-12);
  const auto& ray = chief.end.ray;
  EXPECT_NEAR(spots[0][0].chief_ray_height.value(),
              ray.origin.y + (lens.film_z() - ray.origin.z) / ray.direction.z * ray.direction.y, 1e-13);
}

TEST(SpotDiagram, ReportsMissingChiefRays) {
  const std::array fields{radians(0.0), radians(89.5)};
  const auto spots = spot_diagram(data_lens("double_gauss_100mm_f2.0"), -infinity, fields, 256);
  EXPECT_EQ(spots[0][0].relative_illumination.value(), 1);
  EXPECT_FALSE(spots[1][0].chief_ray_height.has_value());
  EXPECT_FALSE(spots[1][0].relative_illumination.has_value());
}

}  // namespace spot_test
}  // namespace petzval
