// SPDX-License-Identifier: Apache-2.0
#include "viewer/window.hpp"

#include <SDL.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "petzval/analysis/colour.hpp"
#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "support/files.hpp"
#include "support/interrupt.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"
#include "viewer/screen.hpp"
#include "viewer/section.hpp"
#include "viewer/worker.hpp"

namespace viewer {
namespace {

using examples::Json;

/// Width of the panels beside the picture and height of the drawings below the picture, pixels of the screen.
constexpr float panel_width = 350, drawing_height = 190;
/// End of the slider of distances: infinity.
constexpr double farthest_m = 1000;
/// Times that the window is drawn after a change, for Dear ImGui to settle.
constexpr int frames_after_change = 4;
/// Radius of the handle of a point, pixels of the screen.
constexpr float handle_radius = 9;
constexpr double degree = petzval::radians(1);

constexpr ImU32 white = IM_COL32(255, 255, 255, 255), black = IM_COL32(0, 0, 0, 255),
                yellow = IM_COL32(255, 210, 60, 255), green = IM_COL32(80, 230, 120, 255),
                grey = IM_COL32(150, 150, 150, 255), blue = IM_COL32(110, 170, 255, 255);

/// A shipped lens with its drawing.
struct ShippedLens {
  std::string id;
  std::optional<Section> section = {};  ///< drawn when it is first seen
};

std::vector<ShippedLens> shipped_lenses() {
  std::vector<ShippedLens> lenses;
  for (const auto& file : examples::entries(petzval::data_directory() / "lenses")) {
    if (file.extension() == ".json") lenses.push_back({file.stem().string()});
  }
  std::ranges::sort(lenses, {}, &ShippedLens::id);
  return lenses;
}

/// The drawing of a shipped lens; empty if it cannot be compiled.
Section drawing_of(const std::string& id) {
  try {
    const petzval::Lens lens =
        petzval::compile(petzval::read_prescription(petzval::data_directory() / "lenses" / (id + ".json")));
    return section_of(lens, {.z_mm = lens.film_z()});
  } catch (const petzval::Error&) {
    return {};  // a lens that needs a configuration
  }
}

void draw_section(ImDrawList& draw, const Section& section, const ImVec2& corner, const ImVec2& size) {
  const float width = section.most.x - section.least.x, height = section.most.y - section.least.y;
  if (!(width > 0 && height > 0)) return;
  const float scale = 0.92f * std::min(size.x / width, size.y / height);
  const ImVec2 middle{corner.x + size.x / 2, corner.y + size.y / 2};
  const petzval::Vec2<float> centre = (section.least + section.most) / 2.0f;
  const auto lines = [&](const std::vector<Polyline>& all, ImU32 colour, float thickness) {
    for (const Polyline& line : all) {
      for (std::size_t i = 1; i < line.size(); ++i) {
        const auto at = [&](const petzval::Vec2<float>& p) {
          return ImVec2{middle.x + (p.x - centre.x) * scale, middle.y - (p.y - centre.y) * scale};
        };
        draw.AddLine(at(line[i - 1]), at(line[i]), colour, thickness);
      }
    }
  };
  draw.PushClipRect(corner, {corner.x + size.x, corner.y + size.y}, true);
  lines(section.rays, yellow, 1);
  lines(section.surfaces, white, 1);
  lines(section.stop, blue, 2);
  lines(section.film, green, 2);
  draw.PopClipRect();
}

/// Draws a sentence on a dark ground, over the lower edge of a rectangle.
void draw_notice(ImDrawList& draw, const std::string& text, const ImVec2& corner, const ImVec2& end) {
  constexpr float margin = 8;
  const float width = end.x - corner.x - 4 * margin;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width);
  const ImVec2 at{corner.x + 2 * margin, end.y - size.y - 2 * margin};
  draw.AddRectFilled({at.x - margin, at.y - margin}, {at.x + size.x + margin, end.y - margin},
                     IM_COL32(20, 20, 20, 230));
  draw.AddText(nullptr, 0, at, IM_COL32(255, 180, 100, 255), text.c_str(), nullptr, width);
}

class Window {
 public:
  explicit Window(const WindowOptions& options)
      : options_(options), worker_(options.session, options.first_events), lenses_(shipped_lenses()) {
    before_ = opens("sharp"), overlay_ = opens("map");
  }

  Worker& worker() noexcept { return worker_; }

  /// True if the window shows the last picture of all events.
  bool complete() const { return shown_ && (shown_->frame.still || !shown_->problem.empty()) && worker_.idle(); }
  const Snapshot* shown() const noexcept { return shown_.get(); }

