// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "petzval/iris/iris.hpp"

namespace petzval::testing {

/// Distance of a point inside the nearest edge of an iris, in semi-diameters of the stop; infinite for a round iris.
/// Computed from the corners and the angles between edges and chords.
inline double room_between_blades(const Iris& iris, double x, double y) {
  constexpr double pi = std::numbers::pi;
  double room = std::numeric_limits<double>::infinity();
  for (int k = 0; k < iris.blades; ++k) {
    const auto corner = [&](int i) { return pi / 2 + iris.rotation_rad + 2 * pi * i / iris.blades; };
    const double ax = std::cos(corner(k)), ay = std::sin(corner(k));
    const double bx = std::cos(corner(k + 1)), by = std::sin(corner(k + 1));
    const double chord = std::hypot(bx - ax, by - ay), nx = (by - ay) / chord, ny = (ax - bx) / chord;
    const double mx = (ax + bx) / 2, my = (ay + by) / 2, own = pi / iris.blades;
    const double angle = iris.roundness * (iris.roundness < 0 ? std::min(own, pi / 4 - own / 2) : own);
    const double out = (x - mx) * nx + (y - my) * ny, square = (x - mx) * (x - mx) + (y - my) * (y - my);
    double here = -out;
    if (angle != 0) {  // radius - away, without the cancellation of large radii
      const double radius = chord / 2 / std::sin(angle), to_middle = radius * std::cos(angle);
      const double away = std::hypot(x - mx + to_middle * nx, y - my + to_middle * ny);
      here = (chord * chord / 4 - square - 2 * out * to_middle) / (radius + std::copysign(away, radius));
    }
    room = std::min(room, here);
  }
  return room;
}

}  // namespace petzval::testing
