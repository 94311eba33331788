// SPDX-License-Identifier: Apache-2.0
#include "indices.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.hpp"
#include "glass/similar_names.hpp"
#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {
namespace {

/// The medium in front of the first surface (space 0) or behind surface space - 1; a mirror keeps its medium.
const Medium& medium(const Prescription& p, std::size_t space) {
  return space == 0 ? p.object_space : p.surfaces[space - 1].medium;
}

/// Spectral lines are often written with one decimal, the d line as 587.6 nm. Within half a unit of this decimal,
/// indices change by less than 1e-5.
constexpr double rounded_line_nm = 0.05;

/// Glass tables for the look-up of media, or the error that explains their absence.
struct Tables {
  const GlassCatalogue* glasses = nullptr;
  std::string error{};  ///< set if `glasses` is null
};

/// The given tables, or glass_tables() if a medium names a glass.
Tables tables_for(const Prescription& p, const GlassCatalogue* given) {
  if (given) return {given};
  const bool named = p.object_space.glass || std::ranges::any_of(p.surfaces, [](const SurfaceRow& row) {
                       return row.medium.glass.has_value();
                     });
  if (!named) return {};
  try {
    return {&glass_tables()};
  } catch (const Error& error) {
    return {nullptr, error.what()};
  }
}

std::string describe(const Medium& m) {
  if (!m.glass) return "nd = " + to_text(m.nd.value_or(1)) + " without a glass name";
  return "glass = \"" + *m.glass + '"' + (m.catalogue ? " (catalogue \"" + *m.catalogue + "\")" : "");
}

/// Reason why no glass was found for a medium, appended to its description.
std::string why_missing(const Medium& m, const Tables& tables) {
  if (!m.glass) return "";
  if (!tables.glasses) {
    return "; no glass tables were found (" + tables.error + "); a catalogue must be given";
  }
  std::string others;
  int count = 0;
  for (const Glass& glass : tables.glasses->glasses()) {
    if (!glass_detail::same_bare(glass.name, *m.glass) || ++count > 5) continue;
    others +=
        (others.empty() ? "" : ", ") + glass.name + " (" + glass.catalogue + ", n_d " + to_text(glass.nd, 6) + ")";
  }
  if (others.empty()) return "; is in no glass table";
  if (m.catalogue) return "; is not in this catalogue, other catalogues have " + others;
  if (!m.nd) return "; is in no glass table; similar: " + others;
  return "; its n_d of " + to_text(*m.nd) + " is more than 0.01 from " + others;
}

std::string names_like(const Medium& m, const Tables& tables) {
  if (!m.glass || !tables.glasses) return "";
  const std::string names = glass_detail::similar_names(*tables.glasses, *m.glass);
  return names.empty() ? "" : " (similar names: " + names + ")";
}

/// The absorption of a glass. If its table has no absorption, a glass that the user has added under the same name, with
/// an n_d within 0.002, supplies the absorption.
std::vector<AbsorptionEntry> absorption_of(const Glass* glass, const GlassCatalogue* glasses) {
  if (glass && glass->absorption.empty()) glass = glasses->find(glass->name, glass->nd);
  return glass ? glass->absorption : std::vector<AbsorptionEntry>();
}

/// Wavelengths (nm) at which a medium has an index.
struct Range {
  double shortest, longest;

  bool has(double nm) const { return nm >= shortest - 1e-6 && nm <= longest + 1e-6; }
};
constexpr Range constant_range_nm{0, 1e6};
constexpr Range abbe_model_range_nm{365, 1014};

}  // namespace

