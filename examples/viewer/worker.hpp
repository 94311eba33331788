// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "petzval/image/image.hpp"
#include "viewer/section.hpp"
#include "viewer/session.hpp"

namespace viewer {

/// Everything that the window shows of a session, at one moment.
struct Snapshot {
  petzval::FocusEditorState state;
  std::vector<std::optional<petzval::Vec2<double>>> handles = {};  ///< raster positions of the points
  bool can_undo = false, can_redo = false;
  std::vector<double> key_times = {};
  std::string plane = {};    ///< the plane of focus in words
  std::string message = {};  ///< message of the last refused event or export
  std::string problem = {};  ///< the reason why the state has no picture; `picture` is then of an earlier state
  Section section = {};      ///< with the rays under the mouse

  Frame frame = {};  ///< without its picture
  std::shared_ptr<const petzval::Rgb8Image> picture = {}, sharp = {};
  std::shared_ptr<const std::vector<float>> blur = {};  ///< Session::blur_map()
  std::array<float, 41> histogram{};                    ///< pixels by blur, from -20 to 20 pixels
  Bokeh bokeh = {};                                     ///< under the mouse
  std::uint64_t pictures = 0;                           ///< number of pictures so far
};

/// Applies events to a session and computes its pictures in a thread of its own.
///
/// A change ends the work under way: first a picture with few rays, then more rays, and the still picture at last.
class Worker {
 public:
  /// first_events: a list; null: a point in the middle of the picture.
  Worker(const SessionOptions& options, const examples::Json& first_events);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Queues an event. An event that continues the last event of the queue replaces this event.
  void send(const examples::Json& event);
  /// Moves the point of the section and the bokeh.
  void look_at(const petzval::Vec2<double>& raster);
  /// True: the map of blur follows the first picture after a change, which takes longer; false: the second.
  void show_map(bool shown) noexcept { map_shown_ = shown; }
  /// Queues an export of the still picture, the events and the command line to a folder.
  void write_to(const std::filesystem::path& folder);
  std::shared_ptr<const Snapshot> snapshot() const;
  /// The file of --replay. Waits for the event under way.
  examples::Json log();
  /// The number of refused first events and the reason of the last refusal; empty without a refusal.
  const std::string& refused() const noexcept { return refused_; }
  /// True if the still picture of all events is shown.
  bool idle() const;

 private:
  void run();
  bool apply_events();
  std::stop_token start_work();
  void map_blur();
  void show_state(Snapshot next);
  void show(Frame frame);
  void look();
  void show_problem(const petzval::Error& why);
  void publish(Snapshot snapshot);
  void export_files(const std::filesystem::path& folder);

  Session session_;
  std::string refused_;
  mutable std::mutex mutex_;  ///< of everything below
  std::condition_variable changed_;
  std::vector<examples::Json> events_;
  petzval::Vec2<double> look_at_{0, 0};
  bool looks_ = false;  ///< look_at_ has changed
  std::atomic<bool> map_shown_ = false;
  std::optional<std::filesystem::path> folder_;
  std::shared_ptr<const Snapshot> snapshot_;
  bool ends_ = false, idle_ = false;
  std::stop_source stop_;  ///< cancels the work under way

  std::mutex session_mutex_;  ///< of session_
  std::string lens_shown_;    ///< the lens of the last picture
  std::thread thread_;        ///< last: starts when all else exists
};

}  // namespace viewer
