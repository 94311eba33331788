// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files.hpp"
#include "lens_report.hpp"
#include "petzval/analysis/transmittance.hpp"

namespace examples {

/// The coating of the flag --coatings: none, mgf2 or a CSV file.
/// @throws petzval::Error if the name is unknown or the file is invalid
petzval::Coating coating_named(const std::string& name);

/// Light that passes a lens with coatings.
struct LightReport {
  struct Value {
    double wavelength_nm = 0, field_deg = 0;
    std::optional<double> transmittance;  ///< nullopt: no ray passes
  };
  std::vector<Value> values;                  ///< ordered by field
  std::optional<petzval::LensColour> colour;  ///< in daylight (D65); nullopt: no ray passes
};

/// @param colours  the lens at the wavelengths of the report
/// @param visible  the lens at wavelengths of the visible spectrum
/// @throws petzval::Error under the conditions of petzval::transmittance() and petzval::lens_colour()
LightReport report_light(const Report& report, const petzval::Lens& colours, const petzval::Lens& visible);

/// The keys transmittance, t_stop and colour; null without a report.
Json to_json(const std::optional<LightReport>& light);
std::string to_text(const LightReport& light);

}  // namespace examples
