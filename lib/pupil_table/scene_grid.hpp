// SPDX-License-Identifier: Apache-2.0
// Pupils of scene points: charts of a PupilGrid over the reciprocal distance and the field of a point, and rays from
// samples. Names are local: compiled for several instruction sets, which the linker must not mix.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pupil_table/pupil_kernel.hpp"

namespace petzval::pupil_table_detail {

/// Largest coordinate of a scene point, mm: squares of distances must be finite.
inline constexpr double farthest_point = 1e100;

/// Sampled rays, N of each.
struct EntranceRays {
  double *x, *y, *z;       ///< position in the pupil plane, lens frame, mm
  double *dx, *dy, *dz;    ///< unit, towards the lens
  double *distance, *pdf;  ///< distance from the scene point, mm; density, 1/sr
};

/// A direction from the centre of a table: its angle with the axis (-z), rad, and its azimuth.
template <class V>
struct Bearing {
  V field, field_sine, field_cosine;
  V cosine, sine;  ///< of the azimuth, from +y towards +x
};

namespace {

/// Ray from a scene point through a position in the facing plane, relative to the centre of the table.
template <class V>
struct RayToLens {
  V x, y, z, dx, dy, dz;
  V distance, per_area;  ///< distance to the position, mm; area of the plane per solid angle, mm^2/sr
};

template <class V>
PETZVAL_INLINE Bearing<V> bearing_of(const V& unit_x, const V& unit_y, const V& unit_z) noexcept {
  const V across2 = unit_x * unit_x + unit_y * unit_y, sine = sqrt(across2);
  constexpr double whole_turn = 6.283185307179586;
  const Mask<V> off_axis = across2 > V(axis_r2<double>);
  const V per_sine = V(1) / select(off_axis, sine, V(1));
  return {V(whole_turn) * turn_of(sine, V(-unit_z)), sine, -unit_z, select(off_axis, V(unit_y * per_sine), V(1)),
          select(off_axis, V(unit_x * per_sine), V(0))};
}
template <class V>
PETZVAL_INLINE RayToLens<V> ray_to_lens(const Bearing<V>& b, const V& distance, const Point<V>& p) noexcept {
  const V x = b.cosine * p.x + b.sine * b.field_cosine * p.y, y = b.cosine * b.field_cosine * p.y - b.sine * p.x;
  const V z = b.field_sine * p.y, per_distance = V(1) / positive_or_one(distance);
  const V dx = x * per_distance - b.sine * b.field_sine, dy = y * per_distance - b.cosine * b.field_sine;
  const V dz = z * per_distance + b.field_cosine, per_length = V(1) / sqrt(V(dx * dx + dy * dy + dz * dz));
  const V far2 = distance * distance + (p.x * p.x + p.y * p.y), far = sqrt(far2);
  return {x, y, z, dx * per_length, dy * per_length, dz * per_length, far, far2 * (far * per_distance)};
}

/// The nodes around a scene point.
template <class V, int count>
struct SceneCell : Cell<V, count> {
  Bearing<V> bearing;
  V distance;  ///< from the centre, mm
};

}  // namespace

/// Scene points relative to the centre of a table. With one angle, the field, polygons rotate with the azimuth of the
/// point. With two angles, field times azimuth direction, cells cover the quadrant x, y >= 0, and pupils of the other
/// quadrants are mirror images. Polygons lie in the planes that face their points (PupilPlane::facing).
template <int number_of_angles>
struct SceneChart {
  static constexpr int angles = number_of_angles, cell_nodes = 1 << (angles + 1);
  static constexpr std::int32_t distances = 2, fields = angles == 1 ? 12 : 6;  ///< cells along each axis
  static constexpr std::int32_t row = fields + 1, layer = angles == 1 ? row : row * row;
  static constexpr std::int32_t limits = (distances + 1) * angles;
  const double* widest = nullptr;     ///< [wavelength][distance][angle] last field, rad; 0 without pupils
  double centre_z = 0, steepest = 0;  ///< mm, 1/mm: largest reciprocal distance
  double front_half = 0;              ///< half height of the front surface, mm

