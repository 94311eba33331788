// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli.hpp"

namespace examples {

/// A column of numbers and their range.
struct CsvColumn {
  const char* name;
  Range range = finite_number;
};

/// Reads a header with the names of the columns and one line of numbers per row (LF or CRLF; a byte-order mark and
/// blank lines at the end are skipped). Returns the columns.
/// @throws petzval::Error that names `where`, the line (from 1) and the column
std::vector<std::vector<double>> parse_columns(std::string_view csv, std::span<const CsvColumn> columns,
                                               const std::string& where);

/// "in.csv: line 2" for row 0; the header is line 1.
std::string line_of_row(const std::string& where, std::size_t row);

/// A number with 17 significant digits, enough to read back to the same double.
std::string digits17(double value);

}  // namespace examples
