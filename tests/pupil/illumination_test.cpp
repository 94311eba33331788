// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/illumination.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "lens/without_obscurations.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/aim.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/surface_box.hpp"

namespace petzval {
namespace illumination_test {

using testing::data_lens;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

double on_film(const Lens& lens, const Ray<double>& ray) {
  return ray.origin.y + (lens.film_z() - ray.origin.z) / ray.direction.z * ray.direction.y;
}

/// Projected solid angle of the pupil from the film point (0, y), by a grid of rays to the scene.
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

TEST_P(FilmIrradiance, EqualsTheSolidAngleOfAGridOfRays) {
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

/// The connected component of passing cells next to `near`, or the largest component without `near`; by [row][column].
std::vector<bool> connected(const std::vector<bool>& passes, int side, const std::optional<Vec2<double>>& near) {
  std::vector<bool> seen(passes.size(), false), best(passes.size(), false);
  double least = infinity;
  for (std::size_t start = 0; start < passes.size(); ++start) {
    if (!passes[start] || seen[start]) continue;
    std::vector<std::size_t> part{start};
    seen[start] = true;
    double distance = infinity;
    for (std::size_t next = 0; next < part.size(); ++next) {
      const int i = static_cast<int>(part[next]) % side, j = static_cast<int>(part[next]) / side;
      if (near) distance = std::min(distance, std::hypot(near->x - i - 0.5, near->y - j - 0.5));
      for (int n = std::max(j - 1, 0); n <= std::min(j + 1, side - 1); ++n) {
        for (int m = std::max(i - 1, 0); m <= std::min(i + 1, side - 1); ++m) {
          const auto at = static_cast<std::size_t>(n * side + m);
          if (passes[at] && !seen[at]) seen[at] = true, part.push_back(at);
        }
      }
    }
    if (!near) distance = -static_cast<double>(part.size());
    if (distance >= least) continue;
    least = distance;
    best.assign(passes.size(), false);
    for (const std::size_t at : part) best[at] = true;
  }
  return best;
}

/// Projected solid angle of the pupil from a film point, by random rays in a grid over all directions towards the last
/// surface, refined at the edges. Counts the component that contains the chief ray.
double seen_in_all_directions(const Lens& lens, const FilmPoint& film, int side) {
  const PupilPlane plane = PupilPlane::of_film(lens, film);
  const std::size_t last = lens.surface_count() - 1;
  const double back = lens.surfaces()[last].vertex_z, half = pupil_detail::last_surface_box(lens).half;
  const auto cosines = [&](double x, double y, double z) {
    const double dz = back + z - lens.film_z(), length = std::hypot(x - film.x, y - film.y, dz);
    return dz * (back - lens.film_z()) > 0 ? Vec2<double>{(x - film.x) / length, (y - film.y) / length}
                                           : Vec2<double>{infinity, infinity};
  };
  Vec2<double> low{1, 1}, high{-1, -1};
  for (int i = 0; i <= 40; ++i) {
    for (int k = 0; k < 64; ++k) {
      const double r = half * i / 40, angle = 2 * pi * k / 64, x = r * std::sin(angle), y = r * std::cos(angle);
      const double z = sag(lens, last, x, y);
      if (std::isnan(z)) continue;
      const Vec2<double> seen = cosines(x, y, z);
      if (std::isinf(seen.x)) low = {-1, -1}, high = {1, 1};  // behind the film point
      for (int axis : {0, 1})
        low[axis] = std::min(low[axis], seen[axis]), high[axis] = std::max(high[axis], seen[axis]);
    }
  }
  for (int axis : {0, 1}) {
    const double margin = 0.02 * (high[axis] - low[axis]);
    low[axis] = std::max(low[axis] - margin, -1.0), high[axis] = std::min(high[axis] + margin, 1.0);
  }
  const Vec2<double> cell = (high - low) / static_cast<double>(side);
  std::mt19937_64 random(side);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Ray<double>> rays;
  const auto add = [&](double i, double j) {
    const Vec2<double> c = low + cell * Vec2<double>{i, j};
    // Outside the unit disc dz is NaN, and the ray is lost.
    const double dz = std::sqrt(1 - c.x * c.x - c.y * c.y), gap = std::abs(lens.film_z() - back);
    rays.push_back(plane.ray(film.x + c.x / dz * gap, film.y + c.y / dz * gap));
  };
  const auto passing = [&](const Lens& through) {
    std::vector<TracedRay<double>> ends(rays.size());
    trace<double>(through, rays, ends.data(), {.travel = Travel::to_scene});
    std::vector<bool> passes;
    for (const auto& end : ends) passes.push_back(end.transmitted());
    return passes;
  };
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) add(i + unit(random), j + unit(random));
  }
  std::optional<Vec2<double>> near;
  if (const AimedRay chief = pupil_detail::aim(lens, plane, {}, {}); chief && chief.end.transmitted()) {
    const Vec3<double>& d = chief.ray.direction;
    near = (Vec2<double>{d.x, d.y} - low) / cell;
  }
  // Obscurations may divide a connected pupil.
  const std::vector<bool> part = connected(passing(without_obscurations(lens)), side, near);
  std::vector<bool> passes = passing(lens);
  for (std::size_t i = 0; i < passes.size(); ++i) passes[i] = passes[i] && part[i];
  rays.clear();
  // Cells are full if all neighbours pass.
  std::vector<int> mixed;
  double cells = 0;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      int beside = 0, pass = 0;
      for (int n = std::max(j - 2, 0); n <= std::min(j + 2, side - 1); ++n) {
        for (int m = std::max(i - 2, 0); m <= std::min(i + 2, side - 1); ++m) {
          ++beside, pass += passes[static_cast<std::size_t>(n * side + m)];
        }
      }
      if (pass == beside) cells += 1;
      if (pass > 0 && pass < beside) mixed.push_back(j * side + i);
    }
  }
  const int parts = std::clamp(static_cast<int>(std::sqrt(2e5 / (static_cast<double>(mixed.size()) + 1))), 2, 24);
  for (const int c : mixed) {
    for (int k = 0; k < parts * parts; ++k) {
      add(c % side + (k % parts + unit(random)) / parts, c / side + (k / parts + unit(random)) / parts);
    }
  }
  for (const bool passed : passing(lens)) cells += passed ? 1.0 / (parts * parts) : 0;
  return cells * cell.x * cell.y;
}

