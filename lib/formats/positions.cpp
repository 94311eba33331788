// SPDX-License-Identifier: Apache-2.0
#include "positions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// Names of rows that state a property of each position and not a distance of the lens.
constexpr std::array<std::string_view, 9> quantities = {
    "Focal Length", "F-Number", "Angle of View", "Image Height",      "Magnification",
    "NA",           "WD",       "Total Length",  "Aperture Diameter",
};

std::optional<double> positive(std::optional<double> value) {
  return value && *value > 0 && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace

void Positions::apply() {
  name_variables();
  const auto columns = defined_columns();
  place(columns.front());
  declare(columns.front());
  configure(columns);
  place_film(columns);
}

/// Warns of rows that no surface refers to and the format does not define.
void Positions::name_variables() {
  for (const auto& [name, variable] : variables) {
    const bool known = variable.used || name == "d0" || name == "Bf" || std::ranges::count(quantities, name) > 0;
    if (!known) in_.warn(variable.line, name, "no surface has this distance; it is left out");
  }
}

/// The value of a row in a position; nullopt for "undefined" and empty cells. A single value holds for all positions.
std::optional<double> Positions::value(const Variable& variable, std::size_t column) const {
  const std::size_t at = variable.values.size() == 1 ? 0 : column;
  if (at >= variable.values.size()) return {};
  const std::string& text = variable.values[at];
  if (text.empty() || same(text, "undefined")) return {};
  if (same(text, "Infinity")) return std::numeric_limits<double>::infinity();
  return in_.number(variable.line, "value", text);
}

std::optional<double> Positions::value(std::string_view name, std::size_t column) const {
  const auto found = variables.find(name);
  return found == variables.end() ? std::nullopt : value(found->second, column);
}

std::optional<double> Positions::value(const Length& length, std::size_t column) const {
  return length.variable ? value(*length.variable, column) : length.number;
}

/// True if all distances between surfaces have values in a position. The last distance, to the film, may be missing.
bool Positions::is_defined(std::size_t column) const {
  return std::ranges::all_of(rows.begin(), rows.end() - 1, [&](const Row& row) {
    const auto thickness = value(row.thickness, column);
    return thickness && std::isfinite(*thickness);
  });
}

std::vector<std::size_t> Positions::defined_columns() {
  std::size_t count = 1;
  for (const auto& [name, variable] : variables) {
    const bool counts = variable.used || std::ranges::count(quantities, name) > 0 || name == "d0";
    if (counts) count = std::max(count, variable.values.size());
  }
  for (const Row& row : rows) {
    if (&row != &rows.back() && !row.thickness.number && !row.thickness.variable) {
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
void Positions::place(std::size_t column) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SurfaceRow& surface = in_.lens.surfaces[i];
    const auto thickness = value(rows[i].thickness, column);
    surface.thickness = thickness.value_or(0);
    auto diameter = value(rows[i].diameter, column);
    if (surface.stop) diameter = value("Aperture Diameter", column) ? value("Aperture Diameter", column) : diameter;
    surface.semi_diameter.reset();
    if (diameter && std::isfinite(*diameter) && *diameter > 0) surface.semi_diameter = *diameter / 2;
  }
}

void Positions::declare(std::size_t column) {
  Prescription& lens = in_.lens;
  const auto focal_length = value("Focal Length", column), field = positive(value("Angle of View", column));
  if (focal_length && std::isfinite(*focal_length)) lens.focal_length_mm = focal_length;
  lens.f_number = positive(value("F-Number", column));
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
Configuration Positions::configuration(std::size_t column, std::size_t base) {
  place(base);
  const Prescription before = in_.lens;
  place(column);
  Configuration result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SurfaceChange change{.surface = static_cast<int>(i)};
    const SurfaceRow &old = before.surfaces[i], &now = in_.lens.surfaces[i];
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
void Positions::configure(const std::vector<std::size_t>& columns) {
  if (columns.size() < 2) return;
  const auto line_of = [&](std::string_view name) {
    const auto found = variables.find(name);
    return found == variables.end() ? 0 : found->second.line;
  };
  UnnamedPositions positions{line_of("d0") > 0 ? line_of("d0") : line_of("Magnification"), {}};
  for (const std::size_t column : columns) {
    Configuration& c = in_.lens.configurations.emplace_back(configuration(column, columns.front()));
    Position& position = positions.list.emplace_back();
    // d0 takes precedence over a magnification.
    const auto magnification = value("d0", column) ? std::nullopt : value("Magnification", column);
    if (magnification && std::isfinite(*magnification) && *magnification != 0) position.magnification = magnification;
    if (const auto named = names.find(std::to_string(column)); named != names.end()) c.name = named->second;
    position.is_named = !c.name.empty();
    if (!position.is_named) c.name = "position " + std::to_string(column + 1);
  }
  place(columns.front());
  in_.requests.positions = std::move(positions);
}

/// Requests the positions of the film that the table does not state.
void Positions::place_film(const std::vector<std::size_t>& columns) {
  const Row& last = rows.back();
  FilmAtFocus film{last.line, "thickness", "the position of the film is not stated", true, false, {}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (value(last.thickness, columns[i])) continue;
    if (i == 0) film.in_the_rows = true;
    if (i > 0) film.configurations.push_back(i);
  }
  if (film.in_the_rows || !film.configurations.empty()) in_.requests.film_at_focus = std::move(film);
}

}  // namespace petzval::formats_detail
