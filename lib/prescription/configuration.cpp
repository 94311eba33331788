// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "configured_row.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {
namespace {

using Configurations = std::vector<Configuration>;

std::string name_of(const Prescription& p) { return p.name.empty() ? std::string("lens") : p.name; }

/// The number of a configuration choice (1, 2.5), or the index of its name.
double position_of(const Prescription& p, const ConfigurationChoice& choice) {
  const std::size_t count = std::max<std::size_t>(p.configurations.size(), 1);
  const auto refuse = [&](const std::string& found) -> Error {
    std::string names;
    for (const Configuration& c : p.configurations) names += (names.empty() ? "" : ", ") + c.name;
    return Error(
        name_of(p) + ": configuration " + found + " does not exist; must be " +
        (names.empty() ? "0, the only configuration" : "0 to " + std::to_string(count - 1) + " or in: " + names));
  };
  if (const double* number = std::get_if<double>(&choice.value())) {
    if (!(*number >= 0 && *number <= static_cast<double>(count - 1))) throw refuse(to_text(*number));
    return *number;
  }
  const std::string& name = std::get<std::string>(choice.value());
  const auto found = std::ranges::find(p.configurations, name, &Configuration::name);
  if (found == p.configurations.end()) throw refuse('"' + name + '"');
  return static_cast<double>(found - p.configurations.begin());
}

/// Copies everything except the configurations: for many configurations, copying them for each one would take quadratic
/// time.
Prescription without_configurations(const Prescription& p) {
  // The structured binding names every member: after a new member is added, this line does not compile until it is
  // changed.
  const auto& [id, name, source_design, source_numbers, focal_length_mm, f_number, half_field_deg, image_diagonal_mm,
               reference_wavelength_nm, semi_diameters, stop_size, image_distance, glass_names, notes, aliases,
               imported, design, object_space, surfaces, configurations] = p;
  return {id,
          name,
          source_design,
          source_numbers,
          focal_length_mm,
          f_number,
          half_field_deg,
          image_diagonal_mm,
          reference_wavelength_nm,
          semi_diameters,
          stop_size,
          image_distance,
          glass_names,
          notes,
          aliases,
          imported,
          design,
          object_space,
          surfaces,
          {}};
}

void apply(const Configuration& configuration, Prescription& p) {
  for (const SurfaceChange& change : configuration.changes) {
    prescription_detail::apply(change, p.surfaces[static_cast<std::size_t>(change.surface)]);
  }
  if (configuration.stop) {
    for (SurfaceRow& row : p.surfaces) row.stop = false;
    p.surfaces[static_cast<std::size_t>(*configuration.stop)].stop = true;
  }
  if (configuration.focal_length_mm) p.focal_length_mm = configuration.focal_length_mm;
  if (configuration.f_number) p.f_number = configuration.f_number;
  if (configuration.half_field_deg) p.half_field_deg = configuration.half_field_deg;
  if (configuration.image_diagonal_mm) p.image_diagonal_mm = configuration.image_diagonal_mm;
}

/// The prescription in one configuration of the list, without the list.
Prescription rows_at(const Prescription& p, std::size_t number) {
  Prescription result = without_configurations(p);
  if (!p.configurations.empty()) apply(p.configurations[number], result);
  return result;
}

std::optional<double> between(const std::optional<double>& a, const std::optional<double>& b, double t) {
  if (!a || !b) return a == b ? a : std::nullopt;
  return std::lerp(*a, *b, t);
}

/// Interpolates the radius. For a plane, or for radii of opposite signs, it interpolates the curvature, because a
/// radius would pass through 0.
double radius_between(double a, double b, double t) {
  if (a != 0 && b != 0 && (a > 0) == (b > 0)) return std::lerp(a, b, t);
  const double curvature = std::lerp(a == 0 ? 0 : 1 / a, b == 0 ? 0 : 1 / b, t);
  return curvature == 0 ? 0 : 1 / curvature;
}

std::optional<double> same(const std::optional<double>& a, const std::optional<double>& b) {
  return a == b ? a : std::nullopt;
}

Prescription between(const Prescription& a, const Prescription& b, double t, const std::string& where) {
  Prescription result = a;
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    const SurfaceRow &from = a.surfaces[i], &to = b.surfaces[i];
    SurfaceRow& row = result.surfaces[i];
    if (from.medium != to.medium || from.stop != to.stop) {
      throw Error(where + ": surface " + std::to_string(i) +
                  ": medium or stop changes; must be a configuration of the list");
    }
    row.thickness = std::lerp(from.thickness, to.thickness, t);
    row.radius = radius_between(from.radius, to.radius, t);
    row.conic = std::lerp(from.conic, to.conic, t);
    row.semi_diameter = between(from.semi_diameter, to.semi_diameter, t);
  }
  result.focal_length_mm = same(a.focal_length_mm, b.focal_length_mm);
  result.f_number = same(a.f_number, b.f_number);
  result.half_field_deg = same(a.half_field_deg, b.half_field_deg);
  result.image_diagonal_mm = same(a.image_diagonal_mm, b.image_diagonal_mm);
  return result;
}