struct Parts {
  const char* lens;
  double f_number, low, high;  // film heights, mm
  int side = 384;              // cells; coarser grids miss slivers
};

std::ostream& operator<<(std::ostream& out, const Parts& p) { return out << p.lens << " f/" << p.f_number; }

class DisconnectedPupils : public ::testing::TestWithParam<Parts> {};

TEST_P(DisconnectedPupils, IrradianceCountsTheConnectedPupilOnly) {
  const auto& [id, f_number, low, high, side] = GetParam();
  const Lens lens = with_f_number(data_lens(id), f_number);
  constexpr int heights = 4;
  for (int i = 0; i < heights; ++i) {
    const FilmPoint film{0, low + (high - low) * i / (heights - 1)};
    SCOPED_TRACE(film.y);
    EXPECT_NEAR(film_irradiance(lens, film) / seen_in_all_directions(lens, film, side), 1, 3e-3);
  }
}

// Clipped rings; disconnected pupils with crescents and slivers.
INSTANTIATE_TEST_SUITE_P(Lenses, DisconnectedPupils,
                         ::testing::Values(Parts{"catadioptric_mangin_1000mm_f7.5", 16, 9, 11.5},
                                           Parts{"primoplan_100mm_f1.9", 45, 38.5, 39.25},
                                           Parts{"ball_10mm", 8, 0, 0.38}, Parts{"ball_10mm", 16, 0, 0.38},
                                           Parts{"ball_10mm", 45, 0, 0.25, 1200},
                                           Parts{"catadioptric_maksutov_1280mm_f14.4", 14.4, 5, 30}));

