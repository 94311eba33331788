// SPDX-License-Identifier: Apache-2.0
#include "petzval/lens/lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "compile.hpp"
#include "core/text.hpp"
#include "data.hpp"
#include "describe_asphere.hpp"
#include "glass/absorption.hpp"
#include "iris/iris_edges.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/core/error.hpp"
#include "without_obscurations.hpp"

namespace petzval {

namespace {

/// Index of a wavelength in a list, within 1e-6 nm; the length of the list if it has no such wavelength.
std::size_t compiled(std::span<const double> list, double nm) noexcept {
  const auto found = std::ranges::find_if(list, [nm](double w) { return std::abs(w - nm) <= 1e-6; });
  return static_cast<std::size_t>(found - list.begin());
}

/// Index of a wavelength; the number of wavelengths or more if it was not compiled.
std::size_t index_of(const Lens& lens, Wavelength at) noexcept {
  const auto nm = at.in_nm();
  return nm ? compiled(lens.wavelengths_nm(), *nm) : at.index(lens.primary_wavelength());
}

std::size_t nearest(const std::vector<double>& list, double nm) {
  const auto closer = [nm](double a, double b) { return std::abs(a - nm) < std::abs(b - nm); };
  return static_cast<std::size_t>(std::min_element(list.begin(), list.end(), closer) - list.begin());
}

void demand(const Lens& lens, const char* what, std::size_t found, std::size_t count) {
  if (found < count) return;
  throw Error(lens.name() + ": " + what + " " + std::to_string(found) + " does not exist; must be below " +
              std::to_string(count));
}

/// @throws Error unless the lens has the space and covers the wavelength
void demand_medium(const Lens& lens, std::size_t space, Wavelength at) {
  const auto list = lens.wavelengths_nm();
  const std::size_t w = index_of(lens, at);
  if (const auto nm = at.in_nm(); !nm) {
    demand(lens, "wavelength", w, list.size());
  } else if (w >= list.size() && !lens.covers(at)) {
    const auto [shortest, longest] = std::ranges::minmax_element(list);
    throw Error(lens.name() + ": wavelength = " + to_text(*nm) + " nm; must be " +
                (std::isfinite(lens.index_error()) ? to_text(*shortest) + " to " + to_text(*longest) + " nm"
                                                   : "a compiled wavelength: a medium has no index between them"));
  }
  demand(lens, "space", space, lens.surface_count() + 1);
}

}  // namespace

std::string_view name(Dispersion dispersion) noexcept {
  switch (dispersion) {
    case Dispersion::catalogue: return "catalogue";
    case Dispersion::abbe: return "abbe";
    case Dispersion::none: return "none";
  }
  return "unknown";
}

const std::string& Lens::name() const noexcept { return data_->name; }
std::span<const LensSurface> Lens::surfaces() const noexcept { return data_->surfaces; }
std::optional<std::size_t> Lens::stop() const noexcept { return data_->stop; }
const Iris& Lens::iris() const noexcept { return data_->iris; }
std::span<const FocusPosition> Lens::focus_positions() const noexcept { return data_->focus_positions; }
double Lens::film_z() const noexcept { return data_->film_z; }
std::span<const double> Lens::wavelengths_nm() const noexcept { return data_->wavelengths_nm; }
Dispersion Lens::dispersion() const noexcept { return data_->indices.dispersion; }
std::span<const std::string> Lens::missing_glasses() const noexcept { return data_->indices.missing_glasses; }
std::span<const std::string> Lens::clamped_glasses() const noexcept { return data_->indices.clamped_glasses; }

std::size_t Lens::primary_wavelength() const noexcept { return data_->primary; }

std::size_t Lens::wavelength_index(Wavelength at) const {
  const std::size_t w = index_of(*this, at);
  const auto nm = at.in_nm();
  if (!nm) demand(*this, "wavelength", w, data_->wavelengths_nm.size());
  if (w < data_->wavelengths_nm.size()) return w;
  std::string list;
  for (const double compiled : data_->wavelengths_nm) list += (list.empty() ? "" : ", ") + to_text(compiled);
  throw Error(name() + ": wavelength = " + to_text(*nm) + " nm; must be a compiled wavelength: " + list);
}

bool Lens::covers(Wavelength at) const noexcept {
  if (const auto nm = at.in_nm()) return data_->indices.spectrum.covers(*nm);
  return index_of(*this, at) < data_->wavelengths_nm.size();
}

double Lens::index(std::size_t space, Wavelength at) const {
  demand_medium(*this, space, at);
  const std::size_t w = index_of(*this, at);
  return w < data_->wavelengths_nm.size() ? data_->indices.values[w * (surface_count() + 1) + space]
                                          : data_->indices.spectrum.index(space, *at.in_nm());
}

double Lens::absorption(std::size_t space, Wavelength at) const {
  demand_medium(*this, space, at);
  const double nm = at.in_nm() ? *at.in_nm() : data_->wavelengths_nm[index_of(*this, at)];
  return glass_detail::absorption_at(data_->indices.absorption[space], nm);
}

double Lens::index_error() const noexcept { return data_->indices.spectrum.error(); }

double Lens::light_direction(std::size_t space) const {
  demand(*this, "space", space, surface_count() + 1);
  if (space == 0) return 1;
  const kernel::SurfaceTable<double>& before = data_->in_double->tables.surfaces[space - 1];
  return before.mirror ? -before.sense : before.sense;
}

std::size_t Lens::nearest_wavelength(double nm) const {
  if (!std::isfinite(nm)) throw Error(name() + ": wavelength = " + to_text(nm) + " nm; must be finite");
  return nearest(data_->wavelengths_nm, nm);
}

bool Lens::rotationally_symmetric() const noexcept {
  return data_->iris.round() && std::all_of(data_->surfaces.begin(), data_->surfaces.end(),
                                            [](const LensSurface& s) { return s.curved_in == Section::both; });
}

template <>
const kernel::LensView<float>& kernel::view(const Lens& lens) noexcept {
  return lens.data().in_float->view;
}
template <>
const kernel::LensView<double>& kernel::view(const Lens& lens) noexcept {
  return lens.data().in_double->view;
}

namespace {

/// Positions the vertices and the film by the thicknesses.
void place_vertices(Lens::Data& data) {
  double z = 0;
  for (LensSurface& surface : data.surfaces) {
    surface.vertex_z = z;
    z += surface.thickness;
  }
  data.film_z = z;
}

/// The focus positions of a prescription in one configuration, by inverse distance; empty if fewer than two.
std::vector<FocusPosition> focus_positions(const Prescription& prescription) {
  std::vector<FocusPosition> result;
  for (std::size_t i = 0; i < prescription.configurations.size(); ++i) {
    const Prescription rows = configured(prescription, i);
    const double distance =
        prescription.configurations[i].subject_distance_mm.value_or(std::numeric_limits<double>::infinity());
    FocusPosition position{1 / distance, {}};
    for (const SurfaceRow& row : rows.surfaces) position.thicknesses.push_back(row.thickness);
    const bool known =
        std::ranges::find(result, position.inverse_distance, &FocusPosition::inverse_distance) != result.end();
    if (!known) result.push_back(std::move(position));
  }
  if (result.size() < 2) return {};
  std::ranges::sort(result, {}, &FocusPosition::inverse_distance);
  return result;
}

/// A semi-diameter limited to the range in which its square is representable in float (1e-38 to 1e38); rays beyond 1e15
/// mm are lost.
double usable_rim(double semi_diameter) noexcept {
  if (semi_diameter < 1e-12) return 0;
  return semi_diameter > 1e15 ? std::numeric_limits<double>::infinity() : semi_diameter;
}

}  // namespace

Lens lens_detail::compile_as_given(const Prescription& source, std::span<const double> wavelengths_nm,
                                   const CompileOptions& options) {
  const auto name_of = [](const Prescription& p) { return p.name.empty() ? std::string("lens") : p.name; };
  validate(source, name_of(source));
  const Prescription prescription = configured(source, options.configuration);
  const std::string where = name_of(prescription);
  if (wavelengths_nm.empty()) throw Error(where + ": no wavelengths; must be at least one");

  auto data = std::make_shared<Lens::Data>();
  data->name = where;
  for (const double nm : wavelengths_nm) {
    if (const std::size_t same = compiled(data->wavelengths_nm, nm); same < data->wavelengths_nm.size()) {
      throw Error(where + ": wavelength " + std::to_string(data->wavelengths_nm.size()) + " = " + to_text(nm) +
                  " nm; must differ from wavelength " + std::to_string(same) + " of the list");
    }
    data->wavelengths_nm.push_back(nm);
  }
  data->primary = compiled(data->wavelengths_nm, options.primary_nm.value_or(prescription.reference_wavelength_nm));
  if (data->primary == data->wavelengths_nm.size()) {
    if (options.primary_nm) {
      throw Error(where + ": primary_nm = " + to_text(*options.primary_nm) + "; must be a compiled wavelength");
    }
    data->primary = nearest(data->wavelengths_nm, d_line_nm);
  }
  for (const SurfaceRow& row : prescription.surfaces) {
    LensSurface s;
    s.thickness = row.thickness;
    s.curvature = row.radius == 0 ? 0 : 1 / row.radius;
    s.conic = row.conic;
    s.curved_in = row.curved_in;
    s.coating = row.coating;
    s.aspheric = row.aspheric;
    data->rims.push_back(usable_rim(row.semi_diameter.value_or(std::numeric_limits<double>::infinity())));
    s.widest_semi_diameter = row.semi_diameter_computed ? std::numeric_limits<double>::infinity() : data->rims.back();
    s.obscuration_semi_diameter = row.obscuration_semi_diameter.value_or(0);
    s.mirror = row.mirror;
    if (row.stop && !data->stop) data->stop = data->surfaces.size();
    data->surfaces.push_back(std::move(s));
  }
  place_vertices(*data);
  data->focus_positions = focus_positions(prescription);
  data->indices = lens_detail::indices(prescription, wavelengths_nm, options, where);
  data->build();
  return Lens::Data::lens(std::move(data));
}

Lens lens_detail::with_rims(const Lens& lens, std::vector<double> rims) {
  auto data = std::make_shared<Lens::Data>(lens.data());
  data->rims = std::move(rims);
  data->build();
  return Lens::Data::lens(std::move(data));
}

Lens lens_detail::without_edges(const Lens& lens) {
  auto data = std::make_shared<Lens::Data>(lens.data());
  data->build(false);
  return Lens::Data::lens(std::move(data));
}

Lens with_any_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter) {
  demand(lens, "surface", surface, lens.surface_count());
  if (!(semi_diameter >= 0)) {
    throw Error(lens.name() + ": surface " + std::to_string(surface) + ": semi_diameter = " + to_text(semi_diameter) +
                " mm; must be at least 0");
  }
  if (!lens.iris().round() && lens.stop() == surface && std::isinf(usable_rim(semi_diameter))) {
    throw Error(lens.name() + ": surface " + std::to_string(surface) + ": semi_diameter = " + to_text(semi_diameter) +
                " mm; must be at most 1e15 mm at the stop of a lens with an iris");
  }
  auto data = std::make_shared<Lens::Data>(lens.data());
  data->rims[surface] = usable_rim(semi_diameter);
  data->build();
  return Lens::Data::lens(std::move(data));
}

