// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pupil/boundary_search.hpp"

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

}  // namespace petzval::pupil_table_detail
