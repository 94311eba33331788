// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/text.hpp"

#include <array>
#include <charconv>

namespace petzval::inline v0 {

std::string number(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string number(double value, int significant_digits) {
  std::array<char, 64> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, significant_digits)
          .ptr;
  return {buffer.data(), end};
}

std::string escaped_xml(std::string_view words) {
  std::string result;
  for (const char c : words) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace petzval::inline v0
