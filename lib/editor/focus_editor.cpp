// SPDX-License-Identifier: Apache-2.0
#include "petzval/editor/focus_editor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "editor_settings.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using Json = nlohmann::ordered_json;

void check(const FocusScene& scene) {
  if (scene.columns < 1 || scene.rows < 1) {
    throw Error("scene: columns, rows = " + std::to_string(scene.columns) + ", " + std::to_string(scene.rows) +
                "; must be positive");
  }
  if (!(scene.vertical_angle_rad >= 0 && scene.vertical_angle_rad < radians(180))) {
    throw Error("scene: vertical_angle_rad = " + to_text(scene.vertical_angle_rad) + "; must be from 0 to below pi");
  }
  if (!scene.lens) throw Error("scene: the function `lens` is missing; must compile a lens");
  const Vec3<double> axes[] = {scene.right, scene.up, scene.back};
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b <= a; ++b) {
      if (!(std::abs(glm::dot(axes[a], axes[b]) - (a == b)) < 1e-6)) {
        throw Error("scene: right, up and back must be unit vectors at right angles");
      }
    }
  }
}

}  // namespace

std::string_view name(FocusServe serve) noexcept {
  constexpr std::string_view names[] = {"distance", "film", "tilt", "surface"};
  const auto i = static_cast<std::size_t>(serve);
  return i < std::size(names) ? names[i] : "unknown";
}

struct FocusEditor::Data {
  FocusScene scene;
  /// For undo and redo, the settings from which state_of() computes each state. States are not kept: each has a blur
  /// for every point.
  std::vector<editor_detail::EditorSettings> steps;
  std::size_t current = 0;  ///< index into steps
  editor_detail::EditorSettings settings;
  FocusEditorState state;
  std::vector<std::string> log;
};

FocusEditor::FocusEditor(FocusScene scene, const CameraSetup& setup) {
  check(scene);
  editor_detail::EditorSettings settings;
  settings.setup = editor_detail::settable(setup);
  settings.wide_open = scene.lens(settings.setup);
  std::vector<editor_detail::EditorSettings> steps{settings};
  FocusEditorState state = state_of(scene, settings);
  data_ =
      std::make_unique<Data>(Data{std::move(scene), std::move(steps), 0, std::move(settings), std::move(state), {}});
}

FocusEditor::~FocusEditor() = default;
FocusEditor::FocusEditor(FocusEditor&&) noexcept = default;
FocusEditor& FocusEditor::operator=(FocusEditor&&) noexcept = default;

void FocusEditor::apply(std::string_view event) {
  Data& data = *data_;
  editor_detail::EditorSettings settings = data.settings;
  const auto [type, continues] = apply_event(data.scene, data.state, settings, event);
  const Json json = Json::parse(event, nullptr, false);
  if (json.is_discarded()) throw Error("event = " + std::string(beginning(event, 80)) + "; must be JSON");
  if (type == "still") return data.log.push_back(json.dump());
  const bool undo = type == "undo", moves = undo || type == "redo";
  if (moves && !(undo ? can_undo() : can_redo())) {
    throw Error(std::string(type) + ": there is no event to " + std::string(type));
  }
  // With `continues`, the event before remains the step that undo leads back to.
  const bool stays = !moves && continues && data.current > 0;
  const std::size_t to = undo ? data.current - 1 : stays ? data.current : data.current + 1;
  if (moves) settings = data.steps[to];
  editor_detail::EditorSettings step = settings;
  FocusEditorState state = state_of(data.scene, settings);
  data.log.push_back(json.dump());
  if (!moves) {
    data.steps.erase(data.steps.begin() + static_cast<std::ptrdiff_t>(to), data.steps.end());
    data.steps.push_back(std::move(step));
  }
  data.current = to, data.settings = std::move(settings), data.state = std::move(state);
}

void FocusEditor::replay(std::string_view events) {
  const Json list = Json::parse(events, nullptr, false);
  if (!list.is_array()) throw Error("events = " + std::string(beginning(events, 80)) + "; must be a JSON list");
  std::size_t count = 0;
  for (const Json& event : list) {
    ++count;
    try {
      apply(event.dump());
    } catch (const Error& error) {
      throw Error("event " + std::to_string(count) + ": " + error.what());
    }
  }
}

const FocusEditorState& FocusEditor::state() const noexcept { return data_->state; }

std::string FocusEditor::log() const {
  std::string result = "[";
  for (const std::string& event : data_->log) result += (result.size() > 1 ? ",\n" : "\n") + event;
  return result + "\n]";
}

bool FocusEditor::can_undo() const noexcept { return data_->current > 0; }
bool FocusEditor::can_redo() const noexcept { return data_->current + 1 < data_->steps.size(); }

std::vector<double> FocusEditor::key_times() const {
  std::vector<double> result;
  const auto add = [&](const auto& keys) {
    for (const auto& key : keys) result.push_back(key.first);
  };
  add(data_->settings.focus_keys);
  for (const auto& point : data_->settings.points) add(point->keys);
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Vec3<double> FocusEditor::to_lens(const Vec3<double>& scene) const noexcept {
  return editor_detail::to_lens(data_->scene, pupils(state().lens).entrance.z, scene);
}

Vec3<double> FocusEditor::to_scene(const Vec3<double>& lens) const noexcept {
  return editor_detail::to_scene(data_->scene, pupils(state().lens).entrance.z, lens);
}

}  // namespace petzval
