// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "line_extents.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "search_order.hpp"

namespace petzval::pupil_detail {

/// Where to look for the pupil of a point: first where it is expected, near (x, y), then along a line across the whole
/// part of the plane that is in question.
struct PupilGuess {
  double x = 0, low = -1, high = 1;  ///< the line runs from (x, low) to (x, high)
  double radius = 1;                 ///< about that of the pupil
  double y = 0, near = 0;            ///< the search begins between y - near and y + near; 0: nothing is expected
  bool ring = false;  ///< the lens has a central obscuration: the pupil may be what is left of a ring about (x, y)
};

/// Makes the pupils of a lens connected sets: of several parts that pass, the part about the chief ray counts.
struct ConnectedPupils {
  /// Place of the chief ray of a point; nullopt if there is none: the widest part counts. Called where it matters.
  std::function<std::optional<Vec2<double>>(std::uint32_t point)> chief;
  /// Clearances of a lens with its central obscurations, which may divide its pupils; empty: the lens has no
  /// obscurations. If it is set, find_regions() takes the clearances of the lens without obscurations.
  PlaceClearances obscured{};
};

/// The regions of many points at once, in batches, to 2e-5 of the half axes.
///
/// pupil_boundary() is exact to 2e-13 and knows the rims; here models without rims are asked too, and neighbours tell
/// where to look. Of a direction with several obscurations the widest is known well, the others roughly; the surfaces
/// of the RimPoints are unknown.
///
/// mirrored: pupils are alike at x and -x, and half of the directions are traced. directions: even. connected: null:
/// all parts count that lie along the lines that are looked at.
std::vector<PupilRegion> find_regions(std::span<const PupilGuess> points, const SearchOrder& order,
                                      std::size_t directions, bool mirrored, const PlaceClearances& clearances,
                                      const ConnectedPupils* connected = nullptr);

/// Of which points anything passes, as far as find_regions() would see it.
std::vector<bool> lit_points(std::span<const PupilGuess> points, const PlaceClearances& clearances);

}  // namespace petzval::pupil_detail
