// SPDX-License-Identifier: Apache-2.0
#include "import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "declared_beam.hpp"
#include "glass/similar_names.hpp"
#include "io/json.hpp"
#include "petzval/analysis/lint.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/medium.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using glass_detail::same_bare;

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

/// The stop in one position: its rim in the file, and the declared marginal ray.
struct StopSize {
  std::size_t surface = 0;
  std::optional<double> rim{};     ///< absent: open
  std::optional<double> height{};  ///< marginal ray at the stop; nullopt if the aperture does not determine the ray

  bool clips_the_beam() const { return rim && height && *rim < 0.99 * *height; }
  /// The smaller of both; nullopt if both are unknown. Equal within the digits of files, the rim is taken.
  std::optional<double> semi_diameter() const {
    constexpr double digits = 1e-6;
    if (!height || (rim && *rim <= *height * (1 + digits))) return rim;
    return height;
  }
};

/// The stop has a size in each position: it opens and closes as the lens zooms.
void set_the_stop(Prescription& lens, std::span<const StopSize> sizes) {
  const std::size_t marked = stop_of(lens);
  const std::optional<double> old = lens.surfaces[marked].semi_diameter;
  if (sizes.front().surface == marked) lens.surfaces[marked].semi_diameter = sizes.front().semi_diameter();
  const bool changed = lens.surfaces[marked].semi_diameter != old;
  for (std::size_t i = 0; i < lens.configurations.size(); ++i) {
    Configuration& c = lens.configurations[i];
    const auto size = sizes[i].semi_diameter();
    const auto known = std::ranges::find(c.changes, static_cast<int>(sizes[i].surface), &SurfaceChange::surface);
    const auto now = known != c.changes.end() && known->semi_diameter ? known->semi_diameter
                                                                      : lens.surfaces[sizes[i].surface].semi_diameter;
    if (size && !(now && std::abs(*now - *size) <= 1e-9 * *size)) {
      change_of(c, static_cast<int>(sizes[i].surface)).semi_diameter = size;
    }
    if (sizes[i].surface == marked || !changed) continue;
    SurfaceChange& other =
        change_of(c, static_cast<int>(marked));  // no stop in this position: keeps the rim of the file
    if (!other.semi_diameter) other.semi_diameter = old.value_or(std::numeric_limits<double>::infinity());
  }
}

}  // namespace

Import::Import(std::string where, std::string_view format, const ReadOptions& options)
    : where_(std::move(where)), entry_(options.entry), glasses_(options.glasses) {
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

void Import::must_be(int line, std::string_view parameter, const std::string& value, const std::string& rule) const {
  throw Error(where_ + ':' + std::to_string(line) + ": " + std::string(beginning(parameter, 60)) + " = " + value +
              "; must be " + rule);
}

double Import::number(int line, std::string_view command, std::string_view word) const {
  if (const auto value = formats_detail::number(word)) return *value;
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

  const std::string alike = glass_detail::similar_names(glasses(), name);
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
  if (nm == rows.reference_wavelength_nm) return compiled(rows);
  return compile(rows, std::array{nm}, {.glasses = &glasses(), .missing_glass = MissingGlass::abbe});
}

void Import::mark_a_stop() {
  const auto marked = std::ranges::find_if(lens.surfaces, [](const SurfaceRow& row) { return row.stop; });
  if (marked != lens.surfaces.end()) return;
  lens.surfaces.front().stop = true;
  warn(0, "stop", "no surface is marked as the stop; the first one is taken");
}

/// A declared aperture launches the beam and the rim of the stop clips it, so the smaller one is the size of the stop.
void Import::size_the_stop() {
  const auto& aperture = lens.design.aperture;
  const bool declared = aperture && aperture->setting != ApertureSetting::stop_size && aperture->value > 0 &&
                        std::isfinite(aperture->value);
  const auto at_primary = [&](const Prescription& rows) {
    try {
      return at_primary_wavelength(rows);
    } catch (const Error&) {
      return compiled(rows);  // the wavelength is outside the range of a glass
    }
  };
  std::vector<StopSize> sizes(std::max<std::size_t>(lens.configurations.size(), 1));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Prescription rows = configured(lens, i);
    StopSize& size = sizes[i];
    size.surface = stop_of(rows);
    size.rim = rows.surfaces[size.surface].semi_diameter;
    if (size.rim && std::isinf(*size.rim)) size.rim.reset();
    if (!declared) break;
    DesignAperture own = *aperture;
    const bool by_position = i < lens.configurations.size() && own.setting == ApertureSetting::f_number;
    if (by_position) own.value = lens.configurations[i].f_number.value_or(own.value);
    if (i < position_apertures.size()) own.value = position_apertures[i].value_or(own.value);
    const double height =
        marginal_height_at_the_stop(at_primary(without_rims(rows)), size.surface, lens.design.object_distance_mm, own);
    if (height > 0 && std::isfinite(height)) size.height = height;
  }
  const StopSize& first = sizes.front();
  if (!first.height) {
    if (first.rim) return;
    return warn(0, "stop",
                declared ? "the declared aperture does not give its size; the rims limit the beam"
                         : "neither the size of the stop nor an aperture is given; the rims limit the beam");
  }
  const std::string beam =
      "the declared " + std::string(name(aperture->setting)) + " of " + to_text(aperture->value, 6);
  if (nominal_aperture && first.rim) {
    // lint() compares f-numbers
    if (aperture->setting == ApertureSetting::f_number || std::abs(*first.height / *first.rim - 1) <= 0.01) return;
    return warn(0, "stop",
                "its rim has a semi-diameter of " + to_text(*first.rim, 6) + " mm; " + beam + " needs " +
                    to_text(*first.height, 6) + " mm; the rim is taken");
  }
  for (StopSize& size : sizes) {
    if (nominal_aperture && size.rim) size.height.reset();
  }
  if (first.semi_diameter() == first.height) lens.stop_size = "from " + beam;
  has_declared_beam_ = !nominal_aperture;
  const auto clipped = std::ranges::find_if(sizes, &StopSize::clips_the_beam);
  if (clipped != sizes.end()) {
    warn(0, "stop",
         "the rim of " + to_text(*clipped->rim, 6) + " mm clips " + beam + ", whose marginal ray meets the stop at " +
             to_text(*clipped->height, 6) + " mm" +
             (sizes.size() > 1 ? ", in " + lens.configurations[static_cast<std::size_t>(clipped - sizes.begin())].name
                               : std::string()));
  }
  set_the_stop(lens, sizes);
}

/// What the file declares and the lens misses, as lint() finds it.
void Import::compare_the_declared() {
  using enum FindingKind;
  for (const Finding& finding : glasses_ ? lint(lens, *glasses_) : lint(lens)) {
    const bool declared = finding.kind == focal_length || finding.kind == units || finding.kind == apertures ||
                          (finding.kind == f_number && !has_declared_beam_);
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
    return *formats_detail::number(std::string(whole).append(".").append(rest));
  };
  const double vd = decimal(abbe.substr(0, 2), abbe.substr(2));
  if (!(vd > 0)) return {};
  return Medium{.glass = std::string(code), .nd = decimal("1", index), .vd = vd};
}

}  // namespace petzval::formats_detail