TEST(FilmIrradiance, EveryLensEqualsRaysInAllDirections) {
  int points = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens open = compile(p);
    const double radius = testing::declared_radius(p, open);
    for (const auto& [f_number, share] : {std::pair{0.0, 0.97}, std::pair{8.0, 0.35}, std::pair{45.0, 0.7}}) {
      if (f_number > 0 && !(f_number > real_f_number(open))) continue;
      if (p.id == "catadioptric_mangin_1000mm_f7.5" && f_number == 45) continue;  // its obscuration hides the stop
      const Lens lens = f_number > 0 ? with_f_number(open, f_number) : open;
      const FilmPoint film{share * radius * std::sin(0.6), share * radius * std::cos(0.6)};
      SCOPED_TRACE(p.id + " f/" + std::to_string(f_number) + " at " + std::to_string(share * radius));
      const double light = film_irradiance(lens, film), n = lens.index(lens.surface_count(), {});
      const double seen = n * n * seen_in_all_directions(lens, film, 320);
      EXPECT_NEAR(light, seen, 3e-3 * std::max(seen, light));
      ++points;
    }
  }
  EXPECT_GT(points, 210);
}

// The pupil covers nearly the whole half space.
TEST(FilmIrradiance, FilmCloseToTheGlassEqualsRaysInAllDirections) {
  const Lens lens = data_lens("singlet_50mm_biconvex");
  for (const double gap : {1.6, 0.4}) {
    const Lens close = with_film(lens, lens.surfaces().back().vertex_z + gap);
    for (const FilmPoint& film : {FilmPoint{}, FilmPoint{-2.8, 0}, FilmPoint{3, 4}}) {
      SCOPED_TRACE(std::to_string(gap) + " at " + std::to_string(film.x));
      EXPECT_NEAR(film_irradiance(close, film) / seen_in_all_directions(close, film, 600), 1, 3e-3);
    }
  }
}

/// A stop on a glass bowl; the film lies near or inside the concave last surface.
Lens bowl(double last_radius, double gap) {
  Prescription p;
  p.name = "bowl";
  p.surfaces = {{.radius = 30, .thickness = 8, .medium = {.nd = 1.7}, .semi_diameter = 14, .stop = true},
                {.radius = last_radius, .thickness = gap, .semi_diameter = 15}};
  return compile(p);
}

// Rays parallel to the film pass; no plane contains their pupil points.
TEST(FilmIrradiance, FilmInsideTheLastSurfaceEqualsRaysInAllDirections) {
  for (const double radius : {0.0, 200.0, 60.0, 30.0, -200.0, -60.0}) {
    for (const double gap : {0.3, 1.0, 2.0}) {
      const Lens lens = bowl(radius, gap);
      for (const FilmPoint& film : {FilmPoint{}, FilmPoint{0, 3}, FilmPoint{4, -5}}) {
        SCOPED_TRACE(std::to_string(radius) + ", " + std::to_string(gap) + " at " + std::to_string(film.y));
        EXPECT_NEAR(film_irradiance(lens, film) / seen_in_all_directions(lens, film, 600), 1, 3e-3);
      }
    }
  }
}

/// Projected solid angle from the film point (0, y), by a grid over angles that resolves directions along the film.
double seen_along_the_film(const Lens& lens, double y, int side) {
  double sum = 0;
  for (int i = 0; i < side; ++i) {
    const double angle = pi / 2 * (i + 0.5) / side, weight = std::sin(2 * angle) / 2;
    for (int k = 0; k < side; ++k) {
      const double turn = pi * (k + 0.5) / side;  // the other half is symmetric
      const Ray<double> ray{{0, y, lens.film_z()},
                            {std::sin(angle) * std::sin(turn), std::sin(angle) * std::cos(turn), -std::cos(angle)}};
      if (trace(lens, ray, {.travel = Travel::to_scene}).transmitted()) sum += weight;
    }
  }
  return sum * pi * pi / (side * side);
}

