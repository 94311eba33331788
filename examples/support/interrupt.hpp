// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace examples {

/// While one exists, the first ctrl-C (SIGINT) or SIGTERM asks the program to stop and write what it has; the second
/// one kills it. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// True once a signal has come. Any thread may ask.
  static bool asked() noexcept;
};

/// Exit status of a program that was interrupted, as shells have it.
inline constexpr int interrupted_status = 130;

}  // namespace examples
