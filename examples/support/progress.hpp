// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace examples {

/// Shows a line with the progress of a command from its second second on, if standard error is a terminal: the step of
/// a Progress if one exists, else the time spent. Other output on the terminal replaces the line. Call once.
void show_progress(const std::string& command);
/// Removes the line for good.
void hide_progress();

/// Time since a start, ms.
inline double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The steps of a long job, for the line of show_progress(), which adds the time left as if all steps took equally
/// long. Only one Progress may exist at a time.
class Progress {
 public:
  Progress(std::string title, std::size_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Begins the next step.
  void step(const std::string& what);

 private:
  std::string title_;
  std::size_t steps_, begun_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace examples
