// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "viewer/session.hpp"

namespace viewer {

/// What the window starts with.
struct WindowOptions {
  SessionOptions session;
  std::string log_file;       ///< where the events are saved when the window closes
  std::string out_folder;     ///< for exported pictures
  std::string first_log;      ///< events to begin with, a JSON list; empty: none
  int width = 0, height = 0;  ///< of the window; 0: fits the picture
};

/// Shows the window until it is closed.
///
/// @throws petzval::Error if there is no display; the events are saved before
void show_window(const WindowOptions& options);

}  // namespace viewer
