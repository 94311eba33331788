// SPDX-License-Identifier: Apache-2.0
#include "core/text.hpp"

#include <array>
#include <charconv>

namespace petzval::inline v0 {

std::string to_text(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string to_text(double value, int significant_digits) {
  std::array<char, 64> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, significant_digits)
          .ptr;
  return {buffer.data(), end};
}

std::string_view beginning(std::string_view text, std::size_t most) noexcept {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;  // a byte that goes on
  return text.substr(0, most);
}

}  // namespace petzval::inline v0
