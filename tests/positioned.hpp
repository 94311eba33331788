// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

namespace petzval::testing {

/// True if a message begins with file name, line and column ("x.json:11:8: ") and then contains these words in this
/// order. position: "11:8", or empty for any.
inline ::testing::AssertionResult positioned(const std::string& message, std::string_view file,
                                             std::initializer_list<std::string_view> words,
                                             std::string_view position = {}) {
  const auto failed = [&](const std::string& missing) {
    return ::testing::AssertionFailure() << missing << " is not in its position of: " << message;
  };
  const std::string_view text = message;
  if (!text.starts_with(std::string(file) + ':')) return failed(std::string(file));
  const std::size_t from = file.size() + 1, end = text.find(": ", from);
  const std::string_view found = text.substr(from, end == std::string_view::npos ? 0 : end - from);
  const bool numbers = found.find_first_not_of("0123456789:") == std::string_view::npos &&
                       std::ranges::count(found, ':') == 1 && !found.starts_with(':') && !found.ends_with(':');
  if (!numbers || (!position.empty() && found != position))
    return failed("a line and a column " + std::string(position));
  std::size_t at = end;
  for (const std::string_view word : words) {
    at = text.find(word, at);
    if (at == std::string_view::npos) return failed(std::string(word));
    at += word.size();
  }
  return ::testing::AssertionSuccess();
}

}  // namespace petzval::testing
