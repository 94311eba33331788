// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "files.hpp"
#include "lens_report.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/ghosts/ghosts.hpp"

namespace examples {

/// Adds --coatings. by_default: the default in words.
Option* add_coatings(App& app, std::string& coatings, const std::string& by_default);

/// The coating that --coatings names. @throws petzval::Error if the name is unknown or the file is invalid
petzval::Coating coating_named(const std::string& name);

/// The lens with the coating of --coatings, or with the coatings of its file if `coatings` is "file" or empty; nullopt
/// if it is empty and the file states no coatings: losses are not modelled.
/// @throws petzval::Error if the name is unknown or the file is invalid
std::optional<petzval::Lens> coated(const petzval::Lens& lens, const std::string& coatings);

/// Light that passes a lens with coatings.
struct LightReport {
  std::string coatings;                         ///< as --coatings; empty: of the file
  std::vector<int> uncoated;                    ///< surfaces to air for which the file states no coating
  petzval::Lens colours;                        ///< the lens at the wavelengths of the report
  std::vector<double> fields_deg;               ///< fields of the report
  petzval::Grid<std::optional<double>> values;  ///< petzval::transmittance() of `colours` at these fields
  /// The lens at 400 to 700 nm, less if a table of reflectances covers less; nullopt if its indices are unknown.
  std::optional<petzval::Lens> visible;
  std::optional<petzval::LensColour> colour;  ///< in daylight (D65); nullopt: no ray passes or no `visible`
  std::optional<double> t_stop{};             ///< petzval::ApertureState::t_number; nullopt: no ray passes
};

/// Wavelengths from 400 to 700 nm in steps of 10 that all tables of reflectances of the lens cover; empty if there are
/// less than two.
std::vector<double> visible_wavelengths(const petzval::Lens& lens);

/// The lens at visible_wavelengths() of a coated lens, as its file states it; nullopt if its media have indices at one
/// wavelength only.
std::optional<petzval::Lens> visible_lens(const LoadedLens& loaded, const petzval::Lens& coated);

/// Daylight (D65) behind a lens at visible wavelengths; nullopt if no ray passes.
std::optional<petzval::LensColour> daylight_behind(const petzval::Lens& visible, double subject_z);

/// @param colours  the coated lens at the wavelengths of the report
/// @param visible  the coated lens at visible_wavelengths()
/// @throws petzval::Error under the conditions of petzval::transmittance() and petzval::lens_colour()
LightReport report_light(const Report& report, const std::string& coatings, const petzval::Lens& colours,
                         const std::optional<petzval::Lens>& visible);

/// Ghosts of a point of light at 0.7 of the largest field, for several coatings.
struct GhostReport {
  struct Column {
    std::string coatings;
    double glare = 0;  ///< energy of all pairs, as a fraction of the light that enters
    std::vector<double> energies{};
  };
  double field_deg = 0;
  std::vector<petzval::GhostPair> pairs{};  ///< the ten brightest without coatings
  std::vector<Column> columns{};            ///< with energies of `pairs`
  std::size_t left_out = 0;                 ///< number of pairs that were not computed
  std::string failure{};                    ///< the reason if ghosts cannot be computed
};

/// The ghosts without coatings, with one layer of magnesium fluoride, and with the coatings of `light` if there are
/// any, at the primary wavelength.
GhostReport report_ghosts(const Report& report, const std::optional<LightReport>& light);

/// The keys transmittance, t_stop, colour, coatings and uncoated_surfaces; null without a report.
Json to_json(const std::optional<LightReport>& light);
std::string to_text(const LightReport& light);
/// "coatings: of the file; surfaces 3 and 5 to air have none and are uncoated".
std::string coatings_in_words(const LightReport& light);
/// "T-stop 1.4 at 587.562 nm"; empty without a T-stop.
std::string t_stop_in_words(const LightReport& light);
/// "90 % of daylight D65", then the colour.
std::vector<std::string> colour_in_words(const petzval::LensColour& colour);
Json to_json(const petzval::LensColour& colour);

}  // namespace examples
