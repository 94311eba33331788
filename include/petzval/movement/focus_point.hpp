// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/movement/focus_target.hpp"
#include "petzval/movement/ideal_lens.hpp"

namespace petzval::inline v0 {

/// A point on a triangle of a mesh that moves: it goes where the vertices go.
struct OnTriangle {
  std::array<std::size_t, 3> vertices{0, 0, 0};  ///< positions in the list of vertices
  std::array<double, 3> barycentric{1, 0, 0};    ///< 0 or more each, sum 1 (within 1e-9)
};

/// What a focus point asks for at one time.
struct FocusKey {
  double time = 0;  ///< s
  std::variant<ScenePoint, OnTriangle> anchor = ScenePoint{};
  double blur_mm = 0;  ///< as in FocusTarget
  double weight = 1;   ///< 0 or more
};

/// A point that an artist wants sharp, or blurred by so much: keys in time order, valid from the first time of the
/// interval to the last, both included.
///
/// Between keys, blur and weight go as Keyframes do. Keys that all lie on one triangle move over it by their
/// barycentric coordinates. Other places move as the camera sees them, by x / depth, y / depth and 1 / depth from the
/// front principal point: a focus pull looks even, two keys are joined by a straight line, and infinity is as good a
/// place as any. Where one of them does not lie in front of that point, they move by x, y and z.
struct FocusPoint {
  std::vector<FocusKey> keys;
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();  ///< s
};

/// When, and what counts then.
struct FocusMoment {
  double time = 0;                              ///< s
  std::span<const Vec3<double>> vertices = {};  ///< of the mesh at that time, lens frame, mm
  /// Points whose chief rays miss it are left out; a place that is not set is the rear focal point.
  std::optional<Film> film = {};
  bool nearer_weighs_more = false;  ///< weights over depth: that of the nearest stays
};

/// The targets at a moment: of the points, in their order, that are valid then, of which the lens forms an image, and
/// that lie in the picture. Throws Error for a NaN time; a film of negative size or not finite; points
/// without keys, with times out of order, an interval that ends before it begins, positions, blurs or weights that are
/// not finite or negative, coordinates that are none of a triangle, and vertices that are not there.
PETZVAL_API std::vector<FocusTarget> focus_targets(const IdealLens& lens, std::span<const FocusPoint> points,
                                                   const FocusMoment& moment);

}  // namespace petzval::inline v0
