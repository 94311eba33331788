// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace examples {

/// While an Interrupt exists, the first ctrl-C (SIGINT) or SIGTERM asks the program to stop and write its results. The
/// second signal kills the program. Only one Interrupt may exist at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// True after the first signal. Thread-safe.
  static bool asked() noexcept;
};

/// Ends a program that was asked to stop: run() says so and returns interrupted_status.
struct Interrupted {};

/// Throws Interrupted after the first signal.
void stop_if_asked();

/// Exit status of an interrupted program, as in shells.
inline constexpr int interrupted_status = 130;

}  // namespace examples
