// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/illumination.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>

#include "../data_lenses.hpp"
#include "../message.hpp"
#include "petzval/core/units.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace {

using testing::data_lens;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

double on_film(const Lens& lens, const Ray<double>& ray) {
  return ray.origin.y + (lens.film_z() - ray.origin.z) / ray.direction.z * ray.direction.y;
}

/// The projected solid angle in which a film point (0, y) sees the scene, by a grid of rays to the scene.
double seen_from_film(const Lens& lens, double y, int nodes) {
  const double back = lens.surfaces().back().vertex_z, gap = lens.film_z() - back;
  const double reach = 1.3 * lens.surfaces().back().semi_diameter;
  double sum = 0;
  for (int j = 0; j < nodes; ++j) {
    for (int i = 0; i < nodes; ++i) {
      const double px = reach * ((2 * i + 1.0) / nodes - 1), py = reach * ((2 * j + 1.0) / nodes - 1);
      const double length = std::hypot(px, py - y, gap);
      const Ray<double> ray{{px, py, back}, {px / length, (py - y) / length, -gap / length}};
      if (trace(lens, ray, {.travel = Travel::to_scene}).transmitted()) sum += std::pow(gap / length, 4);
    }
  }
  return sum * 4 * reach * reach / nodes / nodes / (gap * gap);
}

struct Case {
  const char* lens;
  double field_deg;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens << " at " << c.field_deg; }

class FilmIrradiance : public ::testing::TestWithParam<Case> {};

TEST_P(FilmIrradiance, IsTheSolidAngleOfAGridOfRays) {
  const auto& [id, field_deg] = GetParam();
  const Lens open = data_lens(id);
  const Lens lens = with_film(open, paraxial_image_z(open, -infinity));
  const AimedRay chief = chief_ray(lens, {radians(field_deg), -infinity});
  ASSERT_TRUE(chief.end.transmitted());
  const double y = on_film(lens, chief.end.ray);
  EXPECT_NEAR(film_irradiance(lens, {0, y}) / seen_from_film(lens, y, 600), 1, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Lenses, FilmIrradiance,
                         ::testing::Values(Case{"double_gauss_100mm_f2.0", 0}, Case{"double_gauss_100mm_f2.0", 14},
                                           Case{"biogon_35mm_f2.8", 25}, Case{"fisheye_10mm_f4", 60},
                                           Case{"fisheye_16mm_f2.8", 80}, Case{"tessar_100mm_f2.8", 15},
                                           Case{"telephoto_200mm_f1.8", 5}, Case{"retrofocus_100mm_f2.8", 20}));

TEST(FilmIrradiance, IsPiSineSquaredOnTheAxis) {
  // Seen from the axial image of a lens without spherical aberration the edge of the pupil is a circle.
  const Lens lens = data_lens("analytic_plano_hyperbolic_100mm");
  const PupilBoundary axis = pupil_boundary(lens, {0, -infinity}, 0, 1);
  const Vec2<double> p = axis.at(0, axis.spans.back().to_radius);
  const auto rim = trace(lens, axis.plane.ray(p.x, p.y)).ray.direction;
  EXPECT_NEAR(film_irradiance(lens, {}) / (pi * (rim.x * rim.x + rim.y * rim.y)), 1, 1e-6);
}

TEST(RelativeIllumination, IsTheLightThatThePupilTakesInAndTheImageSpreads) {
  // In front of the lens: area cos sin / (h dh/dfield) over area / f^2 on the axis, with the chief ray's map of the
  // field onto the film. Etendue is kept, so both sides agree where the lens is stopped down and in focus.
  for (const auto& [id, field_deg] : {std::pair{"double_gauss_100mm_f2.0", 10.0},
                                      {"biogon_35mm_f2.8", 25.0},
                                      {"fisheye_10mm_f4", 60.0},
                                      {"fisheye_16mm_f2.8", 70.0},
                                      {"tessar_100mm_f2.8", 15.0},
                                      {"retrofocus_100mm_f2.8", 25.0}}) {
    SCOPED_TRACE(id);
    const Lens lens = with_f_number(data_lens(id), 22);
    const auto height = [&](double field) {
      return std::abs(on_film(lens, chief_ray(lens, {field, -infinity}).end.ray));
    };
    const double field = radians(field_deg), step = 1e-4;
    const double slope = (height(field + step) - height(field - step)) / (2 * step), axis = height(step) / step;
    const double mapped = pupil_boundary(lens, {field, -infinity}).area() /
                          pupil_boundary(lens, {0, -infinity}).area() * std::cos(field) * std::sin(field) * axis *
                          axis / (height(field) * slope);
    EXPECT_NEAR(*relative_illumination(lens, {field, -infinity}) / mapped, 1, 1e-3);
  }
}

TEST(RelativeIllumination, IsOneOnTheAxis) {
  for (const char* id : {"double_gauss_100mm_f2.0", "catadioptric_mangin_1000mm_f7.5", "anamorphic_60mm_2x"}) {
    EXPECT_NEAR(*relative_illumination(data_lens(id), {0, -infinity}), 1, 1e-12) << id;
  }
}

TEST(RelativeIllumination, OfNothingIsNothing) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  EXPECT_EQ(relative_illumination(lens, {radians(40), -infinity}).value_or(0), 0);
  const Lens closed = with_semi_diameter(lens, *lens.stop(), 0);
  EXPECT_FALSE(relative_illumination(closed, {0, -infinity}).has_value());
}

