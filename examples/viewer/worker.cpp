// SPDX-License-Identifier: Apache-2.0
#include "viewer/worker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>

#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "support/files.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"

namespace viewer {
namespace {

using examples::Json;

/// Rays per pixel of the pictures after a change.
constexpr std::array<std::uint32_t, 3> ray_steps{16, 64, 256};
/// Time without a change after which the still picture is computed.
constexpr auto patience = std::chrono::milliseconds(500);

/// The plane of focus of a tilted film in words.
std::string plane_in_words(const petzval::FocusEditorState& state) {
  if (!state.setup.film.tilted()) return "";
  const auto plane = petzval::focus_plane(petzval::thick_lens(state.lens), state.setup.film);
  if (!plane) return "plane of focus: at infinity";
  std::string text = "plane of focus: turned by " +
                     examples::number(petzval::degrees(std::acos(std::min(1.0, plane->plane.normal.z))), 3) +
                     " degrees";
  if (plane->hinge) {
    const petzval::Vec3<double>& near = plane->hinge->point;
    text += "; hinge line " + examples::number(std::hypot(near.x, near.y), 4) + " mm from the axis";
  }
  return text;
}

}  // namespace

Worker::Worker(const SessionOptions& options, const Json& first_events) : session_(options) {
  session_.make_layers();
  const petzval::Film& film = session_.editor().state().setup.film;
  const petzval::Vec2<double> middle(film.columns / 2, film.rows / 2);
  if (first_events.is_null()) {
    session_.editor().apply(Json{{"type", "add_point"}, {"id", "1"}, {"pixel", {middle.x, middle.y}}}.dump());
  }
  std::size_t number = 0, count = 0;
  for (const Json& event : first_events) {
    ++number;
    try {
      session_.editor().apply(event.dump());
    } catch (const petzval::Error& why) {
      refused_ = std::to_string(++count) + " of " + std::to_string(first_events.size()) +
                 " events were refused, the last: event " + std::to_string(number) + ": " + why.what();
    }
  }
  look_at_ = middle;
  show_state(Snapshot{.state = session_.editor().state(), .message = refused_});
  thread_ = std::thread([this] { run(); });
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    stop_.request_stop();
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::send(const Json& event) {
  {
    const std::lock_guard lock(mutex_);
    const bool continues = event.value("continues", false);
    Json added = event;
    if (continues && !events_.empty() && events_.back()["type"] == event["type"] &&
        events_.back().value("id", "") == event.value("id", "")) {
      if (!events_.back().value("continues", false)) added.erase("continues");
      events_.back() = std::move(added);
    } else {
      events_.push_back(std::move(added));
    }
    idle_ = false;
    stop_.request_stop();
  }
  changed_.notify_all();
}

void Worker::look_at(const petzval::Vec2<double>& raster) {
  {
    const std::lock_guard lock(mutex_);
    look_at_ = raster, looks_ = true;
  }
  changed_.notify_all();
}

void Worker::write_to(const std::filesystem::path& folder) {
  {
    const std::lock_guard lock(mutex_);
    folder_ = folder;
  }
  changed_.notify_all();
}

std::shared_ptr<const Snapshot> Worker::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

Json Worker::log() {
  const std::lock_guard lock(session_mutex_);
  return session_.log();
}

bool Worker::idle() const {
  const std::lock_guard lock(mutex_);
  return idle_;
}

void Worker::publish(Snapshot snapshot) {
  const std::lock_guard lock(mutex_);
  snapshot_ = std::make_shared<const Snapshot>(std::move(snapshot));
}

/// A token that the next event stops.
std::stop_token Worker::start_work() {
  const std::lock_guard lock(mutex_);
  stop_ = std::stop_source();
  if (ends_ || !events_.empty()) stop_.request_stop();
  return stop_.get_token();
}

/// Applies the queued events. Returns true if there were any.
bool Worker::apply_events() {
  std::vector<Json> events;
  {
    const std::lock_guard lock(mutex_);
    events.swap(events_);
  }
  if (events.empty()) return false;
  Snapshot next = *snapshot();
  next.message.clear();
  for (const Json& event : events) {
    try {
      session_.editor().apply(event.dump());
    } catch (const petzval::Error& error) {
      next.message = error.what();
    }
  }
  show_state(std::move(next));
  return true;
}

void Worker::show_state(Snapshot next) {
  next.state = session_.editor().state();
  next.can_undo = session_.editor().can_undo(), next.can_redo = session_.editor().can_redo();
  next.key_times = session_.editor().key_times();
  next.plane = plane_in_words(next.state);
  next.frame.still = false;
  publish(std::move(next));
}

void Worker::show(Frame frame) {
  Snapshot next = *snapshot();
  next.picture = std::make_shared<const petzval::Rgb8Image>(petzval::to_srgb8(frame.picture));
  frame.picture = {};
  next.frame = std::move(frame);
  next.problem.clear();
  ++next.pictures;
  publish(std::move(next));
}

/// Draws the section with the rays of the point under the mouse, and the bokeh of this point.
void Worker::look() {
  petzval::Vec2<double> raster{0, 0};
  {
    const std::lock_guard lock(mutex_);
    raster = look_at_, looks_ = false;
  }
  const petzval::FocusEditorState& state = session_.editor().state();
  Snapshot next = *snapshot();
  next.section = section_of(state.lens, state.setup.film);
  next.bokeh = {};
  try {
    const petzval::Camera& camera = state.camera();
    next.section.rays = rays_through(camera, state.setup.film.point(raster.x, raster.y));
    const float depth = session_.depth_mm(static_cast<int>(raster.x), static_cast<int>(raster.y));
    if (depth > 0) next.bokeh = bokeh_of(camera, raster, static_cast<double>(depth), session_.focal_px());
  } catch (const petzval::Error&) {
    // A lens without a camera has its section only.
  }
  publish(std::move(next));
}

/// Shows why the state has no picture.
void Worker::show_problem(const petzval::Error& why) {
  Snapshot next = *snapshot();
  next.problem = no_picture(session_, why);
  next.handles.clear(), next.histogram = {}, next.blur.reset(), next.sharp.reset();
  publish(std::move(next));
  look();
}

void Worker::export_files(const std::filesystem::path& folder) {
  Snapshot next = *snapshot();
  next.message = "computing the still picture ...";
  publish(next);
  try {
    examples::make_folder(folder);
    const Frame still = session_.still();
    examples::write_picture(still.picture, petzval::to_srgb8(still.picture), {"exr", "png"}, folder / "view");
    examples::write_text(folder / "view.json", session_.log().dump(1) + '\n');
    examples::write_text(folder / "blur.sh", session_.blur_command((folder / "setup.json").string()) + '\n');
    next.message = "written to " + std::filesystem::absolute(folder).lexically_normal().string() +
                   ": view.png, view.exr, view.json (events), setup.json (camera), blur.sh (command line)";
  } catch (const petzval::Error& error) {
    next.message = error.what();
  }
  publish(std::move(next));
}

/// The map of blur and its histogram.
void Worker::map_blur() {
  Snapshot next = *snapshot();
  auto blur = session_.blur_map();
  next.histogram = {};
  for (const float value : blur) {
    if (std::isnan(value)) continue;
    next.histogram[static_cast<std::size_t>(std::clamp(value, -20.0f, 20.0f) + 20.5f)] += 1;
  }
  next.blur = std::make_shared<const std::vector<float>>(std::move(blur));
  publish(std::move(next));
}

void Worker::run() {
  // After a change, a picture is computed for each entry of ray_steps, then the still picture.
  constexpr std::size_t still_step = ray_steps.size(), all_steps = still_step + 1;
  std::size_t step = 0;
  bool mapped = false;
  bool layers_first = false;  // true: a picture failed; the next one needs new layers
  while (true) {
    std::optional<std::filesystem::path> folder;
    bool looks = false;
    {
      std::unique_lock lock(mutex_);
      const auto woken = [&] { return ends_ || !events_.empty() || looks_ || folder_; };
      idle_ = step == all_steps && !woken();
      if (step == still_step) changed_.wait_for(lock, patience, woken);
      if (step == all_steps) changed_.wait(lock, woken);
      if (ends_) return;
      folder = std::exchange(folder_, std::nullopt);
      looks = looks_;
    }
    const std::lock_guard session_lock(session_mutex_);
    if (apply_events()) step = 0;
    try {
      const std::stop_token stop = start_work();
      if (folder) export_files(*folder);
      if (layers_first && step < all_steps) session_.make_layers();
      if (step == 0) {
        // The rays of a new real lens take longer to set up: meanwhile a picture without its aberrations.
        const std::string lens = lens_key(session_.editor().state());
        if (lens != std::exchange(lens_shown_, lens)) show(session_.frame(ray_steps[0], true, stop));
      }
      if (step < still_step) {
        show(session_.frame(ray_steps[step], false, stop));
        layers_first = false;
        ++step;
      } else if (step == still_step && !looks) {
        show(session_.still(stop));
        ++step;
      }
      if (step == 1) {
        Snapshot next = *snapshot();
        next.handles = session_.handles();
        publish(std::move(next));
        looks = true;
        if (session_.make_layers() > 0) step = 0;
      }
      if (step == 1) mapped = false;
      if (!mapped && (step == 2 || (step == 1 && map_shown_))) map_blur(), mapped = true;
      if (step == 2) {
        Snapshot next = *snapshot();
        next.sharp = std::make_shared<const petzval::Rgb8Image>(petzval::to_srgb8(session_.sharp()));
        publish(std::move(next));
      }
      if (looks && step > 0) look();
    } catch (const petzval::Cancelled&) {
      // The next event has come.
    } catch (const petzval::Error& error) {
      const bool again = !std::exchange(layers_first, true) && session_.layers_are_too_small();
      if (!again) show_problem(error);
      step = again ? 0 : all_steps;
    }
  }
}

}  // namespace viewer