Lens with_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter) {
  Lens result = with_any_semi_diameter(lens, surface, semi_diameter);
  const double widest = lens.surfaces()[surface].widest_semi_diameter;
  if (usable_rim(semi_diameter) > widest) {
    throw Error(lens.name() + ": surface " + std::to_string(surface) + ": semi_diameter = " + to_text(semi_diameter) +
                " mm; must be at most " + to_text(widest) + " mm, the clear aperture of the prescription");
  }
  return result;
}

Lens with_film(const Lens& lens, double film_z) {
  if (!std::isfinite(film_z)) throw Error(lens.name() + ": film_z = " + to_text(film_z) + " mm; must be finite");
  const double last_z = lens.surfaces().back().vertex_z, direction = lens.light_direction(lens.surface_count());
  if (!((film_z - last_z) * direction > 0)) {
    throw Error(lens.name() + ": film_z = " + to_text(film_z) + " mm; must be behind the lens, " +
                (direction > 0 ? "above " : "below ") + to_text(last_z) + " mm, the z of the last vertex");
  }
  auto data = std::make_shared<Lens::Data>(lens.data());
  data->film_z = film_z;
  return Lens::Data::lens(std::move(data));
}

Lens with_groups_at(const Lens& lens, double inverse_distance) {
  const std::span<const FocusPosition> positions = lens.focus_positions();
  const auto refuse = [&](const std::string& found, const std::string& rule) {
    throw Error(lens.name() + ": " + found + "; must be " + rule);
  };
  if (positions.empty()) refuse("no group moves", "a lens with focus positions");
  if (!std::isfinite(inverse_distance)) refuse("inverse_distance = " + to_text(inverse_distance), "finite");

  const auto above = std::ranges::upper_bound(positions.subspan(1, positions.size() - 2), inverse_distance, {},
                                              &FocusPosition::inverse_distance);
  const FocusPosition &to = *above, &from = *(above - 1);
  const double t = (inverse_distance - from.inverse_distance) / (to.inverse_distance - from.inverse_distance);
  auto data = std::make_shared<Lens::Data>(lens.data());
  for (std::size_t i = 0; i < data->surfaces.size(); ++i) {
    const double near = from.thicknesses[i], far = to.thicknesses[i];
    const double thickness = near == far ? near : near + t * (far - near);
    if (thickness < 0 && near > 0 && far > 0) {
      refuse("surface " + std::to_string(i) + ": thickness = " + to_text(thickness) + " mm at this distance",
             "positive, as at the focus positions");
    }
    data->surfaces[i].thickness = thickness;
  }
  place_vertices(*data);
  data->build();
  return Lens::Data::lens(std::move(data));
}

