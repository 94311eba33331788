// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "support/files.hpp"
#include "viewer/session.hpp"

namespace viewer {

/// Options of replay().
struct ReplayOptions {
  SessionOptions session;
  examples::Json events;    ///< a list
  std::string log_file;     ///< for messages
  std::string out_folder;   ///< for pictures; empty: none
  std::uint32_t rays = 16;  ///< rays per pixel after each event
  bool json = false;
};

/// Applies events without a window. Prints the state after each event, in words or as JSON, and writes event_0001.png
/// and so on. `still` waits for the last ray.
///
/// An event that is refused, or whose state has no picture, is reported, and the others go on.
/// @throws petzval::Error at the end if there was such an event
void replay(const ReplayOptions& options);

}  // namespace viewer
