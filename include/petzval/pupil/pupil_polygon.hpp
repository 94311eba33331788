// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"

/// Pupils as tables hold them: found by tracing their edges, kept as stars of 64 corners.
namespace petzval::inline v0::pupil_detail {

inline constexpr std::size_t polygon_corners = 64;

/// Where the light of one field passes a plane: for each of equally spaced angles about `middle`, in coordinates
/// divided by `half_axes`, from the middle to one distance, but for a gap (a hole of the lens; a ring of strongly
/// aberrated rays about the others). Nothing passes along a direction whose `to` is 0.
struct PupilEdges {
  std::array<double, 2> middle{0, 0}, half_axes{0, 0};
  std::vector<double> gap_from, gap_to;  ///< [direction], equal where there is none; from 0 where the middle is dark
  std::vector<double> to;                ///< [direction]; empty: nothing passes at all

  bool empty() const noexcept { return to.empty(); }
  /// Place in the plane at a direction (0: +y, turning to +x; may lie between two) and a distance.
  std::array<double, 2> at(double direction, double distance) const noexcept;
};

/// Where to look for the pupil of a field: first, where one is expected, near (x, y), then along a line across all of
/// the plane that is in question.
struct PupilGuess {
  double x = 0, low = -1, high = 1;  ///< the line runs from (x, low) to (x, high)
  double radius = 1;                 ///< about that of the pupil
  double y = 0, near = 0;            ///< the search begins between y - near and y + near; 0: nothing is expected
  bool ring = false;                 ///< the lens has a hole: the pupil may be what is left of a ring about (x, y)
};

/// Which of N points of the plane the light of their fields passes: passes[i] for (x[i], y[i]) and fields[i].
using Passing = std::function<void(std::size_t count, const std::uint32_t* fields, const double* x, const double* y,
                                   std::uint8_t* passes)>;

/// The edges of all fields at once, by bisection in batches, to 2e-5 of the half axes. row: fields stand in rows of so
/// many, in which neighbours have pupils that are much alike. mirrored: pupils are alike at x and -x, and half of their
/// directions are traced. directions: a multiple of 4.
PETZVAL_API std::vector<PupilEdges> find_edges(std::span<const PupilGuess> fields, std::size_t row,
                                               std::size_t directions, bool mirrored, const Passing& passing);

/// A region of a plane: a middle and 64 corners around it in order, from +y to +x. Sector k lies between the corners k
/// and k + 1; of the way from the middle to its outer edge a part may be missing, a hole or a gap.
struct PupilPolygon {
  std::array<double, 2> middle{0, 0};
  std::array<std::array<double, 2>, polygon_corners> corners{};  ///< from the middle
  std::array<double, polygon_corners> gap_from{}, gap{};         ///< begin and width as squared fractions, by sector

  /// What each sector adds to the area, mm^2.
  std::array<double, polygon_corners> areas() const noexcept;
};

/// Spreads points evenly by area over a star, which it does not keep.
class PETZVAL_API PolygonSampler {
 public:
  explicit PolygonSampler(const PupilPolygon& star) noexcept;
  explicit PolygonSampler(const PupilPolygon&& star) = delete;
  /// mm^2; 0: nothing to sample.
  double area() const noexcept { return until_[polygon_corners - 1]; }
  /// For u and v in [0, 1] (clamped).
  std::array<double, 2> operator()(double u, double v) const noexcept;

 private:
  const PupilPolygon& star_;
  std::array<double, polygon_corners> until_;  // area of the sectors up to the end of each
};

/// Stars that contain the edges of each field (`covering`) or have their area, corners at equal steps of it.
PETZVAL_API PupilPolygon polygon_of(const PupilEdges& edges, bool covering);

/// Grows stars so that every weighted mean of them contains the edges of a field in between: of fields[i] the edges
/// were found, and its star would be the mean of stars[parts[i].first[k]] with the weights parts[i].second[k].
struct InterpolationCheck {
  const PupilEdges* edges = nullptr;
  std::array<std::size_t, 4> stars{0, 0, 0, 0};
  std::array<double, 4> weights{0, 0, 0, 0};
};
PETZVAL_API void expand_to_cover(std::span<PupilPolygon> stars, std::span<const InterpolationCheck> between);

}  // namespace petzval::inline v0::pupil_detail
