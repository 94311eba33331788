// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/core/error.hpp"
#include "petzval/formats/lens_file.hpp"

namespace petzval::testing {

/// "line command: message" of each warning.
inline std::vector<std::string> said(const std::vector<ImportWarning>& warnings) {
  std::vector<std::string> result;
  for (const auto& w : warnings) result.push_back(std::to_string(w.line) + " " + w.command + ": " + w.message);
  return result;
}

inline std::vector<std::string> said(const Prescription& lens) { return said(lens.imported.value().warnings); }

/// Checks the tokens of each of these texts, and their number.
inline void expect_said(const std::vector<std::string>& said, const std::vector<std::vector<Token>>& tokens,
                        const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  for (std::size_t i = 0; i < std::min(said.size(), tokens.size()); ++i) expect_tokens(said[i], tokens[i], file, line);
  if (said.size() == tokens.size()) return;
  ADD_FAILURE_AT(file, line) << said.size() << " texts, not " << tokens.size() << ": "
                             << ::testing::PrintToString(said);
}

inline Prescription read_sample(std::string_view name) {
  return read_lens(std::filesystem::path(PETZVAL_TEST_SAMPLES) / name);
}

/// The text with the first `old` replaced. Throws Error if `old` is missing.
inline std::string with(std::string text, std::string_view old, std::string_view replacement) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw Error("the text has no \"" + std::string(old) + '"');
  return text.replace(at, old.size(), replacement);
}

}  // namespace petzval::testing
