// SPDX-License-Identifier: Apache-2.0
#include "page_text.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// Signs of printed pages and their form in ASCII. Superscripts follow a "^". The Patent Office writes signs as words
/// between points.
constexpr std::pair<std::string_view, std::string_view> signs[] = {
    {"\u00b0", " "},
    {"\u2212", "-"},
    {"\u2010", "-"},
    {"\u2011", "-"},
    {"\u2013", "-"},
    {"\u2014", "-"},
    {"\uff0d", "-"},
    {"\u00a0", " "},
    {"\u2002", " "},
    {"\u2003", " "},
    {"\u2007", " "},
    {"\u2009", " "},
    {"\u202f", " "},
    {"\u3000", " "},
    {"\u221e", "inf"},
    {"\u00d7", "x"},
    {"\u00b7", "x"},
    {"\u2032", "'"},
    {"\u2019", "'"},
    {"\uff1d", "="},
    {"\uff5e", " "},
    {"\u301c", " "},
    {"\u2026", " "},
    {"\u2190", " "},
    {"\uff0a", "*"},
    {"\u2217", "*"},
    {"\u207b", "^-"},
    {"\u2070", "^0"},
    {"\u00b9", "^1"},
    {"\u00b2", "^2"},
    {"\u00b3", "^3"},
    {"\u2074", "^4"},
    {"\u2075", "^5"},
    {"\u2076", "^6"},
    {"\u2077", "^7"},
    {"\u2078", "^8"},
    {"\u2079", "^9"},
    {"\u2080", "0"},
    {"\u2081", "1"},
    {"\u2082", "2"},
    {"\u2083", "3"},
    {"\u2084", "4"},
    {"\u2085", "5"},
    {"\u2086", "6"},
    {"\u2087", "7"},
    {"\u2088", "8"},
    {"\u2089", "9"},
    {"<sup>", "^"},
    {"</sup>", ""},
    {"<sub>", ""},
    {"</sub>", ""},
    {"^{", "^"},
    {"_{", ""},
    {"}", ""},
    {".sub.", ""},
    {".sup.", "^"},
    {".infin.", "inf"},
    {".nu.", "\u03bd"},
    {".omega.", "\u03c9"},
    {".kappa.", "\u03ba"},
    {".beta.", "\u03b2"},
    {".theta.", "\u03b8"},
    {".degree.", " "},
    {".times.", "x"},
    {".about.", " "},
    {"~", " "},
};

std::string in_ascii(std::string_view line) {
  std::string result;
  for (std::size_t i = 0; i < line.size();) {
    const bool ascii = static_cast<unsigned char>(line[i]) < 0x80 &&
                       std::string_view("<^_}.~").find(line[i]) == std::string_view::npos;
    const auto sign =
        ascii ? std::end(signs)
              : std::ranges::find_if(signs, [&](const auto& s) { return line.substr(i).starts_with(s.first); });
    if (sign != std::end(signs)) {
      const bool again = sign->second.size() > 1 && sign->second[0] == '^' && i > 0 &&
                         result.find('^') != result.npos &&
                         result.find_first_not_of("0123456789-", result.rfind('^') + 1) == result.npos;
      result += again ? sign->second.substr(1) : sign->second;
      i += sign->first.size();
    } else {
      result += line[i];
      ++i;
    }
  }
  return result;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads a number at the start of a text.
class NumberScan {
 public:
  NumberScan(std::string_view text, bool commas) : text_(text), commas_(commas) {}

  /// The number in the form of number(); empty if the text does not begin with a number. Moves behind it.
  std::string scan() {
    std::string result;
    if (at() == '+' || at() == '-') result += take();
    std::size_t digits = 0, decimals = 0;
    bool point = false;
    for (; is_digit(at()) || (!point && (at() == '.' || (commas_ && at() == ','))); ++i_) {
      digits += is_digit(at());
      decimals += point;
      point = point || !is_digit(at());
      result += is_digit(at()) ? at() : '.';
    }
    if (digits == 0) return {};
    const std::size_t end = i_;
    if (const std::string power = exponent(decimals >= 4); !power.empty()) {
      result += 'e' + power;
    } else {
      i_ = end;
    }
    return ends() ? result : std::string();
  }
  std::size_t length() const { return i_; }

 private:
  char at() const { return i_ < text_.size() ? text_[i_] : '\0'; }
  char take() { return text_[i_++]; }
  void blanks() {
    while (at() == ' ') ++i_;
  }
  bool ends() const {
    const char next = i_ + 1 < text_.size() ? text_[i_ + 1] : ' ';
    return at() == '\0' || std::string_view(" \t|=").find(at()) != std::string_view::npos ||
           ((at() == ',' || at() == ';') && next == ' ');
  }
  std::string signed_digits() {
    std::string result;
    if (at() == '+' || at() == '-') result += take();
    blanks();
    while (is_digit(at())) result += take();
    return result.empty() || !is_digit(result.back()) ? std::string() : result;
  }
  /// "E-05", "E - 05", "x10-5", "* 10^-5", and "-5" behind a number with four decimals ("24.7-35" is a range).
  std::string exponent(bool may_lack_letter) {
    if ((at() == '-' || at() == '+') && may_lack_letter) return signed_digits();
    const std::size_t start = i_;
    blanks();
    const bool apart = i_ > start;
    const char c = lower(at());
    if (c == 'e' || c == 'd') {
      ++i_;
      const std::size_t behind = i_;
      blanks();
      if ((apart || i_ > behind) && at() != '-' && at() != '+') return {};
      return signed_digits();
    }
    if (c != 'x' && c != '*' && c != '.') return {};
    ++i_;
    blanks();
    if (text_.substr(i_, 2) != "10") return {};
    i_ += 2;
    blanks();
    if (at() == '^') ++i_;
    return signed_digits();
  }

  std::string_view text_;
  bool commas_;
  std::size_t i_ = 0;
};

}  // namespace

