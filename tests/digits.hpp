// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>

namespace petzval::testing {

/// The shortest text that reads back to the number.
inline std::string digits(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// With a number of significant digits.
inline std::string digits(double value, int significant) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, significant).ptr};
}

}  // namespace petzval::testing