  /// Draws everything and sends the events of the user. Returns false when the window is closed.
  bool draw() {
    shown_ = worker_.snapshot();
    update_textures();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    constexpr ImGuiWindowFlags fixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                       ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                       ImGuiWindowFlags_NoSavedSettings;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({size.x - panel_width, size.y - drawing_height});
    ImGui::Begin("Picture", nullptr, fixed | ImGuiWindowFlags_NoScrollbar);
    picture();
    ImGui::End();
    ImGui::SetNextWindowPos({0, size.y - drawing_height});
    ImGui::SetNextWindowSize({size.x - panel_width, drawing_height});
    ImGui::Begin("Drawings", nullptr, fixed | ImGuiWindowFlags_NoScrollbar);
    drawings();
    ImGui::End();
    ImGui::SetNextWindowPos({size.x - panel_width, 0});
    ImGui::SetNextWindowSize({panel_width, size.y});
    ImGui::Begin("Panels", nullptr, fixed);
    panels();
    ImGui::End();
    play();
    return !closed_;
  }

  bool plays() const noexcept { return playing_; }
  /// The size of a window in which the picture has its own pixels, if the screen has room.
  std::pair<int, int> size() const {
    const petzval::Film& film = worker_.snapshot()->state.setup.film;
    constexpr float padding = 16, lines = 50;
    return {film.columns + static_cast<int>(panel_width + padding),
            film.rows + static_cast<int>(drawing_height + lines)};
  }
  void dropped(const std::string& file) { send_lens({{"file", file}, {"thin_mm", nullptr}}, nullptr); }
  /// Taken from the events: Dear ImGui 1.86 misses a key that is pressed and released between two frames.
  void pressed(const SDL_KeyboardEvent& key) {
    if (ImGui::GetIO().WantTextInput || !shown_) return;
    const SDL_Scancode code = key.keysym.scancode;
    const bool control = (key.keysym.mod & KMOD_CTRL) != 0;
    if (control && code == SDL_SCANCODE_Z && shown_->can_undo) send({{"type", "undo"}});
    if (control && code == SDL_SCANCODE_Y && shown_->can_redo) send({{"type", "redo"}});
    if (control && code == SDL_SCANCODE_Q) close();
    if (code == SDL_SCANCODE_DELETE && has_point(selected_)) {
      send({{"type", "remove_point"}, {"id", selected_}});
      selected_.clear();
    }
    if (code == SDL_SCANCODE_0) zoom_key_ = 0;
    if (code == SDL_SCANCODE_1) zoom_key_ = 1;
    if (code == SDL_SCANCODE_2) zoom_key_ = 2;
    if (code == SDL_SCANCODE_SPACE && key.repeat == 0) playing_ = !playing_;
  }
  void close() { closed_ = true; }

