// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/editor/focus_editor.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::editor_detail {

/// Values of a focus point at one time. Positions are in the scene frame.
struct PointValues {
  std::optional<FocusPlace> place;  ///< nullopt: the pixel had no depth
  double blur_px = 0, weight = 1;
  std::optional<double> extent_stops;
};

/// Keys of a value, sorted by time (s).
template <class T>
using Keys = std::vector<std::pair<double, T>>;

/// A value whose copies share its memory until they are edited: a step of undo costs only what its event changed.
template <class T>
class Shared {
 public:
  explicit Shared(T value) : value_(std::make_shared<T>(std::move(value))) {}
  const T& operator*() const noexcept { return *value_; }
  const T* operator->() const noexcept { return value_.get(); }
  /// The value for changes, which the other copies do not see.
  T& edit() {
    if (value_.use_count() > 1) value_ = std::make_shared<T>(*value_);
    return *value_;
  }

 private:
  std::shared_ptr<T> value_;
};

struct EditorPoint {
  std::string id;
  bool id_is_number = false;
  PointValues now;
  Keys<PointValues> keys;
  bool by_hand = false;        ///< `now` replaces the keys until the time changes
  std::optional<double> fade;  ///< weight of a point in the picture or out of it, 0 to 1; nullopt: a new position
};

/// All settings that events change. Undo restores earlier settings.
struct EditorSettings {
  CameraSetup setup;              ///< settable(); tilt and swing are by hand, for serve by distance
  std::optional<Lens> wide_open;  ///< compiled from `setup`
  double from_lens = 0;           ///< part of the lens's own aberrations in the expressive lens
  FocusServe serve = FocusServe::distance;
  Keys<double> focus_keys;
  bool focus_by_hand = false;  ///< the distance replaces the keys until the time changes
  std::string active;          ///< id of the point in focus for serve by distance; empty: no point
  bool nearer_weighs_more = false, points_fade = true;
  double fade_s = 0.2, time_s = 0;
  double seconds_to_fade = 0;  ///< time that passed since the last state
  std::vector<Shared<EditorPoint>> points;
  int points_added = 0;

  /// From the front vertex.
  double focus_mm() const noexcept { return setup.focus_mm.value_or(std::numeric_limits<double>::infinity()); }
};

/// The set-up with the members that events set; the others have their defaults.
CameraSetup settable(const CameraSetup& setup);

/// Options of the focus at a distance: thin lenses have no exact rays.
FocusOptions focus_options(const CameraSetup& setup);

/// The lens with its iris and f-number.
Lens shaped_lens(const EditorSettings& settings);

/// Computes the state. Sets the distance, the fades and the values of keyed points in the settings. Equal settings give
/// equal states, to the bit.
FocusEditorState state_of(const FocusScene& scene, EditorSettings& settings);

/// Applies an event; undo and redo change nothing. Returns the type, and the key `continues`.
///
/// @param scene     the scene
/// @param state     the state of the settings, through whose lens pixels see the scene
/// @param settings  changed by the event
/// @param event     a JSON object
/// @throws Error that names the type, the key, the value and the rule; the settings are then invalid
std::pair<std::string_view, bool> apply_event(const FocusScene& scene, const FocusEditorState& state,
                                              EditorSettings& settings, std::string_view event);

/// Maps between the scene frame and the lens frame. entrance_z: z of the entrance pupil.
Vec3<double> to_lens(const FocusScene& scene, double entrance_z, const Vec3<double>& point) noexcept;
Vec3<double> to_scene(const FocusScene& scene, double entrance_z, const Vec3<double>& point) noexcept;

}  // namespace petzval::editor_detail
