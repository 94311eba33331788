// SPDX-License-Identifier: Apache-2.0
// The tables of Photons to Photos: sections of lines whose cells are separated by tabs. Each column of [variable
// distances] is one position of the lens. Sources of the form: the documentation of Beam42's LensTool2, and the grammar
// printed by the lens editor of the same tables.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

constexpr std::size_t most_columns = 100;

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

/// A row of [variable distances]: one value per position.
struct Variable {
  int line = 0;
  std::vector<std::string> values;
  bool used = false;
};

/// A length as a number or as the name of a variable; unknown if both are absent.
struct Length {
  std::optional<double> number;
  Variable* variable = nullptr;
};

/// A row of [lens data] with its lengths, which may vary.
struct Row {
  int line = 0;
  std::string id;
  Length thickness, diameter;
};

class OpticalBenchReader {
 public:
  explicit OpticalBenchReader(Import& in) : in_(in) {}
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
  void name_variables();

  std::optional<double> value(const Variable& variable, std::size_t column) const;
  std::optional<double> value(std::string_view name, std::size_t column) const;
  std::optional<double> value(const Length& length, std::size_t column) const;
  bool is_defined(std::size_t column) const;
  std::vector<std::size_t> defined_columns();
  void place(std::size_t column);
  void declare(std::size_t column);
  Configuration configuration(std::size_t column, std::size_t base);
  void configure(const std::vector<std::size_t>& columns);
  void place_film(const std::vector<std::size_t>& columns);

  Import& in_;
  std::string section_;
  std::map<std::string, Variable, std::less<>> variables_;
  std::map<std::string, std::pair<int, std::string>> constants_;
  std::vector<Row> rows_;
  std::map<std::string, std::size_t> row_of_;  ///< row index by the name in the first column
  std::set<std::size_t> aspheres_;
  std::vector<std::string> scenarios_, names_;
};

/// Names of rows that state a property of each position and not a distance of the lens.
constexpr std::array<std::string_view, 9> quantities = {
    "Focal Length", "F-Number", "Angle of View", "Image Height",      "Magnification",
    "NA",           "WD",       "Total Length",  "Aperture Diameter",
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
  if (rows_.empty()) throw Error(in_.where() + ": no rows of [lens data]; must be at least one surface");
  name_variables();
  const auto columns = defined_columns();
  place(columns.front());
  declare(columns.front());
  configure(columns);
  place_film(columns);
}

void OpticalBenchReader::take(int line, const Cells& cells) {
  if (section_ == "lens data") return take_surface(line, cells);
  if (section_ == "aspherical data") return take_asphere(line, cells);
  if (section_ == "report data") return take_report(cells);
  if (section_ == "descriptive data" || section_ == "notes" || section_ == "patent info") return note(cells);
  if (section_ == "variable distances") {
    Variable& variable = variables_[std::string(cells[0])];
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
  if (const auto named = variables_.find(cell); named != variables_.end()) {
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
  in_.limit(rows_.size() + 1);
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
  if (!row_of_.emplace(id, rows_.size()).second)
    in_.refuse(line, "row", "name " + id + " of an earlier row", "a unique name");
  rows_.push_back({line, std::move(id), length(line, "thickness", cell(2)), length(line, "diameter", cell(4))});
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

/// Warns of rows that no surface refers to and the format does not define.
void OpticalBenchReader::name_variables() {
  for (const auto& [name, variable] : variables_) {
    const bool known = variable.used || name == "d0" || name == "Bf" || std::ranges::count(quantities, name) > 0;
    if (!known) in_.warn(variable.line, name, "no surface has this distance; it is left out");
  }
}

/// The value of a row in a position; nullopt for "undefined" and empty cells. A single value holds for all positions.
std::optional<double> OpticalBenchReader::value(const Variable& variable, std::size_t column) const {
  const std::size_t at = variable.values.size() == 1 ? 0 : column;
  if (at >= variable.values.size()) return {};
  const std::string& text = variable.values[at];
  if (text.empty() || same(text, "undefined")) return {};
  if (same(text, "Infinity")) return std::numeric_limits<double>::infinity();
  return in_.number(variable.line, "value", text);
}

std::optional<double> OpticalBenchReader::value(std::string_view name, std::size_t column) const {
  const auto found = variables_.find(name);
  return found == variables_.end() ? std::nullopt : value(found->second, column);
}

std::optional<double> OpticalBenchReader::value(const Length& length, std::size_t column) const {
  return length.variable ? value(*length.variable, column) : length.number;
}

/// True if all distances between surfaces have values in a position. The last distance, to the film, may be missing.
bool OpticalBenchReader::is_defined(std::size_t column) const {
  return std::ranges::all_of(rows_.begin(), rows_.end() - 1, [&](const Row& row) {
    const auto thickness = value(row.thickness, column);
    return thickness && std::isfinite(*thickness);
  });
}

std::vector<std::size_t> OpticalBenchReader::defined_columns() {
  std::size_t count = 1;
  for (const auto& [name, variable] : variables_) {
    const bool counts = variable.used || std::ranges::count(quantities, name) > 0 || name == "d0";
    if (counts) count = std::max(count, variable.values.size());
  }
  for (const Row& row : rows_) {
    if (&row != &rows_.back() && !row.thickness.number && !row.thickness.variable) {
      in_.refuse(row.line, "thickness", "missing", "a number or a row of [variable distances]");
    }
  }
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < count; ++column) {
    if (is_defined(column)) {
      columns.push_back(column);
    } else {
      in_.warn(0, "variable distances",
               "column " + std::to_string(column + 1) + " is left out: it does not state all distances");
    }
  }
  if (columns.empty())
    throw Error(in_.where() + ": no column of [variable distances] states all distances; must be at least one column");
  return columns;
}

/// Sets the rows to one position.
void OpticalBenchReader::place(std::size_t column) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    SurfaceRow& surface = in_.lens.surfaces[i];
    const auto thickness = value(rows_[i].thickness, column);
    surface.thickness = thickness.value_or(0);
    auto diameter = value(rows_[i].diameter, column);
    if (surface.stop) diameter = value("Aperture Diameter", column) ? value("Aperture Diameter", column) : diameter;
    surface.semi_diameter.reset();
    if (diameter && std::isfinite(*diameter) && *diameter > 0) surface.semi_diameter = *diameter / 2;
  }
  in_.lens.semi_diameters = "half of the table's diameters";
}

