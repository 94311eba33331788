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
#include "petzval/focus/autofocus.hpp"
#include "petzval/io/json.hpp"
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
  /// Compiles the lens of a set-up, wide open: for example compile() of formats/lens_file.hpp.
  std::function<Lens(const CameraSetup&)> lens = {};
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

/// The state of a FocusEditor: a camera and its set-up.
struct PETZVAL_API FocusEditorState {
  /// The set-up with all members that the editor computes: the focus, the film with its tilt, the points of the focal
  /// surface, and the model. Thin lenses are of ModelKind::thin, lenses with a focal surface or with aberrations of
  /// their own of ModelKind::thick, others of ModelKind::exact_float.
  CameraSetup setup = {};
  Lens lens;  ///< as prepared() for `setup`
  /// The camera of `setup`. The first call makes it, in 2 to 80 ms; copies of the state share and keep the camera.
  /// @throws Error as Camera
  std::function<const Camera&()> camera = {};
  std::optional<FocalSurface> surface = {};  ///< for FocusServe::surface
  FocusServe serve = FocusServe::distance;
  double f_number = 0;  ///< f-number of the lens at infinity
  double focus_mm = 0;  ///< distance in focus on the axis, from the front vertex; may be infinite
  /// "solved", or the reason why the points are not served: the name of a FocusStatus.
  std::string_view status = "solved";
  double time_s = 0;
  std::vector<FocusMark> targets = {};

  /// True if the lens is thin and has no thickness, colour or aberrations of its own.
  bool thin() const noexcept { return setup.lens.thin_mm > 0; }
  /// First-order blur of scene points (lens frame) on the film or the focal surface: signed diameters in pixels, NaN
  /// for points without an image.
  std::vector<double> first_order_blurs_px(std::span<const ScenePoint> points) const;
};

/// Interactive control of focus, without a window: events in, a camera out.
///
/// Events are JSON objects with a "type". A refused event throws Error and changes nothing.
///
///     FocusEditor editor(scene, {.lens = {.thin_mm = 50}, .f_number = 2});
///     editor.apply(R"({"type": "add_point", "id": "eye", "pixel": [410, 220]})");
///     editor.apply(R"({"type": "add_point", "id": "hand", "pixel": [300, 480], "blur_px": 4})");
///     editor.apply(R"({"type": "serve", "by": "tilt"})");
///     editor.apply(R"({"type": "setup", "setup": {"f_number": 2.8, "iris": {"blades": 6}}})");
///     const Camera camera = editor.state().camera();
///
/// Types and keys:
///
/// - add_point: id (default: "1", "2", ...); pixel [x, y] or position_mm [x, y, z] with at_infinity; weight, blur_px,
///   extent_stops
/// - move_point: id; pixel, or position_mm with at_infinity
/// - set_point: id; weight, blur_px, extent_stops (null: none)
/// - remove_point: id
/// - serve: by ("distance", "film", "tilt", "surface")
/// - setup: setup, a JSON merge patch (RFC 7396) of the set-up in the format of to_json(), for lens, f_number, iris,
///   focus_mm from the front vertex (null: infinity), film.tilt_rad and swing_rad (up to 60 degrees), camera.bokeh
///   without blades, camera.expressive, and kind and beta of focal_surface. The editor sets the other members. focus_mm
///   and film change to serve by distance. Another lens: {"lens": {"file": "tele.json", "thin_mm": null}}
/// - expressive: from_lens, the factor of the lens's own aberrations in camera.expressive
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
  /// Starts without points, served by distance.
  ///
  /// @param setup  the lens and other members that events of the type setup can set; others are not used
  /// @throws Error if the scene has no pixels, angle or pose that is valid, or no function `lens`; if the lens cannot
  ///               be compiled
  FocusEditor(FocusScene scene, const CameraSetup& setup);
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
