// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pupil/pupil_boundary.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::pupil_table_detail {

/// A pupil in a table: a middle point and 64 corners around it, with an obscuration in each sector (sector.hpp).
struct PupilPolygon {
  Vec2<double> middle{0, 0};
  std::array<Vec2<double>, polygon_corners> corners{};              ///< relative to the middle
  std::array<double, polygon_corners> obscured_from{}, obscured{};  ///< by sector

  Sector<double> sector(std::size_t k) const noexcept {
    const auto &a = corners[k], &b = corners[(k + 1) % polygon_corners];
    return {{a[0], a[1]}, {b[0], b[1]}, obscured_from[k], obscured[k]};
  }

  /// The polygon of the numbers of a node (NodeLayout), and its inverse.
  static PupilPolygon of(const double* node) noexcept;
  void append_to(std::vector<double>& nodes) const;

  /// Area, mm^2.
  double area() const noexcept;
  /// True if a sector is partly obscured.
  bool is_obscured() const noexcept;

  /// Scales the corners outwards, and divides the outer radii of obscurations by the same factor.
  void widen(double by) noexcept;
  /// Scales each corner outwards by at least 1, and keeps the obscurations in place.
  void stretch(const std::array<double, polygon_corners>& scale) noexcept;
};

enum class PolygonFit {
  enclosing,   ///< contains the region
  equal_area,  ///< has the area of the region
};

/// The polygon of a region, with corners at equal steps of its area in the half at +x and in the half at -x: corner 32
/// lies towards -y.
PupilPolygon polygon_of(const PupilRegion& region, PolygonFit fit);

/// The polygon with the area of a region about a middle point that each line outwards leaves once.
/// @param half_y half of the region's extent along y
/// @param leaves function; leaves(d) is the fraction of d at which the line from the middle along d leaves the region
template <class Leaves>
PupilPolygon polygon_within(const Vec2<double>& middle, double half_y, const Leaves& leaves) {
  PupilRegion region{.directions = 2 * polygon_corners};
  region.middle = middle;
  region.half_axes = {leaves(Vec2<double>{1, 0}), half_y};
  for (std::size_t k = 0; k < region.directions; ++k) {
    const double end = leaves(region.half_axes * region.unit(k));
    const Vec2<double> rim = region.at(k, end);
    region.spans.push_back({k, 0, end, {middle.x, middle.y}, {rim.x, rim.y}});
  }
  return polygon_of(region, PolygonFit::equal_area);
}

/// Some polygons of a table and their interpolation weights.
struct PolygonWeights {
  std::array<std::size_t, 8> polygons{};
  std::array<double, 8> weights{};
};
PupilPolygon interpolated(std::span<const PupilPolygon> polygons, const PolygonWeights& at) noexcept;

/// A region that the interpolated polygon must contain.
struct InterpolationCheck {
  const PupilRegion* region = nullptr;
  PolygonWeights at;
};
/// Expands polygons until every check holds.
void expand_to_cover(std::span<PupilPolygon> polygons, std::span<const InterpolationCheck> checks);

/// Expands the polygon of one wavelength to contain the pupils up to halfway to an adjacent wavelength, whose polygon
/// is `other`. Assumes that edges move nearly linearly with the wavelength.
void expand_towards(PupilPolygon& polygon, const PupilPolygon& other) noexcept;

}  // namespace petzval::pupil_table_detail
