// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "../film_at.hpp"
#include "focus/plane_fit.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/fit/tilt_fit.hpp"

namespace petzval::testing {

/// A thin 50 mm lens, f/2.
inline IdealLens normal_lens() { return thin_lens(50, 2); }

/// The film at infinity focus, with a tilt.
inline TiltOptions behind(const IdealLens& lens, double max_tilt_deg = 20) {
  TiltOptions options{.max_tilt_rad = radians(max_tilt_deg)};
  options.film.z_mm = lens.rear_focal_z;
  return options;
}

inline FocusTarget target(double x, double y, double z, double weight = 1, double blur = 0) {
  return {.point = {{x, y, z}}, .blur_mm = blur, .weight = weight};
}

/// Angle between planes, radians; accurate for small angles.
inline double angle(const Vec3<double>& a, const Vec3<double>& b) {
  return std::asin(std::min(1.0, glm::length(glm::cross(a, b))));
}

/// The plane of points whose inverse distance is a x + b y + c.
struct Scene {
  double a, b, c;
  IdealLens lens;

  Vec3<double> at(double x, double y) const {
    return Vec3<double>(x, y, -1) / (a * x + b * y + c) + Vec3<double>(0, 0, lens.front_principal_z());
  }
  Plane plane() const {
    return focus_detail::plane_of({.rank = PlaneRank::plane, .a = a, .b = b, .c = c}, lens.front_principal_z()).value();
  }
  /// Points spread over the image.
  std::vector<FocusTarget> targets(int count, double half_x, double half_y, unsigned seed = 1) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<FocusTarget> list;
    for (int i = 0; i < count; ++i) {
      const double x = half_x * unit(random), y = half_y * unit(random);
      list.push_back({.point = {at(x, y)}});
    }
    return list;
  }
};

/// Weighted targets that no film satisfies; a third of the targets have a blur.
inline std::vector<FocusTarget> inexact_targets(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<FocusTarget> targets;
  for (int i = 0; i < count; ++i) {
    const double depth = 2500 + 1500 * unit(random), x = 0.36 * unit(random), y = 0.24 * unit(random);
    const double weight = 1.5 + unit(random), blur = i % 3 == 0 ? 0.05 * unit(random) : 0;
    targets.push_back(target(x * depth, y * depth, -depth, weight, blur));
  }
  return targets;
}

/// Distance of a film from the least cost nearby: the largest vertex of the parabolas through costs 1e-4 to both sides,
/// in position (in units of `unit`) and angles.
double off_least(const auto& cost, const Film& film, double unit) {
  constexpr double h = 1e-4;
  const double here = cost(film);
  const auto foot = [&](double z, double tilt, double swing) {
    const auto moved = [&](double by) {
      return cost(film_at(film.z() + by * z, film.tilt_rad + by * tilt, film.swing_rad + by * swing));
    };
    const double before = moved(-h), behind = moved(h);
    return std::abs(h / 2 * (behind - before) / (behind + before - 2 * here));
  };
  return std::max({foot(unit, 0, 0), foot(0, 1, 0), foot(0, 0, 1)});
}

}  // namespace petzval::testing
