// SPDX-License-Identifier: Apache-2.0
// Lines of object space as two vectors, which rotate with the line about the axis; over a scalar V (core/scalar.hpp).
//
// s is the stereographic projection of its direction d towards the scene, d = (2 s, |s|^2 - 1) / (1 + |s|^2): 0 along
// the axis, of length 1 at 90 degrees, infinite only for a line along +z. o points from a reference point on the axis
// to the foot of the perpendicular on the line, rotated back by the shortest rotation R that takes -z to d. R takes a
// vector v across the axis to v - (v.h) h / (1 - d_z), h = d - z, which is (v, 0) + 2 (s.v) (-s, 1) / (1 + |s|^2). The
// inverse of R takes a vector w across d to w_xy + w_z s.
#pragma once

#include <array>

#include "core/scalar.hpp"
#include "core/simd.hpp"

namespace petzval::polynomial_detail {
namespace {

using core_detail::sum_of_products;

/// (fx, fy, px, py): film and pupil point, in mm or scaled to the domain; or (sx, sy, ox, oy): a line; or four sums of
/// terms.
template <class V>
using Four = std::array<V, 4>;
/// Origin, relative to the reference point, and direction towards the scene.
template <class V>
using LocalRay = std::array<V, 6>;

template <class V>
PETZVAL_INLINE Four<V> into_chart(const LocalRay<V>& ray) noexcept {
  const auto& [x, y, z, dx, dy, dz] = ray;
  const V per_length = V(1) / (V(1) - dz);
  const V sx = dx * per_length, sy = dy * per_length;
  const V along = x * dx + y * dy + z * dz;
  const V foot_z = z - along * dz;
  return {sx, sy, x - along * dx + foot_z * sx, y - along * dy + foot_z * sy};
}

/// The line (0, 0, 0, 0) is the axis.
template <class V>
PETZVAL_INLINE LocalRay<V> out_of_chart(const Four<V>& line) noexcept {
  using R = kernel::Storage<V>;
  const auto& [sx, sy, ox, oy] = line;
  const V square = sum_of_products(sx, sx, sy, sy);
  const V twice = R(2) / (square + R(1));
  const V along = twice * sum_of_products(sx, ox, sy, oy);
  return {ox - sx * along, oy - sy * along, along, twice * sx, twice * sy, twice * (square - R(1)) / R(2)};
}

}  // namespace
}  // namespace petzval::polynomial_detail
