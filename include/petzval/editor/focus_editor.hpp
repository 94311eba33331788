// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The part of a camera that a FocusEditor adjusts to its focus points.
enum class FocusServe : std::uint8_t {
  distance,  ///< the lens is focused at the point that was added or moved last, or at a distance set by hand
  film,      ///< an upright film fits all points (autofocus())
  tilt,      ///< a tilted film fits all points (fit_tilt())
  surface,   ///< a focal surface passes through all points (FocalSurface)
};

/// "distance", "film", "tilt", "surface".
PETZVAL_API std::string_view name(FocusServe serve) noexcept;

/// The lens that a FocusEditor requests from its scene.
struct FocusLensChoice {
  std::string name = {};  ///< name or path of a lens; empty: a thin lens
  double thin_mm = 0;     ///< focal length of the thin lens
  double f_number = 0;    ///< f-number of the thin lens; 0 for other lenses, which the editor stops down itself
  bool rgb = false;       ///< the lens is compiled for the d line and for red, green and blue, in this order
};

/// A surface point of the scene.
struct FocusPlace {
  /// Position in the scene frame, mm; at infinity, a direction.
  ScenePoint point{};
  std::optional<TrianglePoint> triangle = {};  ///< triangle of a mesh; the point follows its vertices
};

/// The scene of a FocusEditor: the picture, and functions that the application provides.
///
/// Each function returns the same result whenever it is called with the same arguments; otherwise a replayed log gives
/// other states.
struct FocusScene {
  int columns = 800, rows = 600;  ///< size of the picture
  /// Vertical angle of the picture from the entrance pupil; 0: the film is 24 mm high.
  double vertical_angle_rad = 0;
  /// Pose of the lens frame in the scene frame: centre of the entrance pupil (mm), and unit vectors along x, y and z of
  /// the lens frame. The scene lies in front of the lens, towards -back.
  Vec3<double> position{0, 0, 0}, right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};
  /// Compiles a lens, wide open.
  std::function<Lens(const FocusLensChoice&)> lens = {};
  /// The first surface on a ray from the entrance pupil (scene frame); nullopt if its depth is unknown. The ray is the
  /// chief ray of a pixel, through the lens of the state.
  std::function<std::optional<FocusPlace>(const Ray<double>& ray, double time_s)> place = {};
  /// Position of a vertex of the mesh at a time (scene frame, mm); required if places have triangles.
  std::function<Vec3<double>(std::size_t vertex, double time_s)> vertex = {};
};

/// A focus point in the state of a FocusEditor.
struct FocusMark {
  std::string id = {};
  bool id_is_number = false;                  ///< the event gave the id as a number
  std::optional<Vec3<double>> place_mm = {};  ///< scene frame; a direction for a point at infinity; nullopt: no depth
  bool at_infinity = false;
  /// "no_depth", "hidden" (outside the picture and faded) or the name of a TargetStatus.
  std::string_view status = "used";
  std::optional<double> blur_px = {};  ///< signed diameter reached; nullopt if the point has no image
  double requested_px = 0, weight = 1, fade = 1;
  std::optional<double> extent_stops = {};
  std::optional<Vec2<double>> raster = {};  ///< raster position of the chief ray
};

/// The state of a FocusEditor: a lens, a film and their camera.
struct PETZVAL_API FocusEditorState {
  FocusLensChoice choice = {};
  Lens lens;       ///< with its iris, stopped down and focused
  Film film = {};  ///< with its size, tilt and swing; z_mm is set
  BokehControls bokeh = {};
  ExpressiveLens expressive = {};
  std::optional<FocalSurface> surface = {};     ///< for FocusServe::surface
  std::vector<FocalPoint> surface_points = {};  ///< that the surface passes through
  FocalSurfaceOptions surface_options = {};
  FocusServe serve = FocusServe::distance;
  double f_number = 0;        ///< f-number of the lens at infinity
  bool f_number_set = false;  ///< false: the lens is wide open
  double focus_mm = 0;        ///< distance in focus on the axis, from the front vertex; may be infinite
  /// "solved", or the reason why the points are not served: the name of a FocusStatus, AutofocusStatus or
  /// TiltFitStatus.
  std::string_view status = "solved";
  double time_s = 0;
  std::vector<FocusMark> targets = {};

  /// The camera of the state as the editor made it: of lens, film and camera_options(). Copies of the state share it.
  /// The first call makes it, which takes some ms.
  ///
  /// @throws Error as Camera
  std::function<const Camera&()> camera = {};

