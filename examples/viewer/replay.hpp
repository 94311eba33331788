// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace viewer {

/// Options of replay().
struct ReplayOptions {
  std::string log_file;
  std::string out_folder;               ///< for pictures; empty: none
  std::uint32_t width = 0, height = 0;  ///< 0: the size of the log
  std::uint32_t rays = 16;              ///< rays per pixel after each event
  std::uint32_t layers = 4;
  int threads = 1;
  bool json = false;
};

/// Applies the events of a log without a window. Prints the state after each event, in words or as JSON, and writes
/// event_0001.png and so on. `still` waits for the last ray.
///
/// A refused event is reported, and the others go on.
/// @throws petzval::Error if the log cannot be read, or if an event was refused
void replay(const ReplayOptions& options);

}  // namespace viewer
