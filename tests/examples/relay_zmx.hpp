// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace examples_testing {

/// A .zmx of a singlet 200 mm behind its object, with two wavelengths; the second is primary. head: the lines before
/// the fields.
inline std::string relay_zmx(const std::string& head) {
  return head + R"(WAVM 1 0.55 1.0
WAVM 2 0.45 0.25
PWAV 2
SURF 0
  TYPE STANDARD
  CURV 0.0
  DISZ 200.0
SURF 1
  STOP
  TYPE STANDARD
  CURV 0.02
  DISZ 5.0
  GLAS N-BK7 0 0 1.5168 64.17
  DIAM 10.0 1 0 0 1
SURF 2
  TYPE STANDARD
  CURV -0.02
  DISZ 63.0
  DIAM 10.0 1 0 0 1
SURF 3
  TYPE STANDARD
  CURV 0.0
  DISZ 0.0
)";
}

}  // namespace examples_testing