// Most of the flux arrives nearly parallel to the film, in crescents that are narrow in direction cosines.
TEST(FilmIrradiance, PointsNextToTheGlassEqualRaysInAllDirections) {
  for (const double radius : {0.0, -60.0}) {
    for (const double y : {11.0, 12.0}) {  // farther out the pupil is disconnected
      const Lens lens = bowl(radius, 1.5);
      SCOPED_TRACE(std::to_string(radius) + " at " + std::to_string(y));
      EXPECT_NEAR(film_irradiance(lens, {0, y}) / seen_along_the_film(lens, y, 1200), 1, 5e-3);
    }
  }
  const Lens close = bowl(0, 0.3);
  for (double y = 15; y < 20; y += 0.25) EXPECT_GT(film_irradiance(close, {0, y}), 1e-8) << y;
}

TEST(FilmIrradiance, ThinRingHasItsFractionOfTheDisc) {
  for (const double radius : {5.0, 0.1, 0.01, 1e-3}) {
    for (const double obscured : {0.5, 0.9, 0.99, 0.999}) {
      Prescription p;
      p.name = "ring";
      p.surfaces = {{.thickness = 10, .semi_diameter = radius, .stop = true},
                    {.radius = 80, .thickness = 6, .medium = {.nd = 1.6}, .semi_diameter = 20},
                    {.radius = -80, .thickness = 60, .semi_diameter = 20}};
      const Lens disc = compile(p);
      p.surfaces[0].obscuration_semi_diameter = obscured * radius;
      const Lens ring = compile(p);
      for (const FilmPoint& film : {FilmPoint{}, FilmPoint{0, 4}, FilmPoint{-3, 5}}) {
        SCOPED_TRACE(std::to_string(radius) + ", " + std::to_string(obscured) + " at " + std::to_string(film.y));
        // In wide beams the solid angle per pupil area differs between centre and rim.
        const double share = 1 - obscured * obscured, bound = radius < 1 ? 1e-3 : 0.02;
        EXPECT_NEAR(film_irradiance(ring, film) / film_irradiance(disc, film) / share, 1, bound);
        EXPECT_NEAR(exit_pupil_boundary(ring, film).area() / exit_pupil_boundary(disc, film).area() / share, 1, bound);
      }
    }
  }
}

TEST(FilmIrradiance, IsPiTimesSineSquaredOnTheAxis) {
  // Without spherical aberration the pupil is a circle of directions, seen from the axial image.
  const Lens lens = data_lens("analytic_plano_hyperbolic_100mm");
  const PupilBoundary axis = pupil_boundary(lens, {0, -infinity}, 0, 1);
  const Vec2<double> p = axis.at(0, axis.spans.back().to_radius);
  const auto rim = trace(lens, axis.plane.ray(p.x, p.y)).ray.direction;
  EXPECT_NEAR(film_irradiance(lens, {}) / (pi * (rim.x * rim.x + rim.y * rim.y)), 1, 1e-6);
}

TEST(RelativeIllumination, EqualsEntrancePupilAreaOverImageArea) {
  // On the scene side: area cos sin / (h dh/dfield) divided by area / f^2 on the axis, where h is the image height of
  // the chief ray. As etendue is conserved, both sides agree if the lens is stopped down and in focus.
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

TEST(RelativeIllumination, DarkPointsAreZeroAndDarkLensesNullopt) {
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

TEST(ImageCircle, EndsWithTheLight) {
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
      EXPECT_NEAR(seen_from_film(lens, radius, 600) / axis, part, 0.02) << part;
      const double beyond = film_irradiance(lens, {0, radius + 1.1e-4 * f});
      EXPECT_TRUE(part > 0 ? beyond < part * axis : beyond == 0) << beyond;
    }
  }
}

