// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace examples {

/// Exit status of an interrupted program, as in shells.
inline constexpr int interrupted_status = 130;

/// Makes ctrl-C (SIGINT) and SIGTERM end the program at once with interrupted_status, whatever its threads do.
///
/// Unfinished files and empty folders of the program are removed. Call before other threads start: they inherit the
/// signal mask.
/// @param note  line for standard error
void end_on_signals(const std::string& note);

/// While an Interrupt exists, the first signal only asks the program to stop and write its results. The second signal
/// ends it. Only one Interrupt may exist at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// True after the first signal. Thread-safe.
  static bool asked() noexcept;
};

/// Ends the program if a signal asked it to stop.
void end_if_asked();

/// While a Together exists, a signal waits for up to 0.8 s, so that either all or none of several files are written.
class Together {
 public:
  Together();
  ~Together();
  Together(const Together&) = delete;
  Together& operator=(const Together&) = delete;
};

/// Names a folder for results. A signal removes unfinished files in it and, if the program made it, the empty folder.
void clean_on_signals(const std::filesystem::path& folder, bool made);

}  // namespace examples