 private:
  const petzval::FocusEditorState& state() const { return shown_->state; }
  bool opens(const char* panel) const { return std::ranges::find(options_.panels, panel) != options_.panels.end(); }
  bool header(const char* title, const char* panel, bool open = false) {
    return ImGui::CollapsingHeader(title, open || opens(panel) ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  }
  void send(const Json& event) { worker_.send(event); }
  static Json patch(const Json& setup) { return {{"type", "setup"}, {"setup", setup}}; }
  /// f_number: null for wide open.
  void send_lens(const Json& lens, const Json& f_number) { send(patch({{"lens", lens}, {"f_number", f_number}})); }
  /// Shows a pixel of the picture as `zoom` pixels of the screen, with a raster position in the middle; 0: everything.
  void zoom_to(int zoom, const petzval::Vec2<double>& middle) { zoom_ = zoom, middle_ = middle; }

  /// Sends the event of a widget that was just drawn. The events of one drag are one step of undo.
  void send_from_widget(const std::string& widget, Json event) {
    if (dragged_ == widget) event["continues"] = true;
    dragged_ = widget;
    send(event);
  }
  void end_of_widget() {
    if (ImGui::IsItemDeactivated()) dragged_.clear();
  }
  /// A slider that sends event(value).
  template <class Event>
  void slider(const char* label, double value, double least, double most, const char* format, const Event& event,
              ImGuiSliderFlags flags = 0) {
    auto shown = static_cast<float>(value);
    if (ImGui::SliderFloat(label, &shown, static_cast<float>(least), static_cast<float>(most), format,
                           flags | ImGuiSliderFlags_AlwaysClamp)) {
      // The slider shows four digits.
      send_from_widget(label, event(Json::parse(examples::number(static_cast<double>(shown), 4)).get<double>()));
    }
    end_of_widget();
  }
  /// at: a JSON pointer into the set-up. unit: of the slider.
  void slider(const char* label, double value, double least, double most, const char* format, const char* at,
              double unit = 1, ImGuiSliderFlags flags = 0) {
    slider(
        label, value / unit, least, most, format,
        [&](double set) {
          Json setup;
          setup[Json::json_pointer(at)] = set * unit;
          return patch(setup);
        },
        flags);
  }

  void update_textures() {
    if (shown_->picture && shown_->pictures != pictures_) {
      pictures_ = shown_->pictures;
      picture_.set(*shown_->picture);
    }
    if (shown_->sharp && shown_->sharp != sharp_shown_) {
      sharp_shown_ = shown_->sharp;
      sharp_.set(*sharp_shown_);
    }
    if (shown_->blur && shown_->blur != blur_shown_) {
      blur_shown_ = shown_->blur;
      const std::vector<float>& blur = *blur_shown_;
      std::vector<std::uint8_t> map(4 * blur.size());
      for (std::size_t i = 0; i < blur.size(); ++i) {
        const float b = blur[i], part = std::isnan(b) ? 0 : std::min(std::abs(b) / 10, 1.0f);
        const bool sharp = std::abs(b) < 1;
        map[4 * i] = sharp ? 60 : b < 0 ? 255 : 0;
        map[4 * i + 1] = sharp ? 255 : 60;
        map[4 * i + 2] = sharp ? 90 : b < 0 ? 0 : 255;
        map[4 * i + 3] = std::isnan(b) ? 0 : sharp ? 140 : static_cast<std::uint8_t>(150 * part);
      }
      const int columns = shown_->state.setup.film.columns;
      map_.set(columns, static_cast<int>(blur.size()) / columns, map);
    }
    if (shown_->bokeh.pixels > 0) {
      std::vector<std::uint8_t> grey_levels;
      for (const float value : shown_->bokeh.values) {
        grey_levels.insert(grey_levels.end(), 3, static_cast<std::uint8_t>(255 * std::sqrt(value)));
        grey_levels.push_back(255);
      }
      bokeh_.set(shown_->bokeh.pixels, shown_->bokeh.pixels, grey_levels);
    }
  }

  // The picture with its handles.
  void picture() {
    const petzval::Film& film = state().setup.film;
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float fit =
        std::min(space.x / static_cast<float>(film.columns), (space.y - 2 * line) / static_cast<float>(film.rows));
    const float scale = zoom_ > 0 ? static_cast<float>(zoom_) : fit;
    const ImVec2 size{scale * static_cast<float>(film.columns), scale * static_cast<float>(film.rows)};
    // The visible part, which does not reach beyond the picture.
    const ImVec2 start = ImGui::GetCursorScreenPos(),
                 view{std::min(size.x, space.x), std::min(size.y, space.y - 2 * line)};
    const auto before_view = [&](double middle, float visible, float all) {
      return std::round(std::clamp(scale * static_cast<float>(middle) - visible / 2, 0.0f, all - visible));
    };
    const ImVec2 corner{start.x - before_view(middle_.x, view.x, size.x),
                        start.y - before_view(middle_.y, view.y, size.y)};
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const bool unserved = !shown_->problem.empty();
    const Texture& texture = before_ && sharp_ && !unserved ? sharp_ : picture_;
    ImGui::InvisibleButton("picture", view, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    if (ImGui::IsItemHovered() && ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0)) {
      const ImVec2 run = ImGui::GetIO().MouseDelta;
      middle_ = {static_cast<double>((start.x + view.x / 2 - corner.x - run.x) / scale),
                 static_cast<double>((start.y + view.y / 2 - corner.y - run.y) / scale)};
    }
    const ImVec2 end{corner.x + size.x, corner.y + size.y}, view_end{start.x + view.x, start.y + view.y};
    draw.PushClipRect(start, view_end, true);
    if (texture) {
      texture.show_pixels(zoom_ > 0);
      draw.AddImage(texture.id(), corner, end, {0, 0}, {1, 1}, unserved ? IM_COL32(90, 90, 90, 120) : white);
    }
    if (overlay_ && map_ && shown_->blur) draw.AddImage(map_.id(), corner, end);
    const auto on_screen = [&](const petzval::Vec2<double>& raster) {
      return ImVec2{corner.x + scale * static_cast<float>(raster.x), corner.y + scale * static_cast<float>(raster.y)};
    };
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const petzval::Vec2<double> raster{static_cast<double>((mouse.x - corner.x) / scale),
                                       static_cast<double>((mouse.y - corner.y) / scale)};
    std::string under;  // id of the point under the mouse
    for (std::size_t i = 0; i < state().targets.size(); ++i) {
      const petzval::FocusMark& mark = state().targets[i];
      // A new point has no handle yet. Until then its first-order image is used.
      const bool has_handle = i < shown_->handles.size() && shown_->handles[i];
      const std::optional<petzval::Vec2<double>> place = has_handle ? shown_->handles[i] : mark.raster;
      if (!place) continue;
      const ImVec2 at = on_screen(*place);
      const bool near = std::hypot(at.x - mouse.x, at.y - mouse.y) < 1.5f * handle_radius;
      if (near) under = mark.id;
      const ImU32 colour = mark.status == "used" ? yellow : grey;
      draw.AddCircle(at, handle_radius, black, 0, 4);
      draw.AddCircle(at, handle_radius, colour, 0, mark.id == selected_ || near ? 3.0f : 2.0f);
      std::string text = mark.id;
      if (mark.blur_px) text += ": " + examples::number(std::abs(*mark.blur_px) < 0.005 ? 0 : *mark.blur_px, 2) + " px";
      if (mark.status != "used") text += " (" + in_words(mark) + ')';
      draw.AddText({at.x + handle_radius + 4, at.y - 6}, black, text.c_str());
      draw.AddText({at.x + handle_radius + 3, at.y - 7}, colour, text.c_str());
    }
    const std::string notice = shown_->problem + (unserved && !shown_->message.empty() ? "\n" : "") + shown_->message;
    if (!notice.empty()) draw_notice(draw, notice, start, view_end);
    draw.PopClipRect();
    mouse_on_picture(raster, under);
    const Frame& frame = shown_->frame;
    std::string caption = std::to_string(frame.rays) + " rays per pixel, " +
                          std::to_string(std::lround(frame.milliseconds)) + " ms, " +
                          std::to_string(std::lround(frame.memory_mb)) + " MB";
    if (frame.first_order) caption += "; without aberrations: the rays of the lens are being traced";
    if (frame.still) caption += "; still, as by petzval blur";
    ImGui::TextUnformatted(unserved ? "the picture of an earlier state" : caption.c_str());
    ImGui::TextDisabled(
        "click: focus  drag: move  shift + click: another point  right click: blur, weight  ctrl + z: undo  "
        "1, 2, 0: zoom");
  }

  void mouse_on_picture(const petzval::Vec2<double>& raster, const std::string& under) {
    const petzval::Film& film = state().setup.film;
    const bool inside = raster.x >= 0 && raster.x < film.columns && raster.y >= 0 && raster.y < film.rows;
    if (zoom_key_) zoom_to(*std::exchange(zoom_key_, std::nullopt), inside ? raster : looked_at_);
    if (!ImGui::IsItemHovered() && moved_.empty()) return;
    const auto pixel = [&] {
      return Json{std::clamp(raster.x, 0.0, static_cast<double>(film.columns)),
                  std::clamp(raster.y, 0.0, static_cast<double>(film.rows))};
    };
    if (inside && (raster.x != looked_at_.x || raster.y != looked_at_.y)) {
      looked_at_ = raster;
      worker_.look_at(raster);
    }
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right) && !under.empty()) {
      selected_ = under;
      ImGui::OpenPopup("point");
    }
    if (ImGui::IsItemClicked(ImGuiMouseButton_Left)) {
      const bool by_distance = state().serve == petzval::FocusServe::distance;
      if (!under.empty()) {
        selected_ = under;
      } else if (by_distance && !state().targets.empty() && !ImGui::GetIO().KeyShift) {
        // One point: it moves to where the user clicks.
        if (selected_.empty()) selected_ = state().targets.back().id;
        send({{"type", "move_point"}, {"id", selected_}, {"pixel", pixel()}});
      } else {
        selected_.clear();
        for (int k = 1; selected_.empty() || has_point(selected_); ++k) selected_ = std::to_string(k);
        send({{"type", "add_point"}, {"id", selected_}, {"pixel", pixel()}});
      }
      moved_ = selected_, move_has_begun_ = under.empty(), pressed_at_ = raster;
    }
    if (!moved_.empty() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      if (raster.x == pressed_at_.x && raster.y == pressed_at_.y) return;
      pressed_at_ = raster;
      Json event{{"type", "move_point"}, {"id", moved_}, {"pixel", pixel()}};
      if (move_has_begun_) event["continues"] = true;
      move_has_begun_ = true;
      send(event);
    } else {
      moved_.clear();
    }
  }

