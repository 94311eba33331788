// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "table_text.hpp"

namespace petzval::formats_detail {

/// The meaning of a column.
enum class Column {
  left_out,
  number,  ///< number of the row
  radius,
  curvature,
  thickness,
  gap_before,
  index,
  abbe,
  glass,
  catalogue,
  semi_diameter,
  diameter,
  aperture,  ///< a diameter or a semi-diameter
  conic,
  term,
  stop,
  comment,
};

struct TableColumn {
  Column kind = Column::left_out;
  std::string name;      ///< the head, for messages
  int order = 0;         ///< order of an aspheric term
  double unit_mm = 1;    ///< unit of lengths
  double of_sphere = 0;  ///< number of a sphere in a column of conics: 1 for kappa, which is 1 + k
};

/// The column of a head, in any case, with a unit in brackets: "R", "Radius (mm)", "nd", "A4". nullopt if unknown.
std::optional<TableColumn> column_of(std::string_view head);

/// The columns named by the cells of a line; unknown heads become Column::left_out.
/// @param by_blanks true if blanks separate cells, so that a head may have several cells: "semi diameter"
std::vector<TableColumn> columns_of(std::span<const std::string_view> cells, bool by_blanks);

/// True if a line names columns: it has at least two known heads, and fewer numbers.
bool is_head(std::span<const std::string_view> cells, bool by_blanks);

/// The unit in mm named by a cell below the heads; nullopt if the cell is not a unit.
std::optional<double> unit_of(std::string_view cell);

/// The columns of rows without heads.
struct GuessedColumns {
  std::vector<TableColumn> columns;  ///< empty if the rows are ambiguous
  std::string reason;                ///< reason if `columns` is empty
};

/// Guesses the columns of rows without heads: radius, thickness, then index, V-number, glass and aperture by their
/// values. Rows may be short.
/// @param is_index_of true if a glass of this name has about this index
GuessedColumns guess_columns(std::span<const std::vector<std::string_view>> rows,
                             const std::function<bool(std::string_view, double)>& is_index_of);

}  // namespace petzval::formats_detail
