// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "petzval/core/error.hpp"

namespace petzval::testing {

/// A word or number that a message must contain: the name of a parameter, its value, a file or a line.
class Token {
 public:
  Token(const char* text) : text_(text) {}
  Token(std::string text) : text_(std::move(text)) {}
  Token(std::string_view text) : text_(text) {}
  Token(const std::filesystem::path& file) : text_(file.string()) {}
  Token(char) = delete;

  /// A number as messages write it: the shortest decimals that read back to the same number.
  template <class Number>
    requires(std::integral<Number> || std::floating_point<Number>)
  Token(Number value) {
    std::array<char, 64> digits;
    text_.assign(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// True if the text contains the token as whole words: "5" is neither in "55" nor in "-5", "1.5" or "1e5".
/// "_" equals " ", so that "film_z" is found in "film z" and in "film_z_mm".
inline bool has_token(std::string text, std::string token) {
  std::replace(text.begin(), text.end(), '_', ' ');
  std::replace(token.begin(), token.end(), '_', ' ');
  const auto at = [&](std::size_t i) { return i < text.size() ? text[i] : ' '; };  // also for i = -1
  const auto digit = [](char c) { return '0' <= c && c <= '9'; };
  const auto word = [&](char c) {
    return digit(c) || ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
  };
  if (token.empty()) return false;
  const bool from_word = word(token.front()) || token.front() == '-';
  for (std::size_t i = text.find(token); i != std::string::npos; i = text.find(token, i + 1)) {
    const std::size_t end = i + token.size();
    const bool sign = (at(i - 1) == '-' || at(i - 1) == '+') && !word(at(i - 2));
    const bool starts =
        !from_word || !(word(at(i - 1)) || (digit(token.front()) && (sign || (at(i - 1) == '.' && digit(at(i - 2))))));
    const bool ends =
        !word(token.back()) || !(word(at(end)) || (digit(token.back()) && at(end) == '.' && digit(at(end + 1))));
    if (starts && ends) return true;
  }
  return false;
}

/// Checks that the text contains each token. A failure names the line of the caller.
inline void expect_tokens(const std::string& text, const std::vector<Token>& tokens,
                          const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  for (const Token& token : tokens) {
    if (!has_token(text, token.text())) ADD_FAILURE_AT(file, line) << "no \"" << token.text() << "\" in: " << text;
  }
}

/// Checks that `work` throws petzval::Error with a message that contains each token. The wording is free: tests name
/// the parameter, its value and the file or line, not the sentence. A failure names the line of the caller.
void expect_error(const auto& work, const std::vector<Token>& tokens, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
  try {
    work();
  } catch (const Error& error) {
    return expect_tokens(error.what(), tokens, file, line);
  } catch (const std::exception& error) {
    ADD_FAILURE_AT(file, line) << "an exception that is no petzval::Error: " << error.what();
    return;
  }
  ADD_FAILURE_AT(file, line) << "no exception";
}

}  // namespace petzval::testing
