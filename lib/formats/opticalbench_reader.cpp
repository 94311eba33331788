// SPDX-License-Identifier: Apache-2.0
// The tables of Photons to Photos: sections of lines whose cells are separated by tabs. Each column of [variable
// distances] is one position of the lens. Sources of the form: the documentation of Beam42's LensTool2, and the grammar
// printed by the lens editor of the same tables.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "positions.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

constexpr std::size_t most_columns = 1000;

/// The cells of a line without the empty cells at its end; at most one more cell than allowed. A comment after "//"
/// ends the line, unless "//" is part of a word ("https://...").
std::vector<std::string_view> cells_of(std::string_view line) {
  for (std::size_t at = line.find("//"); at != std::string_view::npos; at = line.find("//", at + 1)) {
    if (at > 0 && line[at - 1] != ' ' && line[at - 1] != '\t') continue;
    line = line.substr(0, at);
    break;
  }
  std::vector<std::string_view> cells;
  for (std::size_t from = 0; cells.size() <= most_columns + 1;) {
    const std::size_t to = line.find('\t', from);
    cells.push_back(trimmed(line.substr(from, to == std::string_view::npos ? to : to - from)));
    if (to == std::string_view::npos) {
      while (!cells.empty() && cells.back().empty()) cells.pop_back();
      return cells;
    }
    from = to + 1;
  }
  return cells;
}

class OpticalBenchReader {
 public:
  explicit OpticalBenchReader(Import& in) : in_(in), positions_(in) {}
  void read(std::string_view text);

 private:
  using Cells = std::vector<std::string_view>;

  void take(int line, const Cells& cells);
  void take_surface(int line, const Cells& cells);
  void take_asphere(int line, const Cells& cells);
  void take_report(const Cells& cells);
  void note(const Cells& cells);
  Length length(int line, const char* what, std::string_view cell);
  int odd_count() const;

  Import& in_;
  std::string section_;
  std::map<std::string, std::pair<int, std::string>> constants_;
  std::map<std::string, std::size_t> row_of_;  ///< row index by the name in the first column
  std::set<std::size_t> aspheres_;
  std::vector<std::string> scenarios_, names_;
  Positions positions_;
};

void OpticalBenchReader::read(std::string_view text) {
  for (Lines lines(text); lines.next();) {
    const std::string_view line = lines.text();
    const std::string_view start = trimmed(line);
    if (start.empty() || start.starts_with('#') || start.starts_with("//")) continue;
    if (start.starts_with('[')) {
      section_ = lower(start.substr(1, start.find(']') == std::string_view::npos ? start.npos : start.find(']') - 1));
      continue;
    }
    const auto cells = cells_of(line);
    if (cells.size() > most_columns + 1) {
      in_.refuse(lines.number(), "line", "more than " + std::to_string(most_columns + 1) + " columns", "fewer");
    }
    take(lines.number(), cells);
  }
  if (positions_.rows.empty()) throw Error(in_.where() + ": no rows of [lens data]; must be at least one surface");
  for (std::size_t i = 0; scenarios_.size() == names_.size() && i < names_.size(); ++i) {
    positions_.names.emplace(scenarios_[i], names_[i]);
  }
  positions_.apply();
  in_.requests.nominal_aperture = true;
  in_.lens.semi_diameters = "half of the table's diameters";
}

void OpticalBenchReader::take(int line, const Cells& cells) {
  if (section_ == "lens data") return take_surface(line, cells);
  if (section_ == "aspherical data") return take_asphere(line, cells);
  if (section_ == "report data") return take_report(cells);
  if (section_ == "descriptive data" || section_ == "notes" || section_ == "patent info") return note(cells);
  if (section_ == "variable distances") {
    Variable& variable = positions_.variables[std::string(cells[0])];
    if (variable.line > 0) in_.refuse(line, cells[0], "a second row", "a single row");
    variable.line = line;
    variable.values.assign(cells.begin() + 1, cells.end());
  } else if (section_ == "constants") {
    constants_[std::string(cells[0])] = {line, cells.size() > 1 ? std::string(cells[1]) : std::string()};
    if (cells[0] != "AsphericalOddCount" && cells[0] != "AsphericalA2") {
      in_.warn(line, cells[0], "an unknown constant is left out");
    }
  }
}

void OpticalBenchReader::note(const Cells& cells) {
  std::string text;
  for (const auto cell : cells) append(text, " ", beginning(cell, 4096));
  if (cells[0] == "title" && section_ == "descriptive data") {
    in_.lens.imported->title = text.size() > 6 ? text.substr(6) : std::string();
  } else {
    in_.note(text);
  }
}

void OpticalBenchReader::take_report(const Cells& cells) {
  if (cells[0] == "scenarios") scenarios_.assign(cells.begin() + 1, cells.end());
  if (cells[0] == "names") names_.assign(cells.begin() + 1, cells.end());
}

