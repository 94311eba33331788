// SPDX-License-Identifier: Apache-2.0
#include "text.hpp"

#include <array>
#include <charconv>
#include <cstddef>

namespace examples {
namespace {

/// The digits that std::to_chars writes. The buffer is large enough for every number.
template <class... Format>
std::string digits(double value, Format... format) {
  std::array<char, 400> buffer;
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...).ptr};
}

}  // namespace

std::string number(double value) { return digits(value); }

std::string number(double value, int significant_digits) {
  return digits(value, std::chars_format::general, significant_digits);
}

std::string fixed(double value, int decimals) { return digits(value, std::chars_format::fixed, decimals); }

std::string comment_text(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (static_cast<unsigned char>(text[i]) < ' ') text[i] = ' ';
    if (text[i] == '*' && (text[i + 1] == '/' || (i > 0 && text[i - 1] == '/'))) text[i] = ' ';
  }
  return text;
}

std::string escaped_html(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace examples
