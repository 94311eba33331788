// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "text_file.hpp"

namespace petzval::formats_detail {

/// The statements of a .seq, one after the other: lines, or parts of lines between semicolons. "!" begins a comment,
/// and "&" at the end of a line continues the statement on the next line. In quoted text these characters have no
/// special meaning.
class Statements {
 public:
  explicit Statements(std::string_view text) : lines_(text) {}

  /// The next statement; false at the end of the text.
  bool next() {
    while (at_ >= text_.size()) {
      if (!read_line()) return false;
    }
    const std::size_t end = outside_quotes(text_, at_, ';');
    statement_ = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1;
    return true;
  }
  int line() const noexcept { return line_; }  ///< first line of the statement
  std::string_view text() const noexcept { return statement_; }

 private:
  /// Position of a character outside quotes; the size of the text if it does not occur.
  static std::size_t outside_quotes(std::string_view text, std::size_t from, char sign) {
    char quote = 0;
    for (std::size_t i = from; i < text.size(); ++i) {
      if (quote != 0) {
        if (text[i] == quote) quote = 0;
      } else if (text[i] == sign) {
        return i;
      } else if (text[i] == '"' || text[i] == '\'') {
        quote = text[i];
      }
    }
    return text.size();
  }

  bool read_line() {
    text_.clear();
    at_ = 0;
    line_ = lines_.number() + 1;
    bool goes_on = true, any = false;
    while (goes_on && lines_.next()) {
      any = true;
      const std::string_view line = lines_.text();
      const std::string_view code = trimmed(line.substr(0, outside_quotes(line, 0, '!')));
      goes_on = code.ends_with('&');
      text_ += goes_on ? code.substr(0, code.size() - 1) : code;
      text_ += ' ';
    }
    return any;
  }

  Lines lines_;
  std::string text_;
  std::string_view statement_;
  std::size_t at_ = 0;
  int line_ = 0;
};

}  // namespace petzval::formats_detail
