// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "../message.hpp"
#include "petzval/formats/lens_file.hpp"
#include "said.hpp"

namespace petzval::testing {

inline Prescription read(const std::string& text, const std::string& entry = {}) {
  return parse_lens(text, "x", {.entry = entry});
}

inline std::string refusal(const std::string& text, const std::string& entry = {}) {
  return message([&] { read(text, entry); });
}

/// The message of the warning about a command; "no warning" without a warning.
inline std::string warning(const Prescription& lens, std::string_view command) {
  const auto found = std::ranges::find(lens.imported->warnings, command, &ImportWarning::command);
  return found == lens.imported->warnings.end() ? "no warning" : found->message;
}
inline std::string warning(const std::string& text, std::string_view command) { return warning(read(text), command); }

/// A text repeated `count` times.
inline std::string repeated(int times, std::string_view text) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

}  // namespace petzval::testing