  /// The raster position of the selected or the first point, or the middle of the picture.
  petzval::Vec2<double> middle_of_attention() const {
    std::optional<petzval::Vec2<double>> result;
    for (const petzval::FocusMark& mark : state().targets) {
      if (mark.raster && (!result || mark.id == selected_)) result = mark.raster;
    }
    return result.value_or(petzval::Vec2<double>(state().setup.film.columns / 2, state().setup.film.rows / 2));
  }

  bool has_point(const std::string& id) const {
    return std::ranges::any_of(state().targets, [&](const petzval::FocusMark& mark) { return mark.id == id; });
  }

  void edit_point(const petzval::FocusMark& mark) {
    ImGui::PushID(mark.id.c_str());
    const auto edit = [&](const char* label, double value, double least, double most, const char* key) {
      slider(label, value, least, most, "%.2f", [&](double set) {
        return Json{{"type", "set_point"}, {"id", mark.id}, {key, set}};
      });
    };
    edit("blur (px)", mark.requested_px, -30, 30, "blur_px");
    edit("weight", mark.weight, 0, 4, "weight");
    bool extent = mark.extent_stops.has_value();
    if (ImGui::Checkbox("depth of field", &extent)) {
      send({{"type", "set_point"}, {"id", mark.id}, {"extent_stops", extent ? Json(0) : Json(nullptr)}});
    }
    ImGui::BeginDisabled(!extent);
    edit("stops", mark.extent_stops.value_or(0), -4, 8, "extent_stops");
    ImGui::EndDisabled();
    if (ImGui::Button("Remove")) {
      send({{"type", "remove_point"}, {"id", mark.id}});
      selected_.clear();
    }
    ImGui::PopID();
  }

