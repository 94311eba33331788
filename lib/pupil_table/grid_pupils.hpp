// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pupil/boundary_search.hpp"
#include "pupil_table/pupil_polygon.hpp"

/// Pupils at the nodes of grids over two coordinates of their points: of the film, of the directions of the scene.
namespace petzval::pupil_table_detail {

/// The points of a grid, row by row.
struct GridOfPoints {
  std::span<const pupil_detail::PupilGuess> guesses;
  std::size_t row = 1;  ///< points in one; 1: points without neighbours
};

/// Finds pupils next to those of neighbours, and looks for those that are lost beside these too, and all over their
/// plane where nothing else is found. directions: of the regions, even.
std::vector<PupilRegion> grid_pupils(const GridOfPoints& grid, std::size_t directions,
                                     const pupil_detail::PlaceClearances& clearances);

/// The polygon at each second point of a grid in both directions: of its pupil or, where the light ends beside it, that
/// of the next point with light. Without obscurations. Of equal area: shrunk to nothing there.
std::vector<PupilPolygon> node_polygons(std::span<const PupilRegion> pupils, std::size_t row, PolygonFit fit);

/// Makes the corners alike at x and -x, or at y and -y: of each two the outer one counts.
void mirror(PupilPolygon& polygon, bool x) noexcept;

/// The one polygon that contains all of some others.
PupilPolygon hull(const std::vector<PupilPolygon>& polygons);

/// Where a probe stands among the nodes, by three or four numbers in [0, 1].
using ProbeWeights = std::function<PolygonWeights(const std::array<double, 4>& place)>;
/// At N places of the planes of probes, as PlaceClearances, with the numbers of each probe.
using ProbeClearances =
    std::function<void(std::span<const std::array<double, 4>> places, std::span<const std::uint32_t> which,
                       const double* x, const double* y, double* clearances)>;

/// Tests places just outside the interpolated polygons of points all over a table, and expands polygons where one
/// passes. probes: in each of up to four rounds.
void expand_to_probes(std::span<PupilPolygon> polygons, std::size_t probes, const ProbeWeights& weights,
                      const ProbeClearances& clearances);

}  // namespace petzval::pupil_table_detail