std::size_t letters_in(std::string_view word) {
  return static_cast<std::size_t>(
      std::ranges::count_if(word, [](char c) { return lower(c) >= 'a' && lower(c) <= 'z'; }));
}

bool is_meant_as_number(std::string_view word) {
  return std::ranges::any_of(word, is_digit) && word.find_first_not_of("0123456789.,+-OolI") == std::string_view::npos;
}

std::vector<PageToken> tokens_of(std::string_view text, bool decimal_commas) {
  std::vector<PageToken> tokens;
  for (std::size_t i = 0; i < text.size();) {
    if (std::string_view(" \t|").find(text[i]) != std::string_view::npos) {
      ++i;
      continue;
    }
    if (text[i] == '=' || (text[i] == ':' && (i + 1 == text.size() || text[i + 1] == ' '))) {
      tokens.push_back({"="});
      ++i;
      // "R1 = + 42.97".
      const std::size_t sign = text.find_first_not_of(' ', i);
      if (sign >= text.size() || (text[sign] != '+' && text[sign] != '-')) continue;
      const std::size_t digit = text.find_first_not_of(' ', sign + 1);
      if (digit >= text.size() || digit == sign + 1 || !is_digit(text[digit])) continue;
      NumberScan scan(text.substr(digit), decimal_commas);
      const std::string number = scan.scan();
      if (number.empty()) continue;
      tokens.push_back({(text[sign] == '-' ? "-" : "") + number, true});
      i = digit + scan.length();
      continue;
    }
    NumberScan scan(text.substr(i), decimal_commas);
    if (std::string number = scan.scan(); !number.empty()) {
      tokens.push_back({std::move(number), true});
      i += scan.length();
      if (i < text.size() && (text[i] == ',' || text[i] == ';')) ++i;
      continue;
    }
    std::size_t end = std::min(text.find_first_of(" \t=|", i), text.size());
    const std::size_t bracket = text.substr(i, end - i).find('(');
    if (const std::size_t close = text.find(')', i);
        bracket != std::string_view::npos && close != std::string_view::npos) {
      end = std::max(end, std::min(text.find_first_of(" \t=|", close), text.size()));
    }
    std::string_view word = text.substr(i, end - i);
    i = end;
    if (word.size() > 2 && word.starts_with('[') && word.ends_with(']') && number(word.substr(1, word.size() - 2))) {
      tokens.push_back({std::string(word.substr(1, word.size() - 2)), true});  // "[34.3]"
      continue;
    }
    if (word.size() > 1 && (word.ends_with(',') || word.ends_with(';'))) word.remove_suffix(1);
    // "K:" before a value.
    if (word.size() > 1 && word.ends_with(':')) {
      tokens.push_back({std::string(word.substr(0, word.size() - 1))});
      tokens.push_back({"="});
    } else {
      tokens.push_back({std::string(word)});
    }
  }
  return tokens;
}

bool PageLine::has_words_only() const {
  return std::ranges::none_of(tokens, [](const PageToken& t) { return t.is_number || t.text == "="; });
}

std::size_t PageLine::numbers() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(tokens, [](const PageToken& t) { return t.is_number || is_meant_as_number(t.text); }));
}

std::string PageLine::said() const { return io_detail::in_quotes(beginning(text, 60)); }

bool PageLine::says(std::string_view any_of) const {
  const std::string all = lower(text);
  const auto listed = words(any_of);
  return std::ranges::any_of(listed, [&](std::string_view word) { return all.find(word) != std::string::npos; });
}

std::vector<PageLine> page_lines(std::string_view text) {
  std::vector<PageLine> lines;
  std::size_t points = 0, commas = 0;
  for (Lines all(text); all.next();) {
    if (trimmed(all.text()).empty()) continue;
    PageLine& line = lines.emplace_back(PageLine{all.number(), in_ascii(all.text()), {}});
    const std::string& s = line.text;
    for (std::size_t i = 1; i + 1 < s.size(); ++i) {
      if (!is_digit(s[i - 1]) || !is_digit(s[i + 1])) continue;
      points += s[i] == '.';
      commas += s[i] == ',';
    }
  }
  for (PageLine& line : lines) line.tokens = tokens_of(line.text, commas > 4 * points);
  std::erase_if(lines, [](const PageLine& line) { return line.tokens.empty(); });
  return lines;
}

}  // namespace petzval::formats_detail