  // The section of the lens and the bokeh.
  void drawings() {
    const ImVec2 space = ImGui::GetContentRegionAvail(), corner = ImGui::GetCursorScreenPos();
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float lines = shown_->plane.empty() ? line : 2 * line;
    draw_section(draw, shown_->section, {corner.x, corner.y + lines}, {space.x - space.y - 8, space.y - lines});
    if (bokeh_ && shown_->bokeh.pixels > 0) {
      const ImVec2 start{corner.x + space.x - space.y, corner.y}, end{corner.x + space.x, corner.y + space.y};
      draw.AddImage(bokeh_.id(), start, end);
      const std::string text = "bokeh, " + examples::number(shown_->bokeh.width_px, 3) + " px wide";
      draw.AddText({start.x + 4, end.y - 16}, yellow, text.c_str());
    }
    ImGui::TextDisabled("%s, rays of the point under the mouse", state().lens.name().c_str());
    if (!shown_->plane.empty()) ImGui::TextDisabled("%s", shown_->plane.c_str());
  }

  // All panels on the right.
  void panels() {
    if (ImGui::Button("Undo") && shown_->can_undo) send({{"type", "undo"}});
    ImGui::SameLine();
    if (ImGui::Button("Redo") && shown_->can_redo) send({{"type", "redo"}});
    ImGui::SameLine();
    if (ImGui::Button("Export")) {
      worker_.write_to(options_.out_folder.empty() ? std::filesystem::path("out") / "view"
                                                   : std::filesystem::path(options_.out_folder));
    }
    ImGui::SameLine();
    ImGui::Checkbox("sharp", &before_);
    ImGui::SameLine();
    ImGui::Checkbox("map", &overlay_);
    for (const auto& [words, zoom] : {std::pair{"fit", 0}, {"1:1", 1}, {"2:1", 2}}) {
      if (ImGui::RadioButton(words, zoom_ == zoom)) zoom_to(zoom, middle_of_attention());
      ImGui::SameLine();
    }
    ImGui::TextDisabled("keys: 0, 1, 2");
    ImGui::PushItemWidth(0.55f * panel_width);
    if (header("Focus", "focus", true)) focus_panel();
    if (header("Points", "points", true)) points_panel();
    if (header("Lens", "lens", true)) lens_panel();
    if (header("Bokeh", "bokeh")) bokeh_panel();
    if (header("Aberrations", "aberrations")) aberrations_panel();
    if (header("Keys", "keys")) time_panel();
    const bool histogram = header("Blur of the picture (-20 to 20 px)", "histogram");
    worker_.show_map(overlay_ || histogram);
    if (histogram) {
      ImGui::PlotHistogram("##blur", shown_->histogram.data(), static_cast<int>(shown_->histogram.size()), 0, nullptr,
                           0, FLT_MAX, {panel_width - 30, 60});
    }
    ImGui::PopItemWidth();
  }