Length OpticalBenchReader::length(int line, const char* what, std::string_view cell) {
  if (cell.empty()) return {};
  if (const auto named = positions_.variables.find(cell); named != positions_.variables.end()) {
    named->second.used = true;
    return {{}, &named->second};
  }
  const bool is_name = (cell[0] >= 'a' && cell[0] <= 'z') || (cell[0] >= 'A' && cell[0] <= 'Z');
  if (is_name && cell != "Infinity" && cell != "NaN" && cell != "nan" && cell != "inf") {
    in_.refuse(line, what, "\"" + std::string(beginning(cell, 60)) + "\"", "a number or a row of [variable distances]");
  }
  return {in_.number(line, what, cell), nullptr};
}

void OpticalBenchReader::take_surface(int line, const Cells& cells) {
  const auto cell = [&](std::size_t i) { return i < cells.size() ? cells[i] : std::string_view(); };
  if (cells.size() < 3) {
    in_.refuse(line, "row", std::to_string(cells.size()) + " columns",
               "a name, radius, thickness, index, diameter and V-number, separated by tabs");
  }
  in_.limit(positions_.rows.size() + 1);
  SurfaceRow surface;
  const std::string_view radius = cell(1);
  if (radius == "AS") {
    surface.stop = std::ranges::none_of(in_.lens.surfaces, [](const SurfaceRow& s) { return s.stop; });
    if (!surface.stop) in_.warn(line, "AS", "a second aperture stop only limits rays; the first is the stop");
  } else if (radius == "FS") {
    surface.comment = "field stop";
  } else if (radius == "CG") {
    surface.comment = "cover glass";
  } else if (!is_infinite(radius)) {
    surface.radius = in_.number(line, "radius", radius);
  }
  std::optional<double> nd, vd;
  if (!cell(3).empty()) nd = in_.number(line, "index", cell(3));
  if (!cell(5).empty()) vd = in_.number(line, "V-number", cell(5));
  if (nd && *nd < 0) in_.refuse(line, "index", to_text(*nd), "positive; these tables have no mirrors");
  if (nd && *nd == 0) nd.reset();
  if (vd && *vd <= 0) vd.reset();
  if (!cell(6).empty()) {
    const std::vector<std::string> catalogues(cell(7).empty() ? 0 : 1, std::string(cell(7)));
    surface.medium = in_.glass(line, cell(6), catalogues, nd, vd);
  } else if (nd && *nd != 1) {
    surface.medium = {.nd = *nd, .vd = vd};
  }
  std::string id(cell(0));
  if (!row_of_.emplace(id, positions_.rows.size()).second)
    in_.refuse(line, "row", "name " + id + " of an earlier row", "a unique name");
  positions_.rows.push_back({line, length(line, "thickness", cell(2)), length(line, "diameter", cell(4))});
  in_.lens.surfaces.push_back(std::move(surface));
}

/// Number of odd powers, from the third power on, between the even powers.
int OpticalBenchReader::odd_count() const {
  const auto found = constants_.find("AsphericalOddCount");
  if (found == constants_.end()) return 0;
  const auto& [line, text] = found->second;
  const double count = in_.number(line, "AsphericalOddCount", text);
  if (!(count >= 0 && count <= 20 && count == std::floor(count))) {
    in_.refuse(line, "AsphericalOddCount", text, "a whole number from 0 to 20");
  }
  return static_cast<int>(count);
}

void OpticalBenchReader::take_asphere(int line, const Cells& cells) {
  const auto named = row_of_.find(std::string(cells[0]));
  if (named == row_of_.end()) {
    in_.refuse(line, "asphere", "surface \"" + std::string(beginning(cells[0], 60)) + "\"", "a surface of [lens data]");
  }
  if (cells.size() < 3)
    in_.refuse(line, "asphere", std::to_string(cells.size()) + " columns", "name, radius and conic");
  if (!aspheres_.insert(named->second).second) in_.refuse(line, "asphere", "a second row", "a single row");
  SurfaceRow& surface = in_.lens.surfaces[named->second];
  const double radius = is_infinite(cells[1]) ? 0 : in_.number(line, "radius", cells[1]);
  if (std::abs(radius - surface.radius) > 1e-3 * std::abs(surface.radius)) {
    in_.warn(line, cells[0],
             "its asphere has a radius of " + to_text(radius) + ", [lens data] states " + to_text(surface.radius) +
                 ", which is taken");
  }
  surface.conic = cells[2].empty() ? 0 : in_.number(line, "conic", cells[2]);
  const int odd = odd_count();
  int order = odd > 0 ? 3 : constants_.contains("AsphericalA2") ? 2 : 4;
  for (std::size_t i = 3; i < cells.size(); ++i) {
    const double coefficient = cells[i].empty() ? 0 : in_.number(line, "coefficient", cells[i]);
    if (coefficient != 0) {
      if (order > 40) in_.refuse(line, "coefficient", "order " + std::to_string(order), "at most 40");
      surface.aspheric.push_back({order, coefficient});
    }
    order += order < 2 * odd + 2 ? 1 : 2;
  }
}

}  // namespace

bool is_opticalbench(std::string_view text) {
  for (Lines lines(text); lines.next() && lines.number() <= 10'000;) {
    // Patents print the same title above a head of columns.
    if (lower(trimmed(lines.text().substr(0, 64))).starts_with("[lens data]")) return !is_page(text);
  }
  return false;
}

void read_opticalbench(std::string_view text, Import& in) { OpticalBenchReader(in).read(text); }

}  // namespace petzval::formats_detail
