// SPDX-License-Identifier: Apache-2.0
#include "text_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval::formats_detail {
namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&text](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | code >> 6), put(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
  } else {
    put(0xF0 | code >> 18), put(0x80 | (code >> 12 & 0x3F)), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
  }
}

/// Converts UTF-16; an unpaired surrogate becomes the replacement character.
std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2 + bytes.size() / 16);
  const auto unit = [&](std::size_t i) -> std::uint32_t {
    const auto a = static_cast<unsigned char>(bytes[i]), b = static_cast<unsigned char>(bytes[i + 1]);
    return big_endian ? a * 256u + b : b * 256u + a;
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const std::uint32_t first = unit(i);
    if (first < 0xD800 || first > 0xDFFF) {
      append_utf8(text, first);
      continue;
    }
    const std::uint32_t second = first < 0xDC00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
    const bool pair = second >= 0xDC00 && second <= 0xDFFF;
    append_utf8(text, pair ? 0x10000 + ((first - 0xD800) << 10) + (second - 0xDC00) : 0xFFFD);
    if (pair) i += 2;
  }
  return text;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

std::string from_latin1(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 16);
  for (const char c : bytes) append_utf8(text, static_cast<unsigned char>(c));
  return text;
}

/// The kind of a binary file by its first bytes; empty if not known.
std::string_view kind_of(std::string_view bytes) {
  using namespace std::string_view_literals;
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kinds = {{
      {"PK\x03\x04"sv, "a zip archive (.zip, .zos or .zar)"sv},
      {"PK\x05\x06"sv, "an empty zip archive"sv},
      {"\x89PNG"sv, "a PNG picture"sv},
      {"\x76\x2f\x31\x01"sv, "an OpenEXR picture"sv},
      {"\xff\xd8\xff"sv, "a JPEG picture"sv},
      {"%PDF"sv, "a PDF"sv},
      {"\x1f\x8b"sv, "a gzip archive"sv},
      {"\xD0\xCF\x11\xE0"sv, "an Office document"sv},
  }};
  for (const auto& [mark, kind] : kinds) {
    if (bytes.starts_with(mark)) return kind;
  }
  return {};
}

}  // namespace

std::string as_utf8(std::string bytes, const std::string& where, const std::string& rule) {
  if (const auto kind = kind_of(bytes); !kind.empty()) {
    throw Error(where + ": is " + std::string(kind) + "; must be " + rule);
  }
  if (bytes.starts_with("\xFF\xFE")) return from_utf16(std::string_view(bytes).substr(2), false);
  if (bytes.starts_with("\xFE\xFF")) return from_utf16(std::string_view(bytes).substr(2), true);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);

  // In UTF-16 text of Latin letters, every second byte is zero, and no other byte is.
  const std::size_t looked_at = std::min<std::size_t>(bytes.size() & ~std::size_t{1}, 4096);
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < looked_at; ++i) zeros[i % 2] += bytes[i] == '\0';
  if (zeros[0] + zeros[1] > 0 && looked_at >= 16) {
    const bool big = zeros[0] > zeros[1];
    if (zeros[big ? 0 : 1] * 4 >= looked_at && zeros[big ? 1 : 0] * 16 <= looked_at) return from_utf16(bytes, big);
  }
  if (bytes.find('\0') != std::string::npos) {
    throw Error(where + ": byte " + std::to_string(bytes.find('\0')) + " = 0, so the file is not text; must be " +
                rule);
  }
  return is_utf8(bytes) ? std::move(bytes) : from_latin1(bytes);
}

std::string read_as_utf8(const std::filesystem::path& file, const std::string& rule) {
  return as_utf8(read_file(file, rule), file.string(), rule);
}

bool Lines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find_first_of("\r\n");
  line_ = rest_.substr(0, end);
  ++number_;
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    rest_.remove_prefix(end + (rest_.substr(end, 2) == "\r\n" ? 2 : 1));
  }
  return true;
}

std::vector<std::string_view> words(std::string_view line, std::size_t most) {
  constexpr std::string_view blanks = " \t";
  std::vector<std::string_view> result;
  while (result.size() < most) {
    const std::size_t start = line.find_first_not_of(blanks);
    if (start == std::string_view::npos) break;
    line.remove_prefix(start);
    const char quote = line[0];
    if (quote == '"' || quote == '\'') {
      const std::size_t end = line.find(quote, 1);
      result.push_back(line.substr(1, end == std::string_view::npos ? end : end - 1));
      line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
    } else {
      const std::size_t end = std::min(line.find_first_of(blanks), line.size());
      result.push_back(line.substr(0, end));
      line.remove_prefix(end);
    }
  }
  return result;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t");
  return start == std::string_view::npos ? std::string_view()
                                         : text.substr(start, text.find_last_not_of(" \t") - start + 1);
}

std::optional<double> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  // Exponents of FORTRAN: 1.0D+10.
  std::string with_e;
  if (const std::size_t d = word.find_first_of("dD"); d != std::string_view::npos && d > 0 && word.size() < 64) {
    with_e = word;
    with_e[d] = 'e';
    word = with_e;
  }
  double value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

bool is_infinite(std::string_view word) noexcept {
  if (word.starts_with('+') || word.starts_with('-')) word.remove_prefix(1);
  return is_one_of(word, "inf inf. infinity infinite \u221e");
}

char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = lower(c);
  return result;
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return result;
}

bool same(std::string_view a, std::string_view b) noexcept {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::string_view entry_of(std::string_view list, std::string_view word) noexcept {
  while (!list.empty()) {
    const std::string_view entry = list.substr(0, list.find(' '));
    if (same(entry, word)) return entry;
    list.remove_prefix(std::min(entry.size() + 1, list.size()));
  }
  return {};
}

void append(std::string& texts, std::string_view separator, std::string_view text) {
  if (!texts.empty()) texts += separator;
  texts += text;
}

std::string one_word(std::string_view text) {
  std::string result = one_line(std::string(text));
  for (char& c : result) {
    if (c == ' ' || c == '"' || c == '\'') c = '_';
  }
  return result;
}

}  // namespace petzval::formats_detail