  void focus_panel() {
    using petzval::FocusServe;
    constexpr std::array serves{FocusServe::distance, FocusServe::film, FocusServe::tilt, FocusServe::surface};
    constexpr std::array words{"one point", "upright film", "tilted film", "focal surface"};
    for (std::size_t i = 0; i < serves.size(); ++i) {
      if (ImGui::RadioButton(words[i], state().serve == serves[i])) {
        send({{"type", "serve"}, {"by", name(serves[i])}});
      }
      if (i % 2 == 0) ImGui::SameLine(panel_width / 2);
    }
    // One line in every state, so that nothing below moves under the mouse.
    ImGui::TextColored({1, 0.7f, 0.4f, 1}, "%s", in_words(state()).c_str());
    const bool infinite = std::isinf(state().focus_mm);
    slider(
        "distance (m)", infinite ? farthest_m : state().focus_mm / 1000, 0.1, farthest_m,
        infinite ? "infinity" : "%.3f",
        [](double m) {
          return patch({{"focus_mm", m < farthest_m ? Json(1000 * m) : Json(nullptr)}});
        },
        ImGuiSliderFlags_Logarithmic);
    if (state().serve == FocusServe::surface) {
      slider("beta", state().setup.focal_surface.beta, 1, 8, "%.1f", "/focal_surface/beta");
      ImGui::Dummy({1, ImGui::GetFrameHeight()});
    } else {
      const petzval::Film& film = state().setup.film;
      slider("tilt (deg)", film.tilt_rad, -20, 20, "%.2f", "/film/tilt_rad", degree);
      slider("swing (deg)", film.swing_rad, -20, 20, "%.2f", "/film/swing_rad", degree);
    }
    bool nearer = nearer_, fade = fade_;
    if (ImGui::Checkbox("nearer points weigh more", &nearer)) {
      send({{"type", "weighting"}, {"nearer", nearer_ = nearer}});
    }
    if (ImGui::Checkbox("points outside fade", &fade)) send({{"type", "weighting"}, {"fade", fade_ = fade}});
  }

  void points_panel() {
    for (const petzval::FocusMark& mark : state().targets) {
      const std::string label = "point " + mark.id + (mark.status == "used" ? "" : " (" + in_words(mark) + ")");
      ImGui::SetNextItemOpen(mark.id == selected_, ImGuiCond_Always);
      const bool open = ImGui::TreeNode(mark.id.c_str(), "%s", label.c_str());
      if (ImGui::IsItemClicked()) selected_ = mark.id == selected_ ? "" : mark.id;
      if (!open) continue;
      edit_point(mark);
      ImGui::TreePop();
    }
    if (state().targets.empty()) ImGui::TextDisabled("click into the picture");
  }

