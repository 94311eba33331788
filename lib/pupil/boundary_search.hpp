// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "line_extents.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// Predicted position of the pupil of a point. The search looks near (x, y) first, then along a line across the whole
/// region of the plane that may contain the pupil.
struct PupilGuess {
  double x = 0, low = -1, high = 1;  ///< the line runs from (x, low) to (x, high)
  double radius = 1;                 ///< approximate radius of the pupil
  double y = 0, near = 0;            ///< the search begins between y - near and y + near; near = 0: no prediction
  bool ring = false;                 ///< true if the lens has a central obscuration: the pupil may be a clipped ring
};

/// A point about halfway between two neighbours, from whose pupils its pupil is predicted. The far neighbours continue
/// the same spacing on both sides; equal to `point` if there is no far neighbour.
struct Halfway {
  std::uint32_t point, before, after, far_before, far_after;
};

/// Order in which pupils are searched: some points in full, then the points halfway between them, in rounds.
struct SearchOrder {
  std::vector<std::uint32_t> full;
  std::vector<std::vector<Halfway>> rounds;

  /// Order for points in rows of length `row`; adjacent points of a row have similar pupils.
  static SearchOrder rows(std::size_t points, std::size_t row);
  /// Order for a grid in which adjacent rows have similar pupils: two columns first, then the rows between them.
  static SearchOrder grid(std::size_t rows, std::size_t row);

 private:
  struct Line {
    std::size_t begin, stride, count;

    std::uint32_t at(std::size_t index) const noexcept { return static_cast<std::uint32_t>(begin + stride * index); }
  };
  void halve(const Line& line, std::size_t first_step, std::size_t first_round);
};

/// Makes the pupils of a lens connected: only the component around the chief ray is kept.
struct ConnectedPupils {
  /// Position of the chief ray of a point; nullopt selects the widest component. Called only for disconnected pupils.
  std::function<std::optional<Vec2<double>>(std::uint32_t point)> chief;
  /// Clearances of a lens with its central obscurations, which may divide its pupils; empty if the lens has no
  /// obscurations. If set, the clearances passed to find_regions() must ignore the obscurations.
  PositionClearances obscured{};
};

/// Finds the pupils of many points together, in batches. pupil_boundary() is exact to 2e-13 and knows the rims. This
/// search also works for models without rims, and uses neighbouring pupils as predictions.
///
/// Accuracy: 2e-5 of the half axes. In a direction with several obscurations only the widest obscuration has this
/// accuracy; the others are as coarse as the samples. The RimPoints of the result name no surface.
/// @param directions number of directions; even
/// @param mirrored true if the pupils are symmetric about x = 0; only half of the directions are traced then
/// @param connected selects one component; null keeps all components that the search lines meet
std::vector<PupilRegion> find_regions(std::span<const PupilGuess> points, const SearchOrder& order,
                                      std::size_t directions, bool mirrored, const PositionClearances& clearances,
                                      const ConnectedPupils* connected = nullptr);

/// True for each point with at least one ray that passes, at the resolution of find_regions().
std::vector<bool> lit_points(std::span<const PupilGuess> points, const PositionClearances& clearances);

}  // namespace petzval::pupil_detail
