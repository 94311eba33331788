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

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// A scene point and its requested blur on the film, at one time.
struct FocusTarget {
  ScenePoint point;
  /// Requested blur diameter; negative in front of the plane of focus, positive beyond the plane of focus.
  double blur_mm = 0;
  double weight = 1;  ///< weight of the squared blur error; 0: the blur is only reported
  /// Extent of the depth of field, as in FocalPoint.
  std::optional<double> extent_stops = {};
  bool fixes_distance = true;  ///< false: the target fixes only the extent, and films ignore the target
};

/// The use of a target in a fit, or the reason for its exclusion.
enum class TargetStatus : std::uint8_t {
  used,
  no_weight,   ///< the weight is 0, or the target does not fix a distance
  not_finite,  ///< a coordinate, the blur or the weight is not finite, or the weight is negative
  no_image,    ///< behind the lens, within the front focal length, or imaged more than 1e9 focal lengths away
  outlier,     ///< excluded by the robust fit
  no_rays,     ///< exact rays: no ray from the target passes the lens
};

/// "used", "no_weight", ...
PETZVAL_API std::string_view name(TargetStatus status) noexcept;

/// The blur of a target on a film.
struct TargetBlur {
  TargetStatus status = TargetStatus::used;
  double target_mm = 0;  ///< requested diameter
  double blur_mm = 0;    ///< signed diameter; NaN if the target has no image
};

/// The degree to which targets determine the plane of focus.
enum class PlaneRank : std::uint8_t {
  none,   ///< no target has a weight
  point,  ///< all targets at one image point: they determine the depth of the plane
  line,   ///< all targets on one image line: they determine the depth and the slope along this line
  plane,
};

/// "none", "point", "line", "plane".
PETZVAL_API std::string_view name(PlaneRank rank) noexcept;

/// A point on a triangle of a mesh. The point moves with the vertices.
struct TrianglePoint {
  std::array<std::size_t, 3> vertices{0, 0, 0};  ///< indices into the list of vertices
  std::array<double, 3> barycentric{1, 0, 0};    ///< each at least 0, sum 1 (within 1e-9)
};

/// A keyframe of a focus point.
struct FocusKey {
  double time = 0;  ///< s
  std::variant<ScenePoint, TrianglePoint> anchor = ScenePoint{};
  double blur_mm = 0;  ///< as in FocusTarget
  double weight = 1;   ///< 0 or more
  /// Extent of the depth of field, as in FocalPoint; up to 20 stops. Either all keys of a point have an extent, or no
  /// key.
  std::optional<double> extent_stops = {};
};

/// An animated scene point that should be sharp, or blurred by a given amount.
///
/// Between keys, all values follow monotone piecewise cubics with continuous derivatives; they are constant before the
/// first key and after the last. If all keys lie on one triangle, the barycentric coordinates are interpolated.
/// Otherwise x / depth, y / depth and 1 / depth from the front principal point are interpolated, so that a focus pull
/// looks uniform, a straight line joins two keys, and keys may lie at infinity. If a key does not lie in front of the
/// front principal point, x, y and z are interpolated.
struct FocusPoint {
  std::vector<FocusKey> keys;  ///< in the order of time
  /// The point is valid from `from` to `until`, both included (s).
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();
  bool fixes_distance = true;  ///< as in FocusTarget
};

/// The scene at one time, for the evaluation of focus points.
struct FocusTime {
  double time = 0;                              ///< s
  std::span<const Vec3<double>> vertices = {};  ///< vertices of the mesh at this time, lens frame, mm
  /// Points are left out if their chief rays miss this film. If z_mm is not set, the film is at the rear focal point.
  std::optional<Film> film = {};
  bool nearer_weighs_more = false;  ///< true: weights are divided by depth; the nearest point keeps its weight
};

/// The focus targets at one time: all points that are valid, have an image and lie on the film, in the given order.
///
/// @param lens    the lens
/// @param points  the animated points
/// @param moment  time, mesh and film
/// @throws Error  if the time is NaN; if the film has a negative size or numbers that are not finite; if a point has no
///                keys, keys out of order, or an interval that ends before its beginning; if a position, blur or weight
///                is not finite, or a weight is negative; if an extent is beyond 20 stops or only some keys have an
///                extent; if barycentric coordinates are invalid or a vertex does not exist
PETZVAL_API std::vector<FocusTarget> focus_targets(const IdealLens& lens, std::span<const FocusPoint> points,
                                                   const FocusTime& moment);

}  // namespace petzval