  void lens_panel() {
    const std::string& shown = lens_name(state());
    const ImVec2 thumbnail{110, 44};
    if (list_width_ == 0) {
      for (const ShippedLens& lens : lenses_)
        list_width_ = std::max(list_width_, ImGui::CalcTextSize(lens.id.c_str()).x);
    }
    ImGui::SetNextItemWidth(panel_width - 30);
    ImGui::SetNextWindowSizeConstraints({thumbnail.x + list_width_ + 50, 0}, {FLT_MAX, FLT_MAX});
    if (ImGui::BeginCombo("##lens", shown.c_str(), ImGuiComboFlags_HeightLargest)) {
      for (ShippedLens& lens : lenses_) {
        ImGui::PushID(lens.id.c_str());
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        if (ImGui::Selectable("##lens", lens.id == state().setup.lens.file, 0, {0, thumbnail.y})) {
          send_lens({{"file", lens.id}, {"thin_mm", nullptr}}, nullptr);
        }
        if (ImGui::IsItemVisible()) {
          if (!lens.section) lens.section = drawing_of(lens.id);
          ImDrawList& draw = *ImGui::GetWindowDrawList();
          draw_section(draw, *lens.section, corner, thumbnail);
          draw.AddText({corner.x + thumbnail.x + 8, corner.y + thumbnail.y / 2 - 7}, white, lens.id.c_str());
        }
        ImGui::PopID();
      }
      ImGui::EndCombo();
    }
    ImGui::TextDisabled("or drop a lens file into the window");
    if (ImGui::Button("thin lens, 50 mm f/2")) {
      send_lens({{"thin_mm", 50}, {"file", nullptr}}, 2);
    }
    slider("f-number", state().f_number, 0.5, 32, "f/%.2f", "/f_number", 1, ImGuiSliderFlags_Logarithmic);
    const petzval::Iris& iris = state().lens.iris();
    int blades = iris.blades;
    if (ImGui::SliderInt("blades", &blades, 0, 12, blades < 3 ? "round" : "%d")) {
      send_from_widget("blades", patch({{"iris", {{"blades", blades < 3 ? 0 : blades}}}}));
    }
    end_of_widget();
    ImGui::BeginDisabled(iris.blades == 0);
    slider("roundness", iris.roundness, -1, 1, "%.2f", "/iris/roundness");
    slider("rotation (deg)", iris.rotation_rad, -180, 180, "%.0f", "/iris/rotation_rad", degree);
    ImGui::EndDisabled();
    bool rgb = state().setup.lens.wavelengths_nm.size() == 4;
    if (ImGui::Checkbox("colour of the lens", &rgb)) {
      std::vector<double> nm{petzval::d_line_nm};
      if (rgb) nm.insert(nm.end(), petzval::rgb_triple_nm.begin(), petzval::rgb_triple_nm.end());
      send(patch({{"lens", {{"wavelengths_nm", nm}}}}));
    }
  }

  void bokeh_panel() {
    const petzval::BokehControls& bokeh = state().setup.camera.bokeh;
    slider("lens ratio", bokeh.lens_ratio, 0.2, 2, "%.2f", "/camera/bokeh/lens_ratio");
    slider("rate of change", bokeh.rate_of_change, 0, 2, "%.2f", "/camera/bokeh/rate_of_change");
    slider("rim weight", bokeh.weight_distribution, -10, 10, "%.2f", "/camera/bokeh/weight_distribution");
    slider("strength", bokeh.weight_strength, -1, 1, "%.2f", "/camera/bokeh/weight_strength");
    bool keep = bokeh.keep_light;
    if (ImGui::Checkbox("keep light", &keep)) send(patch({{"camera", {{"bokeh", {{"keep_light", keep}}}}}}));
  }

  void aberrations_panel() {
    const petzval::ExpressiveLens& lens = state().setup.camera.expressive;
    const double rim = lens.power.empty() ? 0 : lens.power.back().power - 1;
    const auto expressive = [](const char* key, const Json& list) {
      return patch({{"camera", {{"expressive", {{key, list}}}}}});
    };
    slider("spherical (%)", 100 * rim, -5, 5, "%.2f", [&](double percent) {
      const auto knot = [](double radius, double power) { return Json{{"radius", radius}, {"power", power}}; };
      Json power = Json::array();
      if (percent != 0) power = {knot(0, 1), knot(0.7, 1 + percent / 200), knot(1, 1 + percent / 100)};
      return expressive("power", power);
    });
    const double bend = lens.film_offsets.empty() ? 0 : lens.film_offsets.back().offset_mm;
    slider("curvature (mm)", bend, -2, 2, "%.2f", [&](double mm) {
      const auto at = [](double x, double y, double offset) {
        return Json{{"film_point", {{"x", x}, {"y", y}}}, {"offset_mm", offset}};
      };
      const double x = state().setup.film.width_mm / 2, y = state().setup.film.height_mm / 2;
      Json points = Json::array();
      if (mm != 0) points = {at(0, 0, 0), at(x, y, mm), at(-x, y, mm), at(x, -y, mm), at(-x, -y, mm)};
      return expressive("film_offsets", points);
    });
    slider("axial colour", lens.dispersion.empty() ? 1 : lens.dispersion.front(), 0, 10, "%.1f", [&](double factor) {
      return expressive("dispersion", factor == 1 ? Json::array() : Json::array({factor}));
    });
    slider("of the real lens", from_lens_, 0, 4, "%.2f", [this](double part) {
      from_lens_ = part;
      return Json{{"type", "expressive"}, {"from_lens", part}};
    });
  }