TEST(ImageCircle, ContainsTheDeclaredImage) {
  int declared = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    if (!p.image_diagonal_mm) continue;
    EXPECT_GE(image_circle_mm(compile(p)), *p.image_diagonal_mm) << p.id;
    ++declared;
  }
  EXPECT_GT(declared, 20);
}

TEST(ImageCircle, ScalesWithTheLens) {
  const Prescription p = testing::data_prescription("tessar_100mm_f2.8");
  const double circle = image_circle_mm(compile(p), 0.3);
  EXPECT_NEAR(image_circle_mm(compile(scale(p, 0.1)), 0.3), 0.1 * circle, 1e-9);
}

TEST(ImageCircle, HoldsInEveryDirectionForCylinders) {
  const Lens lens = data_lens("anamorphic_60mm_2x");
  const double radius = image_circle_mm(lens, 0.5) / 2, axis = film_irradiance(lens, {});
  for (int k = 0; k < 8; ++k) {
    const double angle = pi / 4 * k;
    EXPECT_GE(film_irradiance(lens, {radius * std::sin(angle), radius * std::cos(angle)}), 0.5 * axis);
  }
}

TEST(ImageCircle, IsZeroForDarkLensesAndLargeForOpenLenses) {
  const Lens lens = data_lens("tessar_100mm_f2.8");
  EXPECT_EQ(image_circle_mm(with_semi_diameter(lens, *lens.stop(), 0)), 0);
  Prescription p;
  p.name = "open";
  p.surfaces = {{.radius = 50, .thickness = 2, .medium = {.nd = 1.5}, .semi_diameter = 5, .stop = true},
                {.thickness = 100}};
  EXPECT_GT(image_circle_mm(compile(p)), 100);
  for (const double part : {-0.1, 1.1, std::nan("")}) {
    testing::expect_error([&] { image_circle_mm(lens, part); }, {lens.name(), "image circle", part, 0, 1});
  }
}

TEST(DefaultFilm, HasTheDeclaredDiagonalOrTheImageCircle) {
  const Lens lens = data_lens("biogon_35mm_f2.8");
  const auto diagonal = [](const Film& film) { return std::hypot(film.width_mm, film.height_mm); };
  const Film declared = default_film(lens, 40);
  EXPECT_NEAR(diagonal(declared), 40, 1e-12);
  EXPECT_NEAR(declared.width_mm / declared.height_mm, 1.5, 1e-12);
  EXPECT_EQ(declared.columns * 2, declared.rows * 3);
  const double circle = image_circle_mm(lens, 0.1);
  EXPECT_NEAR(diagonal(default_film(lens)), circle, 1e-9);
  EXPECT_NEAR(diagonal(default_film(lens, {}, circle / 2)), circle / 2, 1e-9);
  testing::expect_error([&] { default_film(lens, -1); }, {lens.name(), "film", "declared", -1});
  testing::expect_error([&] { default_film(with_semi_diameter(lens, lens.stop().value(), 0)); }, {lens.name(), "film"});
}

TEST(FilmIrradiance, StopWithoutRimIsLimitedByOtherRims) {
  const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(testing::open_singlet(10));
  EXPECT_EQ(film_irradiance(marked, {}), film_irradiance(unmarked, {}));
  EXPECT_EQ(film_irradiance(marked, {3, 5}), film_irradiance(unmarked, {3, 5}));
  EXPECT_NEAR(film_irradiance(marked, {}), 0.1256, 1e-4);
  EXPECT_GT(relative_illumination(marked, {0.1, -infinity}).value_or(0), 0.9);
  const Lens endless = compile(testing::open_singlet());
  EXPECT_EQ(testing::message([&] { film_irradiance(endless, {}); }), testing::message([&] { pupils(endless); }));
}

TEST(FilmIrradiance, TinyStopsGiveFiniteValues) {
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

}  // namespace illumination_test
}  // namespace petzval
