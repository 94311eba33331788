// SPDX-License-Identifier: Apache-2.0
#include "indices.hpp"

#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/media/glass.hpp"

namespace petzval::inline v0::lens_detail {
namespace {

/// The medium in front of the first surface or behind surface space - 1 (at a mirror, the medium light stays in).
const Medium& medium(const Prescription& p, std::size_t space) {
  return space == 0 ? p.object_space : p.surfaces[space - 1].medium;
}

/// Lines are often written with one decimal, the d line as 587.6 nm. Within half a unit of that no index changes by
/// 1e-5.
constexpr double rounded_line_nm = 0.05;

bool is_air(const Medium& m) { return !m.glass && m.nd == 1.0; }

const Glass* find(const GlassCatalogue* glasses, const Medium& m) {
  if (!glasses || !m.glass) return nullptr;
  return m.catalogue ? glasses->find(*m.glass, *m.catalogue) : glasses->find(*m.glass, m.nd);
}

std::string describe(const Medium& m) {
  if (!m.glass) return "a medium of index " + to_text(m.nd) + " without a glass name";
  return "glass \"" + *m.glass + "\"" + (m.catalogue ? " of catalogue \"" + *m.catalogue + "\"" : "");
}

}  // namespace

Indices indices(const Prescription& prescription, std::span<const double> wavelengths_nm, const CompileOptions& options,
                const std::string& where) {
  for (const double nm : wavelengths_nm) {
    if (!(nm >= 10 && nm <= 1e5)) throw Error(where + ": wavelength is " + to_text(nm) + " nm, wanted 10 to 100000 nm");
  }
  const double reference = prescription.reference_wavelength_nm;
  const std::size_t spaces = prescription.surfaces.size() + 1;
  Indices result;
  result.spectrum = Spectrum(wavelengths_nm);
  result.values.resize(spaces * wavelengths_nm.size());
  bool dispersive = false, known_by_abbe = false, known_by_index = false;

  for (std::size_t space = 0; space < spaces; ++space) {
    const Medium& m = medium(prescription, space);
    const std::string here = where + (space == 0 ? ": object space" : ": surface " + std::to_string(space - 1));
    const Glass* glass = find(options.glasses, m);
    if (!is_air(m)) {
      (glass ? dispersive : m.vd ? known_by_abbe : known_by_index) = true;
      if (!glass) result.missing_glasses.push_back(here + ": " + describe(m) + " is in no glass table");
    }

    // Errors of media/ name no surface.
    const auto ask = [&](const auto& question) {
      try {
        return question();
      } catch (const Error& error) {
        throw Error(here + ": " + error.what());
      }
    };
    const auto by_glass = [&](double nm) { return ask([&] { return refractive_index(*glass, nm); }); };
    const auto by_abbe = [&](double nm) { return ask([&] { return abbe_index(m.nd, *m.vd, nm); }); };
    const auto index_at = [&](double nm) -> double {
      const bool at_reference = std::abs(nm - reference) <= 1e-6;
      if (is_air(m)) return 1.0;
      if (at_reference && options.index_policy == IndexPolicy::printed) return m.nd;
      if (glass) {
        if (options.index_policy == IndexPolicy::catalogue) return by_glass(nm);
        return m.nd + (by_glass(nm) - by_glass(reference));
      }
      const std::string missing = here + ": " + describe(m) + " is in no glass table";
      if (options.missing_glass == MissingGlass::error) {
        throw Error(missing + ", wanted one for its index at " + to_text(nm) +
                    " nm (or the n_d/V_d model, on request)");
      }
      if (at_reference) return m.nd;
      if (!m.vd) {
        if (std::abs(nm - reference) <= rounded_line_nm) return m.nd;
        throw Error(missing + " and has no V_d, wanted one of them for its index at " + to_text(nm) + " nm (only " +
                    to_text(reference) + " nm can be used)");
      }
      return m.nd + (by_abbe(nm) - by_abbe(reference));
    };
    const auto sound_index_at = [&](double nm) {
      const double n = index_at(nm);
      if (!(n >= 0.1 && n <= 5))
        throw Error(here + ": index at " + to_text(nm) + " nm is " + to_text(n) + ", wanted 0.1 <= n <= 5");
      return n;
    };
    for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
      result.values[w * spaces + space] = sound_index_at(wavelengths_nm[w]);
    }
    result.spectrum.add(sound_index_at);
  }
  result.dispersion = known_by_index  ? Dispersion::none
                      : known_by_abbe ? Dispersion::abbe
                      : dispersive    ? Dispersion::catalogue
                                      : Dispersion::none;
  return result;
}

}  // namespace petzval::inline v0::lens_detail
