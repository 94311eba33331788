// SPDX-License-Identifier: Apache-2.0
#include "number_csv.hpp"

#include <algorithm>

#include "petzval/core/error.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// Removes and returns the first line of the text. The last line may lack its end.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string header_of(std::span<const CsvColumn> columns) {
  std::string header;
  for (const CsvColumn& column : columns) header += (header.empty() ? "" : ",") + std::string(column.name);
  return header;
}

}  // namespace

std::vector<std::vector<double>> parse_columns(std::string_view csv, std::span<const CsvColumn> columns,
                                               const std::string& where) {
  const std::string header = header_of(columns);
  if (csv.starts_with("\xEF\xBB\xBF")) csv.remove_prefix(3);
  if (const auto first = next_line(csv); first != header) {
    throw petzval::Error(where + ": line 1 = \"" + std::string(first.substr(0, 60)) + "\"; must be \"" + header + "\"");
  }
  // Editors and spreadsheets leave empty lines after the last row.
  csv = csv.substr(0, csv.find_last_not_of(" \t\r\n") + 1);
  std::vector<std::vector<double>> result(columns.size());
  for (std::size_t row = 0; !csv.empty(); ++row) {
    std::string_view line = next_line(csv);
    const std::string here = line_of_row(where, row);
    const std::size_t found =
        line.empty() ? 0 : static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (found != columns.size()) {
      throw petzval::Error(here + ": has " + std::to_string(found) + " values; must have " +
                           std::to_string(columns.size()) + ": " + header);
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::size_t end = std::min(line.find(','), line.size());
      result[i].push_back(
          parse_number(here + ", column " + columns[i].name, trimmed(line.substr(0, end)), columns[i].range));
      line.remove_prefix(std::min(end + 1, line.size()));
    }
  }
  return result;
}

std::string line_of_row(const std::string& where, std::size_t row) {
  return where + ": line " + std::to_string(row + 2);
}

std::string digits17(double value) { return number(value, 17); }

}  // namespace examples
