// SPDX-License-Identifier: Apache-2.0
#include "viewer/replay.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>

#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"
#include "support/cli.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"

namespace viewer {
namespace {

using examples::Json;

/// A line about the state for people.
std::string in_words(const Session& session, const Json& state) {
  const petzval::FocusEditorState& editor = session.editor().state();
  const std::string unserved = viewer::in_words(editor), mm = examples::number(editor.focus_mm, 5) + " mm";
  std::string line = "serve " + std::string(name(editor.serve)) + (unserved.empty() ? "" : " (" + unserved + ')') +
                     ", focus " + (std::isinf(editor.focus_mm) ? "infinity" : mm) + ", f/" +
                     examples::number(editor.f_number, 3);
  const petzval::Film& film = editor.setup.film;
  if (film.tilted()) {
    line += ", tilt " + examples::number(petzval::degrees(film.tilt_rad), 3) + ", swing " +
            examples::number(petzval::degrees(film.swing_rad), 3) + " degrees";
  }
  for (const petzval::FocusMark& mark : editor.targets) {
    line += "; " + mark.id + ": ";
    line += mark.blur_px ? examples::number(*mark.blur_px, 3) + " px" : viewer::in_words(mark);
  }
  return line + "; " + state["rays"].dump() + " rays in " + examples::number(state["frame_ms"].get<double>(), 3) +
         " ms";
}

}  // namespace

void replay(const ReplayOptions& options) {
  if (!options.out_folder.empty()) examples::make_folder(options.out_folder);
  Session session(options.session);
  session.make_layers();
  std::size_t number = 0, refused = 0;
  for (const Json& event : options.events) {
    ++number;
    const auto start = std::chrono::steady_clock::now();
    std::string error;
    try {
      session.editor().apply(event.dump());
    } catch (const petzval::Error& why) {
      error = why.what();
      ++refused;
    }
    const bool still = error.empty() && event["type"] == "still";
    const double event_ms = examples::ms_since(start);
    double layers_ms = 0;
    Frame frame;
    try {
      layers_ms = session.make_layers();
      frame = still ? session.still() : session.frame(options.rays);
    } catch (const petzval::Error& why) {
      if (error.empty()) error = no_picture(session, why), ++refused;
    }
    frame.milliseconds += event_ms;
    Json state = session.state_json(frame);
    if (layers_ms > 0) state["layers_ms"] = layers_ms;
    std::string name = std::to_string(number);
    name.insert(0, 4 - std::min<std::size_t>(name.size(), 4), '0');
    const std::filesystem::path stem = std::filesystem::path(options.out_folder) / ("event_" + name);
    if (still && !options.out_folder.empty()) {
      state["command"] = session.blur_command(stem.string() + "_setup.json");
    }
    if (!error.empty()) state["error"] = error;
    if (options.json) {
      std::cout << state.dump() << '\n';
    } else {
      std::cout << number << ' '
                << (error.empty() ? event["type"].get<std::string>() + ": " + in_words(session, state) : error) << '\n';
    }
    if (!options.out_folder.empty() && frame.rays > 0) {
      examples::write_png(petzval::to_srgb8(frame.picture), stem.string() + ".png");
    }
  }
  if (refused > 0) {
    throw petzval::Error(options.log_file + ": " + std::to_string(refused) + " of " + std::to_string(number) +
                         " events were refused or have no picture");
  }
}

}  // namespace viewer
