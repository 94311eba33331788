// SPDX-License-Identifier: Apache-2.0
#include "import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "media/similar_names.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/medium.hpp"
#include "petzval/lint/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text_file.hpp"

namespace petzval::inline v0::files_detail {
namespace {

using media_detail::same_bare;

constexpr std::size_t most_warnings = 1000;

/// Names under which other programs know materials of the tables.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> other_names = {{
    {"SILICA", "F_SILICA"},
    {"FUSEDSILICA", "F_SILICA"},
    {"FSILICA", "F_SILICA"},
    {"SIO2", "F_SILICA"},
    {"MGF2", "MGF2_O"},
    {"SAPPHIRE", "SAPPHIRE_O"},
    {"POLYCARB", "POLYCARBONATE"},
    {"POLYSTYR", "POLYSTYRENE"},
    {"ACRYLIC", "PMMA"},
    {"E48R", "ZEONEX_E48R"},
    {"SEAWATER", "WATER"},
    {"CAFL", "CAF2"},
}};

/// Where the image of the stop lies in object space, from the first surface: the ray that crosses the axis there meets
/// the middle of the stop.
double entrance_pupil_z(const RayMatrix& to_stop, double object_index) {
  return to_stop.a == 0 ? std::numeric_limits<double>::infinity() : to_stop.b * object_index / to_stop.a;
}

/// How high the marginal ray of the design meets the stop, in mm: of exact rays where a parallel beam enters, else in
/// first order. 0 where the aperture does not tell.
double marginal_height_at_the_stop(const Prescription& rows, const DesignAperture& aperture, const Import& in) {
  const auto stop = std::ranges::find_if(rows.surfaces, [](const SurfaceRow& row) { return row.stop; });
  const auto position = static_cast<std::size_t>(stop - rows.surfaces.begin());
  Prescription open = rows;
  open.imported.reset();
  for (SurfaceRow& row : open.surfaces) {
    row.semi_diameter.reset();
    row.obscuration_semi_diameter.reset();
  }
  open.configurations.clear();
  const Lens compiled = in.compiled(open);
  const FirstOrder first = first_order(compiled, {}, main_meridian(compiled));
  const double object = rows.design.object_distance_mm;

  // The marginal ray of the design: its height and slope in front of the first surface.
  const RayMatrix to_stop = ray_matrix_to(compiled, position, {}, main_meridian(compiled));
  const bool far = !std::isfinite(object);
  const auto per_unit = [&](double height, double slope) { return to_stop.a * height + to_stop.b * slope; };
  const double unit = far ? per_unit(1, 0) : per_unit(object, first.object_index);  // slope 1: u = 1, n u = n
  const auto image_slope = [&] {
    const RayMatrix all = ray_matrix(compiled, 0, compiled.surface_count(), {}, main_meridian(compiled));
    return std::abs((far ? all.c : all.c * object + all.d * first.object_index) / first.image_index);
  };
  double height = 0;  // of the marginal ray at the stop
  const double value = aperture.value;
  switch (aperture.setting) {
    case ApertureSetting::entrance_pupil_diameter:
    case ApertureSetting::f_number: {
      const bool by_ratio = aperture.setting == ApertureSetting::f_number;
      if (by_ratio && first.afocal) break;
      const double diameter = by_ratio ? std::abs(first.effective_focal_length) / value : value;
      if (!first.afocal && far) {
        try {
          const double n = std::abs(first.effective_focal_length) / diameter;
          const Lens wide = with_semi_diameter(compiled, position, 100 * std::abs(first.effective_focal_length));
          height = with_f_number(wide, n).surfaces()[position].semi_diameter;
          break;
        } catch (const Error&) {
          // rays of this height miss a surface: first order then
        }
      }
      // A parallel beam, or the one from the object to the rim of the entrance pupil, where the stop's image is.
      height = std::abs(unit) * diameter / 2;
      if (!far) height *= 1 / std::abs(object + entrance_pupil_z(to_stop, first.object_index));
      break;
    }
    case ApertureSetting::working_f_number: height = std::abs(unit) / image_slope() / (2 * value); break;
    case ApertureSetting::image_na: {
      const double sine = std::min(value / std::abs(first.image_index), 0.999999);
      height = std::abs(unit) / image_slope() * sine / std::sqrt(1 - sine * sine);
      break;
    }
    case ApertureSetting::object_na: {
      const double sine = std::min(value / std::abs(first.object_index), 0.999999);
      height = far ? 0 : std::abs(unit) * sine / std::sqrt(1 - sine * sine);
      break;
    }
    case ApertureSetting::stop_size: break;
  }
  return height;
}

}  // namespace