bool has_obscurations(const Lens& lens) noexcept {
  return std::ranges::any_of(lens.surfaces(), [](const LensSurface& s) { return s.obscuration_semi_diameter > 0; });
}

Lens without_obscurations(const Lens& lens) {
  auto data = std::make_shared<Lens::Data>(lens.data());
  for (LensSurface& s : data->surfaces) s.obscuration_semi_diameter = 0;
  data->build();
  return Lens::Data::lens(std::move(data));
}

Lens with_iris(const Lens& lens, const Iris& iris) {
  const std::string where = lens.name() + ": iris";
  iris_detail::check(iris, where + ": ");
  if (iris.round() && lens.iris().round()) return lens;
  if (!iris.round()) {
    if (!lens.stop()) throw Error(where + ": no surface is marked as the stop; must be one surface");
    if (std::isinf(lens.surfaces()[*lens.stop()].semi_diameter)) {
      throw Error(where + ": surface " + std::to_string(*lens.stop()) +
                  ", the stop: semi_diameter is unlimited; must be finite");
    }
  }
  auto data = std::make_shared<Lens::Data>(lens.data());
  data->iris = iris;
  data->build();
  return Lens::Data::lens(std::move(data));
}

Lens with_coating(const Lens& lens, const Coating& coating) {
  validate(coating, lens.name());
  constexpr double largest_air_index = 1.01;
  auto data = std::make_shared<Lens::Data>(lens.data());
  for (std::size_t i = 0; i < data->surfaces.size(); ++i) {
    LensSurface& surface = data->surfaces[i];
    surface.coating = Coating{};
    if (surface.mirror) continue;
    const bool air_before = lens.index(i) < largest_air_index, air_behind = lens.index(i + 1) < largest_air_index;
    if (air_before != air_behind) surface.coating = air_before ? coating : reversed(coating);
  }
  return Lens::Data::lens(std::move(data));
}

}  // namespace petzval
