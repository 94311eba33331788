// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "pupil/boundary_search.hpp"
#include "pupil_table/pupil_polygon.hpp"

/// Polygons at the nodes of charts over one to three coordinates of film or scene points.
namespace petzval::pupil_table_detail {

/// Coordinates of a point: fractions in [0, 1] of their ranges.
using ChartPoint = std::array<double, 3>;

/// Equally spaced points of a chart, in layers of rows.
struct Lattice {
  /// Steps between the points along each coordinate; 0: one point in the middle, whose value applies everywhere.
  std::array<std::size_t, 3> steps{};

  constexpr std::size_t row() const noexcept { return steps[2] + 1; }
  constexpr std::size_t layer() const noexcept { return (steps[1] + 1) * row(); }
  constexpr std::size_t size() const noexcept { return (steps[0] + 1) * layer(); }
  ChartPoint point(std::size_t index) const noexcept;
  /// Interpolation weights, linear in each coordinate.
  PolygonWeights weights(const ChartPoint& at) const noexcept;
};

/// A set of film or scene points for which a table holds pupils.
struct PupilChart {
  using Points = std::span<const ChartPoint>;

  Lattice nodes;   ///< points whose polygons are stored
  Lattice points;  ///< points whose pupils are searched: the nodes, points halfway between, or more layers
  /// True if pupils are symmetric about x = 0 at the first column, and about y = 0 at the first row; false if all
  /// pupils are symmetric about x = 0.
  bool quadrant = false;
  std::size_t directions = 32;  ///< of the regions from which polygons are made
  std::function<std::vector<pupil_detail::PupilGuess>(Points)> guesses{};
  /// Clearances of positions in the planes of some points; must not refer to the span of points.
  std::function<pupil_detail::PositionClearances(Points)> clearances{};
  /// Set if only the component around the chief ray counts.
  std::function<pupil_detail::ConnectedPupils(Points)> connected{};
  bool probed = true;  ///< true to test interpolated polygons between the points
};

/// The polygon between some nodes, interpolated when its numbers are asked for.
struct PolygonBetween {
  std::span<const PupilPolygon> polygons;
  const PolygonWeights& at;

  Point<double> middle() const noexcept;
  Sector<double> sector(std::size_t k) const noexcept;
  /// Radial fraction of a position: 0 at the middle, 1 at the outer edge; -1 if the position is obscured, infinite if
  /// no sector faces it.
  double relative_radius(const Vec2<double>& position) const noexcept;
};

/// True for each point from which rays pass. Unlike pupil_detail::lit_points(), looks beside the line of a guess, where
/// the pupils of the corners of a film lie behind cylinders.
std::vector<bool> lit_in_plane(std::span<const pupil_detail::PupilGuess> guesses,
                               const pupil_detail::PositionClearances& clearances);

/// The polygons at the nodes; without obscurations if the chart is a quadrant. A node without a pupil takes the
/// largest pupil of the adjacent cells; with PolygonFit::equal_area this polygon has no area. With
/// PolygonFit::enclosing interpolated polygons contain the pupils between nodes.
std::vector<PupilPolygon> node_polygons(const PupilChart& chart, PolygonFit fit);

}  // namespace petzval::pupil_table_detail
