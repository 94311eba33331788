// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "viewer/session.hpp"

namespace viewer {

/// Options of show_window().
struct WindowOptions {
  SessionOptions session;
  std::string log_file;                   ///< file for the events, written when the window closes
  std::string out_folder;                 ///< for exported pictures
  examples::Json first_events = nullptr;  ///< a list; null: a point in the middle of the picture
  std::vector<std::string> panels;        ///< that are open at the start; also "map" or "sharp"
  std::string screenshot;                 ///< PNG of the window with the still picture; then the window closes
};

/// Shows the window until it is closed.
///
/// @throws petzval::Error if there is no display; the events are saved before
void show_window(const WindowOptions& options);

}  // namespace viewer