  void time_panel() {
    slider("time (s)", state().time_s, 0, 10, "%.2f", [](double s) { return Json{{"type", "time"}, {"time_s", s}}; });
    // A mark for each key below the slider.
    const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
    const float width = 0.55f * panel_width;
    for (const double key : shown_->key_times) {
      const float x = least.x + width * static_cast<float>(std::clamp(key / 10, 0.0, 1.0));
      ImGui::GetWindowDrawList()->AddTriangleFilled({x - 4, most.y + 5}, {x + 4, most.y + 5}, {x, most.y}, yellow);
    }
    if (ImGui::Button("Set key")) send({{"type", "key"}, {"time_s", state().time_s}});
    ImGui::SameLine();
    if (ImGui::Button(playing_ ? "Stop" : "Play")) playing_ = !playing_;
  }

  void play() {
    if (!playing_) {
      play_has_begun_ = false;
      return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (now - last_step_ < std::chrono::milliseconds(42)) return;
    last_step_ = now;
    const double end = shown_->key_times.empty() ? 10 : std::max(0.1, shown_->key_times.back());
    const double next = state().time_s + 1 / 24.0;
    Json event{{"type", "time"}, {"time_s", next > end ? 0 : next}};
    if (std::exchange(play_has_begun_, true)) event["continues"] = true;
    send(event);
  }

  WindowOptions options_;
  Worker worker_;
  std::shared_ptr<const Snapshot> shown_;
  std::vector<ShippedLens> lenses_;
  Texture picture_, sharp_, map_, bokeh_;
  std::uint64_t pictures_ = 0;
  std::shared_ptr<const petzval::Rgb8Image> sharp_shown_;
  std::shared_ptr<const std::vector<float>> blur_shown_;

  std::string dragged_;           ///< the widget whose events are one step of undo
  std::string selected_, moved_;  ///< ids of points
  bool move_has_begun_ = false;
  int zoom_ = 0;                        ///< screen pixels of a pixel; 0: the picture fills the window
  std::optional<int> zoom_key_;         ///< the zoom of a key, for the point under the mouse
  petzval::Vec2<double> middle_{0, 0};  ///< raster position in the middle of a zoomed picture
  float list_width_ = 0;                ///< of the longest name in the list of lenses
  petzval::Vec2<double> pressed_at_{-1, -1}, looked_at_{-1, -1};
  bool before_ = false, overlay_ = false, nearer_ = false, fade_ = true, playing_ = false, play_has_begun_ = false,
       closed_ = false;
  double from_lens_ = 0;
  std::chrono::steady_clock::time_point last_step_{};
};

}  // namespace

void show_window(const WindowOptions& options) {
  examples::Interrupt interrupt;
  examples::hide_progress();
  std::optional<Screen> screen;
  Window window(options);  // after the screen, which its textures must not outlive
  const auto save = [&] {
    if (!options.log_file.empty()) examples::write_text(options.log_file, window.worker().log().dump(1) + '\n');
  };
  try {
    const auto [width, height] = window.size();
    screen.emplace("petzval view", width, height);
    bool open = true;
    int frames_to_draw = frames_after_change;
    std::shared_ptr<const Snapshot> drawn;
    while (open && !examples::Interrupt::asked()) {
      SDL_Event event;
      // The window is drawn only after changes, because drawing takes time from the worker.
      bool changed = SDL_WaitEventTimeout(nullptr, 15) != 0;
      while (SDL_PollEvent(&event) != 0) {
        Screen::process(event);
        if (event.type == SDL_QUIT) window.close();
        if (event.type == SDL_KEYDOWN) window.pressed(event.key);
        if (event.type == SDL_DROPFILE) {
          window.dropped(event.drop.file);
          SDL_free(event.drop.file);
        }
      }
      changed = changed || window.plays() || window.worker().snapshot() != drawn;
      drawn = window.worker().snapshot();
      if (changed) frames_to_draw = frames_after_change;
      const bool last = frames_to_draw == 0 && !options.screenshot.empty() && window.complete();
      if (frames_to_draw == 0 && !last) continue;
      frames_to_draw = std::max(0, frames_to_draw - 1);
      screen->begin();
      open = window.draw();
      screen->end();
      if (last) {
        examples::write_png(screen->picture(), options.screenshot);
        open = false;
        const std::string& refused = window.worker().refused();
        const std::string& why = refused.empty() ? window.shown()->problem : refused;
        if (!why.empty()) throw petzval::Error(why);
      }
      screen->swap();
    }
    save();
    examples::end_if_asked();  // the worker may need seconds to end
  } catch (const petzval::Error& error) {
    save();
    const std::string saved = options.log_file.empty() ? "" : ". The events are saved in " + options.log_file;
    throw petzval::Error(error.what() + saved);
  }
}

}  // namespace viewer
