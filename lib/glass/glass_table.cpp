// SPDX-License-Identifier: Apache-2.0
#include "glass_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include "formulas.hpp"
#include "petzval/core/error.hpp"

namespace petzval::glass_detail {
namespace {

constexpr std::size_t columns = 9;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t from = 0;;) {
    const std::size_t to = text.find(separator, from);
    parts.push_back(text.substr(from, to - from));
    if (to == std::string_view::npos) return parts;
    from = to + 1;
  }
}

double parse_number(std::string_view text, const std::string& where, const char* what) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw Error(where + ": " + what + " = \"" + std::string(text) + "\"; must be a finite number");
  }
  return value;
}

/// True if the wavelengths of a table increase and cover the range of the glass.
bool covers(const Glass& glass) {
  const auto& c = glass.coefficients;
  for (std::size_t i = 2; i < c.size(); i += 2) {
    if (!(c[i] > c[i - 2])) return false;
  }
  return c[0] > 0 && c[0] * 1000 <= glass.shortest_nm && c[c.size() - 2] * 1000 >= glass.longest_nm;
}

Glass parse_glass(std::string_view line, const std::string& where) {
  const auto cells = split(line, ',');
  if (cells.size() != columns) {
    throw Error(where + ": " + std::to_string(cells.size()) + " columns; must be " + std::to_string(columns) + ": " +
                std::string(glass_table_header));
  }
  Glass glass;
  glass.catalogue = cells[0];
  glass.name = cells[1];
  if (glass.catalogue.empty() || glass.name.empty()) throw Error(where + ": catalogue or name is empty; must not be");
  glass.nd = parse_number(cells[2], where, "nd");
  glass.vd = parse_number(cells[3], where, "vd");
  const auto form = std::find_if(formula_forms.begin(), formula_forms.end(),
                                 [&](const FormulaForm& f) { return f.name == cells[4]; });
  if (form == formula_forms.end()) {
    std::string known;
    for (const FormulaForm& f : formula_forms) known += (known.empty() ? "" : ", ") + std::string(f.name);
    throw Error(where + ": formula = \"" + std::string(cells[4]) + "\"; must be in: " + known);
  }
  glass.formula = form->formula;
  glass.shortest_nm = parse_number(cells[5], where, "wl_min_um") * 1000;
  glass.longest_nm = parse_number(cells[6], where, "wl_max_um") * 1000;
  for (const auto cell : split(cells[7], ' ')) glass.coefficients.push_back(parse_number(cell, where, "coefficient"));

  const auto count = glass.coefficients.size();
  if (!form->takes(count)) {
    throw Error(where + ": " + std::to_string(count) + " coefficients; must be " + std::string(form->rule));
  }
  if (glass.formula == DispersionFormula::tabulated && !covers(glass)) {
    throw Error(where + ": wavelengths of the table must increase and cover wl_min_um to wl_max_um");
  }
  if (!(glass.shortest_nm > 0 && glass.shortest_nm < glass.longest_nm)) {
    throw Error(where + ": range wl_min_um, wl_max_um = " + std::string(cells[5]) + ", " + std::string(cells[6]) +
                "; must be positive and increasing");
  }
  return glass;
}

}  // namespace

void read_glass_table(std::istream& stream, const std::string& where, std::vector<Glass>& glasses) {
  std::string line;
  for (std::size_t count = 1; std::getline(stream, line) || count == 1; ++count) {
    if (line.ends_with('\r')) line.pop_back();
    const std::string here = where + ": line " + std::to_string(count);
    if (count > 1) {
      glasses.push_back(parse_glass(line, here));
    } else if (line != glass_table_header) {
      throw Error(here + ": header = \"" + line.substr(0, 100) + "\"; must be " + std::string(glass_table_header));
    }
  }
  if (stream.bad()) throw Error(where + ": cannot be read to its end");
}

}  // namespace petzval::glass_detail
