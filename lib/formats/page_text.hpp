// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace petzval::formats_detail {

/// A word, a number or an equals sign of a printed page. Text in brackets is a single word: "(aperture stop)".
struct PageToken {
  std::string text;  ///< a number has the form of number(): "1.23E - 05", "1.23x10-5" and "1.23-5" become "1.23e-05"
  bool is_number = false;
};

/// A line of a printed page.
struct PageLine {
  int number = 0;
  std::string
      text;  ///< in ASCII where a sign has an ASCII form, "inf" for the infinity sign, a blank for the degree sign
  std::vector<PageToken> tokens;

  bool has_words_only() const;               ///< true if no token is a number or an equals sign
  std::size_t numbers() const;               ///< tokens that are numbers, or are meant to be: "1O.5"
  std::string said() const;                  ///< the start of the line in quotes, for messages
  bool says(std::string_view any_of) const;  ///< true if the line has one of these words, in any case
};

/// The lines of a page that have tokens. Decimal commas are taken if few numbers have points.
std::vector<PageLine> page_lines(std::string_view text);

/// The tokens of a text.
std::vector<PageToken> tokens_of(std::string_view text, bool decimal_commas);

/// The number of ASCII letters of a word.
std::size_t letters_in(std::string_view word);

/// True for a number, and for a word of digits and letters that are mistaken for digits (O, l, I): "1O.5".
bool is_meant_as_number(std::string_view word);

}  // namespace petzval::formats_detail
