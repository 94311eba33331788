// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace petzval::formats_detail {

/// The text of a file, converted to UTF-8. The file may be UTF-16, with a byte order mark or with many zero bytes, or
/// UTF-8 with or without a mark; all other files are read as Latin-1.
/// @param rule the required kind of file, for messages
/// @throws Error if the file cannot be read or is not text; names the kind of a known binary file (zip, PNG, EXR, ...)
std::string read_as_utf8(const std::filesystem::path& file, const std::string& rule);

/// The text of bytes in memory, converted like a file.
std::string as_utf8(std::string bytes, const std::string& where, const std::string& rule);

/// The lines of a text, one after the other. Lines end with LF, CR LF or CR.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// Moves to the next line; false at the end of the text.
  bool next();
  int number() const noexcept { return number_; }           ///< number of the line, from 1
  std::string_view text() const noexcept { return line_; }  ///< without the line end

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// The words of a line, separated by blanks and tabs, at most `most`; the rest of the line is ignored.
/// Quoted text ('...' or "...") is one word without the quotes; the last quote may be missing.
std::vector<std::string_view> words(std::string_view line, std::size_t most = 4096);

/// The text without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// The number in a word; nullopt if the whole word is not a finite number. A leading + and exponents of FORTRAN
/// (1.0D+10) are allowed, decimal commas are not allowed.
std::optional<double> number(std::string_view word);

/// True for "inf", "Infinity", "infinite" and the infinity sign, in any case, with or without a sign.
bool is_infinite(std::string_view word) noexcept;

char lower(char c) noexcept;
std::string lower(std::string_view text);
std::string upper(std::string_view text);
bool same(std::string_view a, std::string_view b) noexcept;  ///< ignores the case of ASCII letters

/// The entry of a list, separated by single blanks, that is the `same` as a word; empty if absent.
std::string_view entry_of(std::string_view list, std::string_view word) noexcept;
inline bool is_one_of(std::string_view word, std::string_view list) noexcept { return !entry_of(list, word).empty(); }

/// Appends a text, after a separator unless it is the first.
void append(std::string& texts, std::string_view separator, std::string_view text);

/// The text as one word: blanks, quotes and control characters, which some formats forbid in names, become underscores.
std::string one_word(std::string_view text);

}  // namespace petzval::formats_detail
