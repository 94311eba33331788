// SPDX-License-Identifier: Apache-2.0
// Conservation of etendue: the flux on a film disc is equal, integrated on the film or in the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace etendue_test {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t samples = 1 << 13;

/// Radius about the axis in the plane z that contains the pupils of points at three heights, with a margin.
template <class BoundaryOf>
double reach(const BoundaryOf& boundary_of, double height, double z) {
  double farthest = 0;
  for (const double h : {0.0, height / 2, height}) {
    const PupilBoundary boundary = boundary_of(h);
    for (const PupilSpan& span : boundary.spans) {
      const Ray<double> ray = boundary.plane.ray(span.to.x, span.to.y);
      const double t = (z - ray.origin.z) / ray.direction.z;
      farthest = std::max(farthest, std::hypot(ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y));
    }
  }
  return 1.02 * farthest;
}

struct Interval {
  double from, to;
};

/// Intervals of a line from 0 to a limit that pass.
template <class Passes>
std::vector<Interval> intervals(const Passes& passes, double limit) {
  constexpr int steps = 16;
  std::vector<Interval> result;
  const auto edge = [&](double with, double without) {
    for (int i = 0; i < 20; ++i) (passes((with + without) / 2) ? with : without) = (with + without) / 2;
    return (with + without) / 2;
  };
  bool last = passes(0.0);
  if (last) result.push_back({0, limit});
  for (int i = 1; i <= steps; ++i) {
    const double before = limit * (i - 1) / steps, now = limit * i / steps;
    const bool passing = passes(now);
    if (passing && !last) result.push_back({edge(now, before), limit});
    if (!passing && last) result.back().to = edge(before, now);
    last = passing;
  }
  EXPECT_FALSE(last);  // the limit is outside the pupil
  return result;
}

/// Integral over a disc and the pupils of its points. Sobol points cover the radius in the disc and the angle in the
/// pupil; rotational symmetry removes the angle in the disc; inner(height, x, y) integrates along the radius of the
/// pupil in the direction (x, y).
template <class Inner>
double sum(double disc_radius, std::uint32_t seed, const Inner& inner) {
  double total = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const auto uv = owen_sobol(i, seed);
    const double u = uv.x, v = uv.y;
    total += inner(disc_radius * std::sqrt(u), std::sin(pi * v), std::cos(pi * v));
  }
  return total * pi * disc_radius * disc_radius * 2 * pi / samples;
}

/// Integral over film points of the projected solid angle of the exit pupil.
double from_film(const Lens& lens, double radius, double limit, std::uint32_t seed) {
  const double z = pupils(lens).exit.z, gap = lens.film_z() - z, n = lens.index(lens.surface_count(), 0);
  const auto seen = [&](double height, double x, double y) {
    const auto passes = [&](double r) {
      const double dx = r * x, dy = r * y - height, length = std::copysign(std::hypot(dx, dy, gap), gap);
      const Ray<double> ray{{r * x, r * y, z}, {dx / length, dy / length, -gap / length}};
      return trace(lens, ray, {.travel = Travel::to_scene}).transmitted();
    };
    double value = 0;
    for (const auto& [from, to] : intervals(passes, limit)) {
      // Gauss-Legendre quadrature of cos^4 / gap^2.
      for (const auto& [node, weight] : {std::pair{-std::sqrt(0.6), 5.0}, {0.0, 8.0}, {std::sqrt(0.6), 5.0}}) {
        const double r = (from + to + node * (to - from)) / 2, dx = r * x, dy = r * y - height;
        const double squared = dx * dx + dy * dy + gap * gap;
        value += weight / 18 * (to - from) * r * gap * gap / (squared * squared);
      }
    }
    return value;
  };
  return n * n * sum(radius, seed, seen);
}

/// Integral over scene directions of the area of the entrance pupil, projected along the direction.
double from_scene(const Lens& lens, double radius, double steepest, double limit, std::uint32_t seed) {
  const double z = pupils(lens).entrance.z;
  return sum(steepest, seed, [&](double sine, double x, double y) {
    const auto passes = [&](double r) {
      const auto end = trace(lens, Ray<double>{{r * x, r * y, z}, {0, sine, std::sqrt(1 - sine * sine)}});
      if (!end.transmitted()) return false;
      const auto &o = end.ray.origin, &d = end.ray.direction;
      const double t = (lens.film_z() - o.z) / d.z;
      return std::hypot(o.x + t * d.x, o.y + t * d.y) <= radius;
    };
    double value = 0;
    for (const auto& [from, to] : intervals(passes, limit)) value += (to - from) * (to + from) / 2;
    EXPECT_TRUE(value == 0 || sine < 0.99 * steepest);
    return value;
  });
}

struct Disc {
  const char* lens;
  double radius, steepest;  ///< mm on the film; upper bound for the sine of the field of its rays
};

std::ostream& operator<<(std::ostream& out, const Disc& d) { return out << d.lens; }

class Etendue : public ::testing::TestWithParam<Disc> {};

TEST_P(Etendue, FilmDiscIsEqualFromBothSides) {
  const auto [id, radius, steepest] = GetParam();
  const Lens lens = testing::data_lens(id);
  const Pupils p = pupils(lens);
  const double rear = reach([&](double h) { return exit_pupil_boundary(lens, {0, h}, 0, 64); }, radius, p.exit.z);
  const double front = reach(
      [&](double s) {
        return pupil_boundary(lens, {std::asin(s), -std::numeric_limits<double>::infinity()}, 0, 64);
      },
      steepest, p.entrance.z);
  const double film = from_film(lens, radius, rear, 1), scene = from_scene(lens, radius, steepest, front, 2);
  EXPECT_NEAR(scene / film, 1, 3e-4);
  RecordProperty("ratio_less_1", std::to_string((scene / film - 1) * 1e6) + "e-6");
}

// A fast lens, a lens limited by several rims, a fisheye, and an eye with water in image space.
INSTANTIATE_TEST_SUITE_P(Lenses, Etendue,
                         ::testing::Values(Disc{"double_gauss_100mm_f2.0", 20, 0.22},
                                           Disc{"modern_58mm_f0.95", 10, 0.2}, Disc{"fisheye_10mm_f4", 5, 0.53},
                                           Disc{"eye_gullstrand_le_grand", 2, 0.14}));

}  // namespace etendue_test
}  // namespace petzval