  /// True if the lens is thin and has no thickness, colour or aberrations of its own.
  bool thin() const noexcept { return choice.name.empty(); }
  /// First-order blur of scene points (lens frame) on the film or the focal surface: signed diameters in pixels, NaN
  /// for points without an image.
  std::vector<double> first_order_blurs_px(std::span<const ScenePoint> points) const;
  /// Options of the camera: thin lenses are of ModelKind::thin, lenses with a focal surface or with aberrations of
  /// their own of ModelKind::thick, others of ModelKind::exact_float; unity_on_axis.
  ///
  /// @throws Error if the focal surface of a thin lens cannot be made
  CameraOptions camera_options() const;
};

/// Interactive control of focus, without a window: events in, a lens and a film out.
///
/// Events are JSON objects with a "type". A refused event throws Error and changes nothing.
///
///     FocusEditor editor(scene, {.thin_mm = 50, .f_number = 2});
///     editor.apply(R"({"type": "add_point", "id": "eye", "pixel": [410, 220]})");
///     editor.apply(R"({"type": "add_point", "id": "hand", "pixel": [300, 480], "blur_px": 4})");
///     editor.apply(R"({"type": "serve", "by": "tilt"})");
///     const Camera& camera = editor.state().camera();
///
/// Types and keys:
///
/// - add_point: id (default: "1", "2", ...); pixel [x, y] or position_mm [x, y, z] with at_infinity; weight, blur_px,
///   extent_stops
/// - move_point: id; pixel, or position_mm with at_infinity
/// - set_point: id; weight, blur_px, extent_stops (null: none)
/// - remove_point: id
/// - serve: by ("distance", "film", "tilt", "surface"); for surfaces kind ("affine", "shepard") and beta
/// - focus: distance_mm from the front vertex (null: infinity); changes to serve by distance
/// - f_number: f_number (null: wide open)
/// - iris: blades, roundness, rotation_deg
/// - bokeh: lens_ratio, rate_of_change, keep_light, weight_distribution, weight_strength
/// - expressive: power_spline [[radius, power], ...], curvature_points [[x, y, offset], ...] (mm), dispersion,
///   from_lens
/// - lens: lens (a name, or an object with thin_mm and f_number)
/// - colour: rgb (true: separate rays of red, green and blue)
/// - tilt: tilt_deg, swing_deg of the film, by hand; changes to serve by distance
/// - weighting: nearer (weights are divided by depth), fade (points outside the picture fade), fade_s (time constant)
/// - key: time_s; keeps the places, weights, blurs and extents of all points, and the distance, as keys
/// - time: time_s; moves all points to their keys at this time
/// - undo, redo, still: no keys; `still` changes nothing
///
/// Keys that an event leaves out keep their values. An event with "continues": true forms one step of undo together
/// with the event before it, as for a point that is dragged. Positions are in the scene frame. The log can be replayed:
/// the same events give the same state to the bit.
///
/// Limitations: film positions beyond infinity focus, which some requested blurs need, are not reached.
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 4.
class PETZVAL_API FocusEditor {
 public:
  /// Starts with a lens focused at infinity, without points, served by distance.
  ///
  /// @throws Error if the scene has no pixels, angle or pose that is valid, or no function `lens`; if the lens cannot
  ///               be compiled
  FocusEditor(FocusScene scene, const FocusLensChoice& lens);
  ~FocusEditor();
  FocusEditor(FocusEditor&&) noexcept;
  FocusEditor& operator=(FocusEditor&&) noexcept;

  /// Applies an event.
  ///
  /// @param event  a JSON object
  /// @throws Error that names the type, the key, the value and the rule. The state and the log are then unchanged
  void apply(std::string_view event);

  /// Applies all events of a JSON list, the format of log().
  ///
  /// @throws Error that also names the event, from 1. Earlier events stay applied
  void replay(std::string_view events);

  const FocusEditorState& state() const noexcept;
  /// All events applied so far, undo and redo included: a JSON list with an event in each line.
  std::string log() const;
  bool can_undo() const noexcept;
  bool can_redo() const noexcept;

  /// Times of all keys, sorted (s).
  std::vector<double> key_times() const;
  /// Maps positions between the scene frame and the lens frame, mm.
  Vec3<double> to_lens(const Vec3<double>& scene) const noexcept;
  Vec3<double> to_scene(const Vec3<double>& lens) const noexcept;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace petzval
