// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace petzval::formats_detail {

/// A line of a table that is not a comment.
struct TableLine {
  int number = 0;
  std::vector<std::string_view> cells;  ///< without blanks and quotes; at least one, and the last is not empty
  std::string_view remark;              ///< after a comment mark
};

/// A comment of a table, without its mark.
struct TableComment {
  int number = 0;
  std::string_view text;
};

/// The lines of a hand-typed table, as cells. Cells are separated by blanks, tabs, commas, semicolons or bars, the same
/// in the whole table. Typographic minus signs and blanks are replaced by ASCII.
class TableText {
 public:
  static constexpr std::size_t most_cells = 64;  ///< one more cell is kept, for the message

  explicit TableText(std::string_view text);
  /// Lines that are already divided into cells, which may be empty.
  explicit TableText(std::vector<TableLine> divided) : lines(std::move(divided)), separator_('\t') {}
  TableText(const TableText&) = delete;
  TableText& operator=(const TableText&) = delete;

  std::vector<TableLine> lines;
  std::vector<TableComment> comments;

  char separator() const noexcept { return separator_; }  ///< ' ', '\t', ',', ';' or '|'
  /// True if an empty cell is possible, because the separator is not a blank.
  bool has_empty_cells() const noexcept { return separator_ != ' '; }
  /// True if numbers have a decimal comma: cells are separated by semicolons, and no number has a point.
  bool has_decimal_commas() const noexcept { return decimal_commas_; }
  /// The cells of a text, with the separator of the table.
  std::vector<std::string_view> cells_of(std::string_view text) const;
  /// The number in a cell; nullopt if the cell is not a finite number.
  std::optional<double> number(std::string_view cell) const;

 private:
  std::string_view in_ascii(std::string_view line);
  void choose_separator(const std::vector<TableLine>& raw);

  std::deque<std::string> changed_lines_;
  char separator_ = ' ';
  bool bars_in_front_ = false;
  bool decimal_commas_ = false;
};

/// True if a cell is a number, or probably should be one: "1,5", "nan", "5x".
bool looks_like_a_number(std::string_view cell);
/// True for the words for the radius of a plane, with or without a sign: "inf", "Infinity", "plano", "flat", ...
bool is_plane_word(std::string_view cell);
/// True for the words that mark the aperture stop, and for "*".
bool is_stop_word(std::string_view cell);
/// True for the marks of aspheric surfaces: "(ASP)", "ASPH", "*". Without a row number, "ASP" and "*" of a plane mark
/// the stop.
bool is_asphere_mark(std::string_view cell);
/// The mark of the stop or of an asphere after the number of a row: "4(stop)", "4 STO", "4S", "4(ASP)"; empty if there
/// is no mark.
std::string_view mark_of(std::string_view label);
/// The number at the start of a row: "3", "S3", "3*", "*3)", "3.", "3(stop)"; nullopt for other text.
std::optional<int> label_of(std::string_view cell);
/// True for an empty cell and for "-", "--", "---", "none", "n/a" and ".".
bool is_none(std::string_view cell);

}  // namespace petzval::formats_detail