Import::Import(std::string where, std::string_view format, const GlassCatalogue* glasses)
    : where_(std::move(where)), glasses_(glasses) {
  const std::filesystem::path path = where_;
  lens.id = path.stem().string();
  lens.imported = FileOrigin{std::string(format), path.filename().string()};
}

void Import::warn(int line, std::string_view command, const std::string& message) {
  auto& warnings = lens.imported->warnings;
  if (warnings.size() < most_warnings) {
    warnings.push_back({line, std::string(beginning(command, 60)), message});
  } else {
    ++left_out_;
  }
}

void Import::refuse(int line, std::string_view command, const std::string& found, const std::string& wanted) const {
  std::string text = where_;
  if (line > 0) text += ": line " + std::to_string(line);
  if (!command.empty()) text += ": " + std::string(beginning(command, 60));
  throw Error(text + " is " + found + ", wanted " + wanted);
}

double Import::number(int line, std::string_view command, std::string_view word) const {
  if (const auto value = files_detail::number(word)) return *value;
  refuse(line, command, io_detail::in_quotes(word), "a finite number with a decimal point");
}

const GlassCatalogue& Import::glasses() {
  if (!glasses_) glasses_ = &glass_tables();
  return *glasses_;
}

namespace {

/// The index of a glass, if its range has the wavelength.
std::optional<double> index_at(const Glass& glass, double nm) {
  if (nm < glass.shortest_nm - 1e-6 || nm > glass.longest_nm + 1e-6) return {};
  return refractive_index(glass, nm);
}

/// The medium of a glass: n_d and V_d of its formula.
Medium medium_of(const Glass& glass) {
  Medium medium{.glass = glass.name, .catalogue = glass.catalogue, .nd = index_at(glass, d_line_nm)};
  const auto n_f = index_at(glass, spectral_line_nm("F")), n_c = index_at(glass, spectral_line_nm("C"));
  if (medium.nd && n_f && n_c) {
    const double v = *n_f == *n_c ? 0 : (*medium.nd - 1) / (*n_f - *n_c);
    if (v >= 0 && std::isfinite(v)) medium.vd = v;
  }
  return medium;
}

// n_d of glasses of one name that are two glasses; half a unit of the fourth decimal.
constexpr double another_glass = 0.01, rounded_index = 5e-5;

}  // namespace

const GlassNames& Import::names() {
  if (!names_) names_.emplace(glasses());
  return *names_;
}

Medium Import::glass(int line, std::string_view name, std::span<const std::string> catalogues, std::optional<double> nd,
                     std::optional<double> vd, Numbers numbers) {
  std::string_view asked = name;
  const Glass* found = names().find(asked, catalogues, nd, numbers);
  if (!found) {
    const auto other =
        std::ranges::find_if(other_names, [&](const auto& entry) { return same_bare(entry.first, name); });
    if (other != other_names.end()) found = names().find(other->second, catalogues, nd, numbers);
  }
  // "L-TIM28_MOLD" is a moulded L-TIM28, "NBK7_SCHOTT" an N-BK7.
  bool names_its_maker = false;
  if (const std::size_t tail = name.find_last_of('_'); !found && tail != std::string_view::npos && tail > 0) {
    const std::string maker_name(name.substr(tail + 1));
    found = names().find(name.substr(0, tail), std::array{maker_name}, nd, numbers);
    names_its_maker = found && is_listed(std::array{maker_name}, *found);
    if (names_its_maker) asked = name.substr(0, tail);
  }
  if (found && numbers == Numbers::stated && nd && std::abs(found->nd - *nd) > another_glass) {
    warn(line, name,
         "has n_d " + to_text(*nd, 6) + " in the file; " + describe(*found) +
             " has another, so the file's n_d and V_d are taken");
    return {.glass = std::string(name), .nd = *nd, .vd = vd};
  }
  if (found) {
    if (!same_bare(asked, found->name)) {
      warn(line, name, "is in no glass table; " + describe(*found) + " is taken for it");
    } else if (!catalogues.empty() && !names_its_maker && !is_listed(catalogues, *found)) {
      std::string list;
      for (const std::string& c : catalogues) list += (list.empty() ? "" : ", ") + c;
      warn(line, name, "is not in the catalogues of the file (" + list + "); " + describe(*found) + " is taken for it");
    } else if (const std::string others = names().others(*found, catalogues, nd); !names_its_maker && !others.empty()) {
      warn(line, name, "is in several catalogues; " + describe(*found) + " is taken, not " + others);
    }
    Medium medium = medium_of(*found);
    // Other melts and moulded glasses have their own index.
    if (numbers == Numbers::stated && nd && medium.nd && std::abs(*medium.nd - *nd) > rounded_index) medium.nd = nd;
    return medium;
  }

  if (nd && *nd > 0 && *nd <= 5) {
    std::string message = "is in no glass table; n_d " + to_text(*nd, 6) +
                          (vd ? " and V_d " + to_text(*vd, 4) + " of the file are" : " of the file is") + " taken";
    for (const Glass* nearest : nearest_glasses(glasses(), *nd, vd, 1)) {
      message += "; the nearest glass is " + describe(*nearest);
    }
    warn(line, name, message);
    return {.glass = std::string(name), .nd = *nd, .vd = vd};
  }

  const std::string alike = media_detail::similar_names(glasses(), name);
  refuse(line, name, "in no glass table and has no index in the file",
         "a glass of ReadOptions::glasses (programs: --glasses FILE, an .agf or .yml)" +
             (alike.empty() ? std::string() : "; names like it: " + alike));
}