  static constexpr std::int32_t nodes() noexcept { return (distances + 1) * layer; }
  static constexpr std::int32_t offset(int node) noexcept {
    return node % 2 + node / 2 % 2 * row + node / 4 * layer;  // with one angle, a layer is a row
  }
  /// The last fields at a fraction of the largest reciprocal distance.
  template <class V>
  PETZVAL_INLINE std::array<V, angles> last(const V& fraction, const Index<V>& wavelength) const noexcept {
    const Step<V> at = step_of(V(fraction * V(distances)), distances);
    const auto n = rows<2 * angles, V>(widest, Index<V>(wavelength * limits + at.cell * angles));
    std::array<V, angles> result;
    for (std::size_t k = 0; k < angles; ++k) result[k] = n[k] + at.rest * (n[angles + k] - n[k]);
    return result;
  }
  /// The angles of the chart.
  template <class V>
  static PETZVAL_INLINE std::array<V, angles> angles_of(const Bearing<V>& b) noexcept {
    if constexpr (angles == 1) {
      return {b.field};
    } else {
      return {b.field * kernel::absolute(b.sine), b.field * kernel::absolute(b.cosine)};
    }
  }
  /// @param sound mask of the points that may have a pupil
  /// @param wavelength index of the wavelength
  template <class V>
  PETZVAL_INLINE SceneCell<V, cell_nodes> find(const V& x, const V& y, const V& z, const Mask<V>& sound,
                                               const Index<V>& wavelength) const noexcept {
    const V end(farthest_point), zero(0);
    // Comparisons with NaN are false.
    const Mask<V> bounded =
        all_of(kernel::absolute(x) <= end, kernel::absolute(y) <= end, kernel::absolute(z) <= end) & sound;
    const V px = select(bounded, x, zero), py = select(bounded, y, zero);
    const V pz = select(bounded, V(z - V(centre_z)), zero);
    const V r2 = px * px + py * py, distance = sqrt(V(r2 + pz * pz)), per_distance = V(1) / positive_or_one(distance);
    const Bearing<V> bearing = bearing_of(V(px * per_distance), V(py * per_distance), V(pz * per_distance));
    // Points outside the front surface's rim may have fields of more than 90 degrees.
    const Mask<V> in_front = (r2 > V(front_half * front_half)) | (pz < zero);
    Mask<V> known = all_of(bounded, in_front, V(steepest) * distance >= V(1));
    const V fraction = select(known, lesser(V(per_distance / V(steepest)), V(1)), zero);
    const auto limit = last(fraction, wavelength), own = angles_of(bearing);
    std::array<V, angles> part;
    for (std::size_t k = 0; k < angles; ++k) part[k] = own[k] / limit[k], known = known & (part[k] <= V(1));
    // Axes of the grid, from the fastest: with two angles x, y, distance.
    const Step<V> far = step_of(V(fraction * V(distances)), distances);
    std::array<V, angles + 1> rest;
    Index<V> first = wavelength * nodes() + far.cell * layer;
    for (std::size_t k = 0; k < angles; ++k) {
      const Step<V> at = step_of(V(select(known, part[k], zero) * V(fields)), fields);
      rest[k] = at.rest, first = first + at.cell * (k == 0 ? 1 : row);
    }
    rest[angles] = far.rest;
    SceneCell<V, cell_nodes> cell{{{}, bearing.cosine, bearing.sine, known, first}, bearing, distance};
    for (int node = 0; node < cell_nodes; ++node) {
      const auto weight = [&](std::size_t k) { return (node >> k & 1) != 0 ? rest[k] : V(V(1) - rest[k]); };
      V product = weight(0);
      for (std::size_t k = 1; k <= angles; ++k) product = weight(k) * product;
      cell.weights[static_cast<std::size_t>(node)] = product;
    }
    return cell;
  }
  /// Samples start at the first corner of the polygon.
  template <class V>
  static PETZVAL_INLINE V fraction(const Cell<V, cell_nodes>&, const V& u) noexcept {
    return u;
  }
  /// Rotates a point of the facing plane from the frame of the polygons to the frame of the scene point, and back.
  /// @param at a cell or a Bearing
  template <class At, class V>
  static PETZVAL_INLINE Point<V> to_film(const At& at, const Point<V>& p) noexcept {
    if constexpr (angles == 1) {
      return p;
    } else {
      const V x = sign_of(at.sine) * p.x, y = sign_of(at.cosine) * p.y;
      return {at.cosine * x - at.sine * y, at.sine * x + at.cosine * y};
    }
  }
  template <class At, class V>
  static PETZVAL_INLINE Point<V> to_grid(const At& at, const Point<V>& p) noexcept {
    if constexpr (angles == 1) {
      return p;
    } else {
      return {sign_of(at.sine) * (at.cosine * p.x + at.sine * p.y),
              sign_of(at.cosine) * (at.cosine * p.y - at.sine * p.x)};
    }
  }
};

template <int angles>
using SceneGrid = PupilGrid<SceneChart<angles>, double>;

namespace {

/// A sample of a scene point: position in the pupil plane, direction, distance and density as in EntranceRays; density
/// 0 if the grid has no polygon for the point.
/// @param sound, wavelength see SceneChart::find()
template <bool obscured, class V, int angles>
PETZVAL_INLINE std::array<V, 8> scene_sample(const SceneGrid<angles>& grid, const V& x, const V& y, const V& z,
                                             const V& u, const V& v, const Mask<V>& sound,
                                             const Index<V>& wavelength) noexcept {
  const auto cell = grid.chart.find(x, y, z, all_of(sound, (u + v) * V(0) >= V(0)), wavelength);  // u and v are finite
  const PupilPoint<V> at = in_polygon<obscured, false, V>(grid, cell, u, v);
  const RayToLens<V> ray = ray_to_lens(cell.bearing, cell.distance, {at.x, at.y});
  const V pdf = select(at.area > V(0), V(ray.per_area * (V(1) / positive_or_one(at.area))), V(0));
  return {ray.x, ray.y, ray.z + V(grid.chart.centre_z), ray.dx, ray.dy, ray.dz, ray.distance, pdf};
}

}  // namespace
}  // namespace petzval::pupil_table_detail
