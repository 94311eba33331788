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

/// Pupils at the nodes of grids over two coordinates of their points: film coordinates or directions in the scene.
namespace petzval::pupil_table_detail {

/// The points of a grid, row by row.
struct GridOfPoints {
  std::span<const pupil_detail::PupilGuess> guesses;
  std::size_t row = 1;  ///< points per row; 1 for points without neighbours
};

/// Finds pupils near the pupils of neighbours. A lost pupil is searched near the pupils of all neighbours, or in the
/// whole plane if no pupil has been found.
/// @param directions number of directions of the regions; even
std::vector<PupilRegion> grid_pupils(const GridOfPoints& grid, std::size_t directions,
                                     const pupil_detail::PositionClearances& clearances);

/// The polygon at every second point of a grid in both directions, without obscurations. A node without a pupil takes
/// the pupil of the next point that has one; with PolygonFit::equal_area this polygon has no area.
std::vector<PupilPolygon> node_polygons(std::span<const PupilRegion> pupils, std::size_t row, PolygonFit fit);

/// Makes the corners symmetric about x = 0, or about y = 0; each pair of corners takes the position of its outer
/// corner.
void mirror(PupilPolygon& polygon, bool x) noexcept;

/// A polygon that contains the convex hull of several polygons.
PupilPolygon hull(const std::vector<PupilPolygon>& polygons);

/// Interpolation weights of the nodes at a probe, which is given by three or four numbers in [0, 1].
using ProbeWeights = std::function<PolygonWeights(const std::array<double, 4>& position)>;
/// Computes clearances like PlaceClearances, for positions in the planes of probes; places[which[i]] are the numbers of
/// the probe of position i.
using ProbeClearances =
    std::function<void(std::span<const std::array<double, 4>> positions, std::span<const std::uint32_t> which,
                       const double* x, const double* y, double* clearances)>;

/// Tests positions just outside the interpolated polygons of probes in all parts of a table, and expands the polygons
/// if a ray passes there.
/// @param probes number of probes in each of up to four rounds
void expand_to_probes(std::span<PupilPolygon> polygons, std::size_t probes, const ProbeWeights& weights,
                      const ProbeClearances& clearances);

}  // namespace petzval::pupil_table_detail
