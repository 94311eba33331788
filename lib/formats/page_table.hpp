// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"
#include "page_text.hpp"
#include "table_columns.hpp"
#include "table_text.hpp"

namespace petzval::formats_detail {

/// A row of the table of surfaces on a page.
struct PageRow {
  int line = 0;
  std::optional<int> label{};
  std::string stop{};              ///< the word that marks the stop; empty if not marked
  bool asphere = false;            ///< true if marked as an asphere
  std::string variable{};          ///< name of the thickness in the table of positions: "d5"; empty if it does not vary
  std::vector<PageToken> cells{};  ///< behind the label, without marks; one per column once completed
};

/// The columns of a head of surfaces: radius, thickness, and index or glass. Empty for other lines.
std::vector<TableColumn> surface_columns(const PageLine& line);

/// The name of a thickness in a table of positions: "D5", "d 5", "(d5)", "DD[5]" become "d5", "BF" becomes "Bf"; empty
/// for other words.
std::string variable_name(std::string_view word);

/// True if a line states the radius of a surface by name: "r1 = 52.1".
bool names_radius(const PageLine& line, int label);

/// True for the numbers of two columns of text at the top of a page: "23 24".
bool is_top(const PageLine& line);

/// The table of surfaces of a printed page: rows below a head, or "r1 = 52.1 d1 = 3.2 N1 = 1.65 v1 = 58".
class PageTable {
 public:
  /// Takes a head; the rows that follow have its columns.
  void set_head(const PageLine& line, std::vector<TableColumn> columns);
  /// Takes the next row below a head; false for other lines.
  bool take_row(const PageLine& line);
  /// Takes radii, thicknesses and indices with names; false if the line has no radius or thickness with a name.
  bool take_named(const PageLine& line);
  /// True for the row that follows the last one by its label.
  bool is_next(const PageLine& line) const;
  /// True for a line that is a row of the table, but does not follow its last row.
  bool is_other_row(const PageLine& line) const;

  /// True if rows lack cells or have distances that vary.
  bool is_printed() const;

  bool is_empty() const { return rows_.empty(); }
  const std::vector<TableColumn>& columns() const { return columns_; }
  const std::vector<PageRow>& rows() const { return rows_; }
  PageRow* find(int label);
  /// Distance of the object, stated by a row with the label 0.
  std::optional<double> object_distance() const { return object_distance_; }
  /// Fills the cells that air has not: an air row has neither index nor V-number.
  /// @throws Error for a row that has not the cells of the columns
  void complete(const Import& in);
  /// The rows as lines of a table, below a head. Air has the index 1, a thickness that varies is 0.
  std::vector<TableLine> lines() const;

 private:
  PageRow take_marks(const PageLine& line, std::size_t from) const;
  std::vector<PageToken> cells_of(const PageLine& line, std::size_t from) const;
  void name_gap(PageRow& row) const;
  bool take_pair(const std::string& word);
  std::optional<int> next_label() const;
  std::vector<PageToken> row_tokens(const PageLine& line) const;
  bool is_row_of_cells(const PageLine& line) const;
  bool fill(PageRow& row, std::vector<PageToken> cells, bool last) const;
  void complete(PageRow& row, bool last, const Import& in) const;
  std::size_t find(Column kind) const;

  std::vector<TableColumn> columns_;  ///< without the number of the row
  std::vector<PageRow> rows_;
  std::optional<double> object_distance_;
  int head_line_ = 0;
  int apart_line_ = 0;  ///< line of an index that is not with its radius; 0 if absent
  bool labelled_ = false, named_ = false;
  bool counted_ = false;  ///< true if the head has a column of labels
  char separator_ = ' ';
};

}  // namespace petzval::formats_detail