/// Changes the reference to the primary wavelength of the design if a glass has no index at the d line.
Prescription Import::with_reference(Prescription rows) const {
  std::vector<Medium*> media{&rows.object_space};
  for (SurfaceRow& row : rows.surfaces) media.push_back(&row.medium);
  for (Configuration& c : rows.configurations) {
    for (SurfaceChange& change : c.changes) {
      if (change.medium) media.push_back(&*change.medium);
    }
  }
  const auto unknown = [](const Medium* m) { return m->glass && !m->nd; };
  if (lens.design.wavelengths.empty() || std::ranges::none_of(media, unknown)) return rows;
  const double from = rows.reference_wavelength_nm, to = lens.design.wavelengths[lens.design.primary_wavelength].nm;
  rows.reference_wavelength_nm = to;
  try {
    for (Medium* m : media) {
      if (m->glass && m->catalogue && glasses_) {
        const Glass* glass = glass_of(*m, *glasses_);
        const auto before = index_at(*glass, from);
        const double after = refractive_index(*glass, to);
        m->nd = m->nd && before ? *m->nd + after - *before : after;
      } else if (m->nd && m->vd && *m->vd > 0) {
        m->nd = *m->nd + abbe_index(*m->nd, *m->vd, to) - abbe_index(*m->nd, *m->vd, from);
      }
    }
  } catch (const Error& error) {
    throw Error(where_ + ": primary wavelength: " + error.what());
  }
  return rows;
}

Lens Import::at_primary_wavelength(const Prescription& rows) {
  const DesignData& design = lens.design;
  const double nm =
      design.wavelengths.empty() ? rows.reference_wavelength_nm : design.wavelengths[design.primary_wavelength].nm;
  return compile(rows, std::array{nm}, {.glasses = &glasses(), .missing_glass = MissingGlass::abbe});
}

void Import::mark_a_stop() {
  const auto marked = std::ranges::find_if(lens.surfaces, [](const SurfaceRow& row) { return row.stop; });
  if (marked != lens.surfaces.end()) return;
  lens.surfaces.front().stop = true;
  warn(0, "stop", "no surface is marked as the stop; the first one is taken");
}

void Import::size_the_stop() {
  const auto stop = std::ranges::find_if(lens.surfaces, [](const SurfaceRow& row) { return row.stop; });
  const auto& aperture = lens.design.aperture;
  if (stop->semi_diameter && !std::isinf(*stop->semi_diameter)) return compare_the_stop(*stop->semi_diameter);
  if (!aperture || aperture->setting == ApertureSetting::stop_size || !(aperture->value > 0)) {
    warn(0, "stop", "neither the size of the stop nor an aperture is given; the rims limit the beam");
    return;
  }
  const int surface = static_cast<int>(stop - lens.surfaces.begin());
  const double height = marginal_height_at_the_stop(configured(lens, 0), *aperture, *this);
  if (!(height > 0 && std::isfinite(height))) {
    warn(0, "stop", "the declared aperture does not give its size; the rims limit the beam");
    return;
  }
  lens.stop_size = "from the declared " + std::string(name(aperture->setting)) + " of " + to_text(aperture->value, 8);
  // The stop opens and closes as the lens zooms.
  for (std::size_t i = 0; i < lens.configurations.size(); ++i) {
    Configuration& c = lens.configurations[i];
    DesignAperture own = *aperture;
    if (c.f_number && own.setting == ApertureSetting::f_number) own.value = *c.f_number;
    const double size = marginal_height_at_the_stop(configured(lens, i), own, *this);
    if (c.stop || !(size > 0 && std::isfinite(size)) || std::abs(size - height) <= 1e-9 * height) continue;
    SurfaceChange& change = change_of(c, surface);
    if (!change.semi_diameter) change.semi_diameter = size;
  }
  stop->semi_diameter = height;
}