/// The changes from the rows of `from` to the rows of `to`, with the name and the distance of `named`.
Configuration difference(const Prescription& from, const Prescription& to, Configuration named) {
  named.changes.clear();
  named.stop.reset();
  for (std::size_t i = 0; i < from.surfaces.size(); ++i) {
    const SurfaceRow &old = from.surfaces[i], &row = to.surfaces[i];
    SurfaceChange change{.surface = static_cast<int>(i)};
    if (row.thickness != old.thickness) change.thickness = row.thickness;
    if (row.radius != old.radius) change.radius = row.radius;
    if (row.conic != old.conic) change.conic = row.conic;
    if (row.semi_diameter != old.semi_diameter) change.semi_diameter = row.semi_diameter;
    if (row.medium != old.medium) change.medium = row.medium;
    if (row.stop && !old.stop) named.stop = change.surface;
    if (change != SurfaceChange{.surface = change.surface}) named.changes.push_back(std::move(change));
  }
  return named;
}

/// The configurations that focus a zoom position, in the order of the list.
std::vector<std::size_t> focusing(const Prescription& p, std::size_t number) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < p.configurations.size(); ++i) {
    if (p.configurations[i].focus_of == p.configurations[number].name) result.push_back(i);
  }
  return result;
}

}  // namespace

Prescription configured(const Prescription& p, const ConfigurationChoice& choice) {
  const double position = position_of(p, choice);
  if (p.configurations.empty()) return p;
  const auto number = static_cast<std::size_t>(position);
  const double t = position - static_cast<double>(number);
  const Configuration& first = p.configurations[number];

  Prescription result = rows_at(p, number);
  const auto zoom_positions =
      std::ranges::count_if(p.configurations, [](const Configuration& c) { return !c.focus_of; });
  if (t == 0) {
    if (zoom_positions > 1 || first.focus_of) result.name += ", " + first.name;
    result.configurations.push_back(first);
    result.configurations[0].changes.clear();
    result.configurations[0].stop.reset();
    result.configurations[0].focus_of.reset();
    if (!first.focus_of) {
      for (const std::size_t i : focusing(p, number)) {
        result.configurations.push_back(difference(result, rows_at(p, i), p.configurations[i]));
      }
    }
    return result;
  }

  const Configuration& second = p.configurations[number + 1];
  const std::string where = name_of(p) + ": configuration " + to_text(position);
  if (first.focus_of || second.focus_of) {
    throw Error(where + " lies between \"" + first.name + "\" and \"" + second.name +
                "\"; must lie between two zoom positions");
  }
  result = between(result, rows_at(p, number + 1), t, where);
  result.configurations = {{.name = first.name + " to " + second.name}};
  result.name += ", " + to_text(1 - t, 3) + " " + first.name + " + " + to_text(t, 3) + " " + second.name;
  const auto near_first = focusing(p, number), near_second = focusing(p, number + 1);
  for (std::size_t i = 0; i < near_first.size(); ++i) {
    const Configuration& focused = p.configurations[near_first[i]];
    const auto partner = std::ranges::find_if(near_second, [&](std::size_t other) {
      return p.configurations[other].subject_distance_mm == focused.subject_distance_mm;
    });
    if (partner == near_second.end()) continue;
    Configuration named = focused;
    named.focus_of = result.configurations[0].name;
    named.focal_length_mm = named.f_number = named.half_field_deg = named.image_diagonal_mm = std::nullopt;
    const Prescription rows = between(rows_at(p, near_first[i]), rows_at(p, *partner), t, where);
    result.configurations.push_back(difference(result, rows, named));
  }
  return result;
}

}  // namespace petzval
