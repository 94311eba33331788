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
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
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

/// The upright film that fits a set of focus targets best.
struct Autofocus {
  /// solved, no_targets, or unreachable: the solution does not lie behind the lens.
  FocusStatus status = FocusStatus::no_targets;
  Film film;                      ///< the solution, with z_mm set; the given film if there is no solution
  std::vector<TargetBlur> blurs;  ///< for each target, its blur on this film
  double rms_mm = 0;              ///< weighted RMS difference of blur and requested blur; 0 if no target was used
  /// Relative growth of the image on this film, compared with the film for infinity (breathing; same criterion, on the
  /// axis) and with the given film (magnification_change). It follows the paraxial chief ray through the exit pupil,
  /// for exact rays as well. NaN if the film to compare with does not exist or lies in the exit pupil.
  double breathing = std::numeric_limits<double>::quiet_NaN();
  double magnification_change = std::numeric_limits<double>::quiet_NaN();

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Finds the film with the least weighted squares of blur minus requested blur, for an ideal lens.
///
/// The solution is in closed form: the blur of a target is linear in the position of the film.
///
/// @param lens     the lens
/// @param targets  scene points and their requested blurs
/// @param film     the film to move; if z_mm is not set, it starts at the rear focal point
/// @throws Error   if the film is tilted, or if its z_mm is not finite
PETZVAL_API Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, const Film& film = {});

/// Finds the film that fits focus targets best, by exact rays at the primary wavelength.
///
/// The preferred film of a target is displaced from its sharpest film until the blur has the requested size. If the
/// smallest blur is larger than requested, the preferred film is the sharpest film. A call takes about 15 ms to find
/// the pupils of the lens, and some microseconds per target.
///
/// @param lens       the lens
/// @param targets    scene points and their requested blurs
/// @param film       the film to move; if z_mm is not set, it starts at Lens::film_z()
/// @param criterion  min_rms: least weighted squares of the RMS blur, in closed form. min_max: smallest maximum of the
///                   weighted radii (the largest weight counts as 1), to rounding; blurs are twice the maximum radius.
/// @param rays       rays from each target, at least 16; fewer (at least 64) if all targets have more than 2^22 rays
/// @throws Error     if `criterion` is another one, if the film is tilted, if its z_mm is not finite, if `rays` is
///                   below 16, or if the lens has no focal length or no pupil
///
/// Accuracy: solve_focus() also traces the edges of pupils. With one target, the difference is at most 12 um (min_rms)
/// and 80 um (min_max) with 256 rays, 7 um and 60 um with 1024 rays (tests/focus; double Gauss 100 mm f/2, on the axis
/// and up to 11 degrees off axis).
PETZVAL_API Autofocus autofocus(const Lens& lens, std::span<const FocusTarget> targets, const Film& film = {},
                                FocusCriterion criterion = FocusCriterion::min_rms, std::size_t rays = 256);

/// The blur of a scene point on a film by exact rays.
struct ExactBlur {
  FilmPoint centroid;
  double rms_radius = 0;      ///< RMS distance from the centroid, mm
  double largest_radius = 0;  ///< largest distance from the centroid, mm
  /// Diameter of the uniform disc with the same RMS radius, 2 sqrt(2) rms_radius. Negative, as in signed_blur(), if the
  /// rays meet behind the film; positive if defocus causes less than a tenth of the diameter.
  double signed_diameter = 0;
};

/// Traces rays from scene points and returns their blurs on a film, at the primary wavelength.
///
/// @param lens     the lens
/// @param film     the film; z_mm must be set
/// @param points   the scene points
/// @param rays     as in autofocus()
/// @param threads  at least 1; the results are the same for every number
/// @return         one blur per point; nullopt if no ray of the point reaches the film
/// @throws Error   if film.z_mm is not set, or under the conditions of autofocus()
///
/// Accuracy, for lenses of revolution (tests/focus/image_rays_test.cpp): compared with infinitely many rays, RMS radii
/// out of focus are within 1.5 % for 256 rays and 1 % for 1024. On the sharpest film, nine of ten points of the lenses
/// of data/lenses are within 2, 1.5 and 0.4 % for 256, 1024 and 4096 rays, and all points within 7, 5 and 2 %.
///
/// Limitations: with cylinders the error of an RMS radius may be a fifth. The largest radius is up to 40 % below the
/// radius at the edge of the pupil.
PETZVAL_API std::vector<std::optional<ExactBlur>> exact_blurs(const Lens& lens, const Film& film,
                                                              std::span<const ScenePoint> points,
                                                              std::size_t rays = 256, int threads = 1);

/// A grid of targets that covers a parallelogram to focus on.
///
/// The parallelogram is centre +- half_width +- half_height (lens frame, mm). It is divided into columns x rows equal
/// cells with a target at the centre of each.
///
/// @throws Error unless `columns` and `rows` are at least 1 and their product is at most 2^20
PETZVAL_API std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                                    const Vec3<double>& half_height, int columns, int rows);

}  // namespace petzval