/// A rim of the stop and an aperture of the design may be two sizes of the beam.
void Import::compare_the_stop(double rim) {
  const auto& aperture = lens.design.aperture;
  if (!aperture || aperture->setting == ApertureSetting::stop_size || !(aperture->value > 0)) return;
  if (aperture->setting == ApertureSetting::f_number) return;  // lint() compares f-numbers
  const double height = marginal_height_at_the_stop(configured(lens, 0), *aperture, *this);
  if (!(height > 0) || !std::isfinite(height) || std::abs(height - rim) <= 0.01 * rim) return;
  warn(0, "stop",
       "its rim has a semi-diameter of " + to_text(rim, 6) + " mm, the declared " +
           std::string(name(aperture->setting)) + " of " + to_text(aperture->value, 6) + " wants " +
           to_text(height, 6) + " mm; the rim is taken");
}

/// What the file declares and the lens misses, as lint() finds it.
void Import::compare_the_declared() {
  using enum FindingKind;
  for (const Finding& finding : glasses_ ? lint(lens, *glasses_) : lint(lens)) {
    const bool declared =
        finding.kind == focal_length || finding.kind == units || finding.kind == apertures || finding.kind == f_number;
    if (declared) warn(0, name(finding.kind), finding.message);
  }
}

void Import::declare() {
  const auto& aperture = lens.design.aperture;
  if (aperture && aperture->setting == ApertureSetting::f_number && aperture->value > 0 && !lens.f_number) {
    lens.f_number = aperture->value;
  }
  double largest = 0;
  for (const DesignField& field : lens.design.fields) largest = std::max(largest, std::hypot(field.x, field.y));
  if (largest == 0) return;
  switch (lens.design.field_kind) {
    case FieldKind::angle_deg:
      if (!lens.half_field_deg && largest < 180) lens.half_field_deg = largest;
      break;
    case FieldKind::paraxial_image:
    case FieldKind::real_image_height:
      if (!lens.image_diagonal_mm) lens.image_diagonal_mm = 2 * largest;
      break;
    case FieldKind::object_height: break;
  }
}

Prescription Import::finish() {
  FileOrigin& origin = *lens.imported;
  if (lens.name.empty()) lens.name = origin.title.empty() ? lens.id : origin.title;
  if (lens.source_design.empty()) lens.source_design = origin.title;
  lens.source_numbers = origin.file;
  if (lens.surfaces.empty()) throw Error(where_ + ": no surfaces, wanted at least one");
  mark_a_stop();
  lens = with_reference(lens);
  validate(lens, where_);
  size_the_stop();
  declare();
  try {
    compare_the_declared();
  } catch (const Error&) {
    // a lens whose f-number cannot be computed misses none
  }
  if (left_out_ > 0) {
    origin.warnings.push_back({0, "file", std::to_string(left_out_) + " more warnings are left out"});
  }
  validate(lens, where_);
  return std::move(lens);
}

SurfaceChange& change_of(Configuration& configuration, int surface) {
  auto& changes = configuration.changes;
  const auto known = std::ranges::find(changes, surface, &SurfaceChange::surface);
  if (known != changes.end()) return *known;
  SurfaceChange& change = changes.emplace_back();
  change.surface = surface;
  return change;
}

std::optional<Medium> medium_of_code(std::string_view code) {
  // "517642" and "517.642"; with more digits "51680.6417" and "620410.603236".
  const std::size_t point = code.find('.');
  const std::string_view left = code.substr(0, point);
  const std::string_view right = point == std::string_view::npos ? std::string_view() : code.substr(point + 1);
  const auto digits = [](std::string_view text) {
    return !text.empty() && text.size() <= 12 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  std::string_view index = left, abbe = right;
  if (point == std::string_view::npos) {
    if (left.size() != 6) return {};
    index = left.substr(0, 3), abbe = left.substr(3);
  }
  if (!digits(index) || !digits(abbe) || index.size() < 3 || abbe.size() < 2) return {};
  const auto decimal = [](std::string_view whole, std::string_view rest) {
    return *files_detail::number(std::string(whole).append(".").append(rest));
  };
  const double vd = decimal(abbe.substr(0, 2), abbe.substr(2));
  if (!(vd > 0)) return {};
  return Medium{.glass = std::string(code), .nd = decimal("1", index), .vd = vd};
}

}  // namespace petzval::inline v0::files_detail