TEST(RelativeIllumination, ReachesBeyond90Degrees) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  double last = 1.01;
  for (const double field : {0.0, 30.0, 60.0, 85.0, 88.9, 89.1, 100.0, 110.0}) {
    const auto now = relative_illumination(lens, {radians(field), -infinity});
    EXPECT_LT(*now, last) << field;
    EXPECT_GT(*now, 0.1) << field;
    last = *now;
  }
}

TEST(ImageCircle, EndsWhereTheLightDoes) {
  for (const char* id : {"double_gauss_100mm_f2_28deg", "biogon_35mm_f2.8", "fisheye_10mm_f4", "telephoto_200mm_f1.8",
                         "catadioptric_mangin_1000mm_f7.5", "phone_5.6mm_f3.5"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const double axis = film_irradiance(lens, {}), f = std::abs(first_order(lens).effective_focal_length);
    double last = infinity;
    for (const double part : {0.0, 0.1, 0.5, 0.9}) {
      const double radius = image_circle_mm(lens, part) / 2;
      EXPECT_GT(radius, 0);
      EXPECT_LE(radius, last) << part;
      last = radius;
      EXPECT_GE(film_irradiance(lens, {0, radius}), part * axis);
      // By a grid of rays, too.
      EXPECT_NEAR(seen_from_film(lens, radius, 600) / axis, part, 0.02) << part;
      const double beyond = film_irradiance(lens, {0, radius + 1.1e-4 * f});
      EXPECT_TRUE(part > 0 ? beyond < part * axis : beyond == 0) << beyond;
    }
  }
}

TEST(ImageCircle, HoldsThePictureThatTheLensWasMadeFor) {
  int declared = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    if (!p.image_diagonal_mm) continue;
    EXPECT_GE(image_circle_mm(compile(p)), *p.image_diagonal_mm) << p.id;
    ++declared;
  }
  EXPECT_GT(declared, 20);
}

TEST(ImageCircle, OfAScaledLensIsScaled) {
  const Prescription p = testing::data_prescription("tessar_100mm_f2.8");
  const double circle = image_circle_mm(compile(p), 0.3);
  EXPECT_NEAR(image_circle_mm(compile(scale(p, 0.1)), 0.3), 0.1 * circle, 1e-9);
}

TEST(ImageCircle, OfALensWithCylindersHoldsAllRound) {
  const Lens lens = data_lens("anamorphic_60mm_2x");
  const double radius = image_circle_mm(lens, 0.5) / 2, axis = film_irradiance(lens, {});
  for (int k = 0; k < 8; ++k) {
    const double angle = pi / 4 * k;
    EXPECT_GE(film_irradiance(lens, {radius * std::sin(angle), radius * std::cos(angle)}), 0.5 * axis);
  }
}

TEST(ImageCircle, IsNoneOfADarkLensAndInfiniteOfAnOpenOne) {
  const Lens lens = data_lens("tessar_100mm_f2.8");
  EXPECT_EQ(image_circle_mm(with_semi_diameter(lens, *lens.stop(), 0)), 0);
  Prescription p;
  p.name = "open";
  p.surfaces = {{.radius = 50, .thickness = 2, .medium = {.nd = 1.5}, .semi_diameter = 5, .stop = true},
                {.thickness = 100}};
  EXPECT_GT(image_circle_mm(compile(p)), 100);
  for (const double part : {-0.1, 1.1, std::nan("")}) {
    EXPECT_NE(testing::message([&] { image_circle_mm(lens, part); }).find("wanted 0 to 1"), std::string::npos);
  }
}

TEST(FilmIrradiance, OfAStopWithoutARimIsThatOfTheRimsThatLimit) {
  const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(testing::open_singlet(10));
  EXPECT_EQ(film_irradiance(marked, {}), film_irradiance(unmarked, {}));
  EXPECT_EQ(film_irradiance(marked, {3, 5}), film_irradiance(unmarked, {3, 5}));
  EXPECT_NEAR(film_irradiance(marked, {}), 0.1256, 1e-4);
  EXPECT_GT(relative_illumination(marked, {0.1, -infinity}).value_or(0), 0.9);
  const Lens endless = compile(testing::open_singlet());
  EXPECT_EQ(testing::message([&] { film_irradiance(endless, {}); }), testing::message([&] { pupils(endless); }));
}

TEST(FilmIrradiance, OfAStopAsSmallAsAPointIsANumber) {
  const Lens open = data_lens("double_gauss_100mm_f2_28deg");
  const auto irradiance = [&](double radius, const FilmPoint& point) {
    return film_irradiance(with_semi_diameter(open, *open.stop(), radius), point);
  };
  for (const FilmPoint point : {FilmPoint{0, 0}, FilmPoint{0, 10}, FilmPoint{-7, 12}}) {
    for (const double radius : {0., 1e-300, 1e-100, 1e-30, 1e-17, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10}) {
      const double light = irradiance(radius, point);
      EXPECT_TRUE(light >= 0 && light < 1e-15) << radius << ": " << light;
    }
    const double per_area = irradiance(0.01, point) / 1e-4;
    EXPECT_NEAR(irradiance(1e-6, point) / 1e-12, per_area, 5e-4 * per_area);
  }
}

}  // namespace
}  // namespace petzval
