// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// A scene point and the blur that it should have on the film, at one moment.
struct FocusTarget {
  ScenePoint place;
  double blur_mm = 0;  ///< wanted diameter: 0 sharp; negative: in front of the plane of focus; positive: beyond it
  double weight = 1;   ///< of the squared error of the blur; 0: the blur is reported, but does not count
  /// Of the depth of field, as in FocalPoint.
  std::optional<double> extent_stops = {};
  bool fixes_distance = true;  ///< false: the extent alone; films do not follow it
};

/// How a target was used.
enum class TargetUse : std::uint8_t {
  used,
  no_weight,   ///< or it fixes the extent of the depth of field alone
  not_finite,  ///< a coordinate, the blur or the weight is not finite, or the weight is negative
  no_image,    ///< behind the lens, within the front focal length, or imaged more than 1e9 focal lengths away
  outlier,     ///< the robust fit gave it no weight
  no_rays,     ///< exact rays: none from the target passes the lens
};

/// "used", "no_weight", ...
PETZVAL_API std::string_view name(TargetUse use) noexcept;

/// The blur of a target on a film.
struct TargetBlur {
  TargetUse use = TargetUse::used;
  double wanted_mm = 0;
  double blur_mm = 0;  ///< signed; NaN if the target has no image
};

/// How far targets determine the plane of focus.
enum class PlaneRank : std::uint8_t {
  none,   ///< no targets of weight
  point,  ///< one, or several in one place of the picture: its depth only
  line,   ///< two, or several on a line of the picture: its depth and the slope along that line
  plane,
};

/// "none", "point", "line", "plane".
PETZVAL_API std::string_view name(PlaneRank rank) noexcept;

/// A point on a triangle of a mesh; it moves with the vertices.
struct OnTriangle {
  std::array<std::size_t, 3> vertices{0, 0, 0};  ///< positions in the list of vertices
  std::array<double, 3> barycentric{1, 0, 0};    ///< 0 or more each, sum 1 (within 1e-9)
};

/// A keyframe of a focus point.
struct FocusKey {
  double time = 0;  ///< s
  std::variant<ScenePoint, OnTriangle> anchor = ScenePoint{};
  double blur_mm = 0;  ///< as in FocusTarget
  double weight = 1;   ///< 0 or more
  /// As in FocalPoint, within 20 stops; in all keys of a point or in none.
  std::optional<double> extent_stops = {};
};

/// A point that an artist wants sharp, or blurred by so much, over time: keys in the order of time, valid from `from`
/// to `until`, both included.
///
/// Between keys, blur, weight and extent follow a piecewise cubic with a continuous derivative that never leaves the
/// span of the two keys; they are constant before the first key and after the last. If all keys lie on one triangle,
/// the point moves over it by its barycentric coordinates. Otherwise it moves as the camera sees it, by x / depth, y /
/// depth and 1 / depth from the front principal point: a focus pull looks uniform, a straight line joins two keys, and
/// keys may lie at infinity. If a key does not lie in front of that point, the point moves by x, y and z.
struct FocusPoint {
  std::vector<FocusKey> keys;
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();  ///< s
  bool fixes_distance = true;  ///< as in FocusTarget
};

/// A time, and what counts then.
struct FocusMoment {
  double time = 0;                              ///< s
  std::span<const Vec3<double>> vertices = {};  ///< of the mesh at that time, lens frame, mm
  /// Points whose chief rays miss this film are left out. Its z_mm, if unset, is the rear focal point.
  std::optional<Film> film = {};
  bool nearer_weighs_more = false;  ///< divides weights by depth, so that the nearest point keeps its weight
};

/// The targets of all points that are valid at a moment, have an image and lie in the picture, in the order of the
/// points.
///
/// Throws Error for a NaN time; a film that is not finite or of negative size; points without keys; times out of order;
/// an interval that ends before it begins; positions, blurs and weights that are not finite, and negative weights;
/// extents beyond 20 stops or in some keys of a point only; invalid barycentric coordinates; and vertices that do not
/// exist.
PETZVAL_API std::vector<FocusTarget> focus_targets(const IdealLens& lens, std::span<const FocusPoint> points,
                                                   const FocusMoment& moment);

}  // namespace petzval