Indices indices(const Prescription& prescription, std::span<const double> wavelengths_nm, const CompileOptions& options,
                const std::string& where) {
  for (const double nm : wavelengths_nm) {
    if (!(nm >= 10 && nm <= 1e5)) throw Error(where + ": wavelength = " + to_text(nm) + " nm; must be 10 to 100000 nm");
  }
  const double reference = prescription.reference_wavelength_nm;
  const std::size_t spaces = prescription.surfaces.size() + 1;
  Indices result;
  result.spectrum = Spectrum(wavelengths_nm);
  result.values.resize(spaces * wavelengths_nm.size());
  result.absorption.reserve(spaces);
  const Tables tables = tables_for(prescription, options.glasses);
  bool dispersive = false, known_by_abbe = false, known_by_index = false;

  for (std::size_t space = 0; space < spaces; ++space) {
    const Medium& m = medium(prescription, space);
    const std::string here = where + (space == 0 ? ": object space" : ": surface " + std::to_string(space - 1));
    // Adds the surface to error messages, which otherwise name only the glass.
    const auto ask = [&](const auto& question) {
      try {
        return question();
      } catch (const Error& error) {
        throw Error(here + ": " + error.what());
      }
    };
    const Glass* glass = tables.glasses ? ask([&] { return glass_of(m, *tables.glasses); }) : nullptr;
    result.absorption.push_back(absorption_of(glass, tables.glasses));
    const bool constant = !glass && (m.is_air() || m.vd == 0.0);
    if (!constant) (glass ? dispersive : m.vd ? known_by_abbe : known_by_index) = true;
    std::string missing;
    if (!constant && !glass) {
      missing = here + ": " + describe(m) + why_missing(m, tables);
      result.missing_glasses.push_back(missing);
      if (!m.nd) throw Error(missing + names_like(m, tables) + "; must have n_d, or be a glass of the tables");
    }

    const Range range = constant ? constant_range_nm
                        : glass  ? Range{glass->shortest_nm, glass->longest_nm}
                                 : abbe_model_range_nm;
    const auto usable = [&](double nm) {
      return options.clamp_wavelengths ? std::clamp(nm, range.shortest, range.longest) : nm;
    };
    const auto by_glass = [&](double nm) { return ask([&] { return refractive_index(*glass, usable(nm)); }); };
    const auto by_abbe = [&](double nm) { return ask([&] { return abbe_index(*m.nd, *m.vd, usable(nm)); }); };
    const auto index_at = [&](double nm) -> double {
      const bool at_reference = std::abs(nm - reference) <= 1e-6;
      if (constant) return m.nd.value_or(1);
      if (glass && !m.nd) return by_glass(nm);
      if (at_reference && options.index_policy == IndexPolicy::printed) return *m.nd;
      if (glass) {
        if (options.index_policy == IndexPolicy::catalogue) return by_glass(nm);
        return *m.nd + (by_glass(nm) - by_glass(reference));
      }
      if (options.missing_glass == MissingGlass::error) {
        throw Error(missing + names_like(m, tables) + "; the glass must be known at " + to_text(nm) +
                    " nm, or the index from n_d and V_d must be allowed for missing glasses");
      }
      if (at_reference) return *m.nd;
      if (!m.vd) {
        if (std::abs(nm - reference) <= rounded_line_nm) return *m.nd;
        throw Error(missing + "; without V_d the wavelength must be " + to_text(reference) + " nm, not " + to_text(nm) +
                    " nm");
      }
      return *m.nd + (by_abbe(nm) - by_abbe(reference));
    };
    const auto sound_index_at = [&](double nm) {
      const double n = index_at(nm);
      if (!(n >= 0.1 && n <= 5))
        throw Error(here + ": index at " + to_text(nm) + " nm = " + to_text(n) + "; must be 0.1 to 5");
      return n;
    };
    for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
      result.values[w * spaces + space] = sound_index_at(wavelengths_nm[w]);
    }
    const bool clamped =
        options.clamp_wavelengths && !std::ranges::all_of(wavelengths_nm, [&](double nm) { return range.has(nm); });
    if (clamped) {
      result.clamped_glasses.push_back(here + ": " + describe(m) + ": outside " + to_text(range.shortest, 7) + " to " +
                                       to_text(range.longest, 7) + " nm, the index at the end of this range is used");
    }
    const std::array kinks{range.shortest, range.longest};
    result.spectrum.add(sound_index_at, clamped ? std::span<const double>(kinks) : std::span<const double>());
  }
  result.dispersion = known_by_index  ? Dispersion::none
                      : known_by_abbe ? Dispersion::abbe
                      : dispersive    ? Dispersion::catalogue
                                      : Dispersion::none;
  return result;
}

}  // namespace petzval::lens_detail
