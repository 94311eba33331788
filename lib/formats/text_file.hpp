// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace petzval::formats_detail {

/// The text of a file as UTF-8, whatever it was: UTF-16 with a byte order mark or recognised by its zero bytes, UTF-8
/// with or without a mark, else Latin-1. Throws Error for a file that cannot be read and for one that is no text: it
/// names what it is (zip, PNG, EXR, ...) where the first bytes tell. wanted: its kind, for messages.
std::string read_as_utf8(const std::filesystem::path& file, const std::string& wanted);

/// The same of bytes in memory.
std::string as_utf8(std::string bytes, const std::string& where, const std::string& wanted);

/// The lines of a text, one after the other. Line ends are LF, CR LF and CR.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// The next line; false at the end of the text.
  bool next();
  int number() const noexcept { return number_; }           ///< of the line, from 1
  std::string_view text() const noexcept { return line_; }  ///< without its end

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// The words of a line, separated by blanks and tabs. Quoted ones ('...' or "...") are one word without the quotes; the
/// last quote may be missing. At most `most` words: the rest of the line is left out.
std::vector<std::string_view> words(std::string_view line, std::size_t most = 4096);

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// The whole word as a number; nothing if it is none, or not finite. A leading + and FORTRAN's
/// exponents (1.0D+10) are allowed, a decimal comma is not.
std::optional<double> number(std::string_view word);

/// True for "inf", "Infinity", "infinite" and the sign of it, in any case, with or without a sign.
bool is_infinite(std::string_view word) noexcept;

char lower(char c) noexcept;
std::string lower(std::string_view text);
std::string upper(std::string_view text);
bool same(std::string_view a, std::string_view b) noexcept;  ///< but for the case of ASCII letters

/// The entry of a list, separated by single blanks, that is the `same` as a word; empty if there is no such entry.
std::string_view entry_of(std::string_view list, std::string_view word) noexcept;
inline bool is_one_of(std::string_view word, std::string_view list) noexcept { return !entry_of(list, word).empty(); }

/// Adds a text to others, behind a separator unless it is the first.
void append(std::string& texts, std::string_view separator, std::string_view text);

/// The text on one line that every reader takes: control characters, line breaks among them, become blanks.
std::string one_line(std::string text);

/// Characters that some formats cannot have in a name: blanks, quotes and control characters become underscores.
std::string one_word(std::string_view text);

}  // namespace petzval::formats_detail