std::optional<double> positive(std::optional<double> value) {
  return value && *value > 0 && std::isfinite(*value) ? value : std::nullopt;
}

void OpticalBenchReader::declare(std::size_t column) {
  Prescription& lens = in_.lens;
  const auto focal_length = value("Focal Length", column), field = positive(value("Angle of View", column));
  if (focal_length && std::isfinite(*focal_length)) lens.focal_length_mm = focal_length;
  lens.f_number = positive(value("F-Number", column));
  in_.requests.nominal_aperture = true;
  lens.image_diagonal_mm = positive(value("Image Height", column));
  if (lens.f_number) {
    lens.design.aperture = {ApertureSetting::f_number, *lens.f_number};
  } else if (const auto na = positive(value("NA", column))) {
    lens.design.aperture = {ApertureSetting::object_na, *na};
  }
  if (field && *field < 360) {
    lens.half_field_deg = *field / 2;
    lens.design.fields = {{.y = *field / 2}};
  }
  if (const auto object = value("d0", column)) lens.design.object_distance_mm = *object;
  lens.design.wavelengths = {{d_line_nm, 1}};
}

/// A position, with only the changes from the rows of `base`.
Configuration OpticalBenchReader::configuration(std::size_t column, std::size_t base) {
  place(base);
  const Prescription rows = in_.lens;
  place(column);
  Configuration result;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    SurfaceChange change{.surface = static_cast<int>(i)};
    const SurfaceRow &old = rows.surfaces[i], &now = in_.lens.surfaces[i];
    if (now.thickness != old.thickness) change.thickness = now.thickness;
    if (now.semi_diameter && now.semi_diameter != old.semi_diameter) change.semi_diameter = now.semi_diameter;
    if (change.thickness || change.semi_diameter) result.changes.push_back(change);
  }
  result.subject_distance_mm = positive(value("d0", column));
  const auto focal_length = value("Focal Length", column);
  if (focal_length && std::isfinite(*focal_length)) result.focal_length_mm = focal_length;
  result.f_number = positive(value("F-Number", column));
  result.image_diagonal_mm = positive(value("Image Height", column));
  const auto field = positive(value("Angle of View", column));
  if (field && *field < 360) result.half_field_deg = *field / 2;
  return result;
}

/// Makes a configuration of each column. Names are in [report data], or follow from the subject distances.
void OpticalBenchReader::configure(const std::vector<std::size_t>& columns) {
  if (columns.size() < 2) return;
  const auto line_of = [&](std::string_view name) {
    const auto found = variables_.find(name);
    return found == variables_.end() ? 0 : found->second.line;
  };
  UnnamedPositions positions{line_of("d0") > 0 ? line_of("d0") : line_of("Magnification"), {}};
  for (const std::size_t column : columns) {
    Configuration& c = in_.lens.configurations.emplace_back(configuration(column, columns.front()));
    Position& position = positions.list.emplace_back();
    // d0 takes precedence over a magnification.
    const auto magnification = value("d0", column) ? std::nullopt : value("Magnification", column);
    if (magnification && std::isfinite(*magnification) && *magnification != 0) position.magnification = magnification;
    const auto scenario = std::ranges::find(scenarios_, std::to_string(column));
    if (scenario != scenarios_.end() && scenarios_.size() == names_.size()) {
      c.name = names_[static_cast<std::size_t>(scenario - scenarios_.begin())];
    }
    position.is_named = !c.name.empty();
    if (!position.is_named) c.name = "position " + std::to_string(column + 1);
  }
  place(columns.front());
  in_.requests.positions = std::move(positions);
}

/// Requests the positions of the film that the table does not state.
void OpticalBenchReader::place_film(const std::vector<std::size_t>& columns) {
  const Row& last = rows_.back();
  FilmAtFocus film{last.line, "thickness", "the position of the film is not stated", true, false, {}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (value(last.thickness, columns[i])) continue;
    if (i == 0) film.in_the_rows = true;
    if (i > 0) film.configurations.push_back(i);
  }
  if (film.in_the_rows || !film.configurations.empty()) in_.requests.film_at_focus = std::move(film);
}

}  // namespace

bool is_opticalbench(std::string_view text) {
  for (Lines lines(text); lines.next() && lines.number() <= 10'000;) {
    if (lower(trimmed(lines.text().substr(0, 64))).starts_with("[lens data]")) return true;
  }
  return false;
}

void read_opticalbench(std::string_view text, Import& in) { OpticalBenchReader(in).read(text); }

}  // namespace petzval::formats_detail
