// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lens_light.hpp"
#include "lens_report.hpp"

namespace examples {

struct LensFigure {
  std::string name;  ///< "layout"; its file is LENS_layout.svg
  std::string title, caption;
  std::string svg;
};

/// The figures of a lens; only the layout, without rays, if no rim limits the beam.
///
/// @param aberrations  lens_report() of the lens at all wavelengths of the light
/// @param light        with coatings; its transmittances are drawn
/// @throws petzval::Error if the lens cannot see a field or the subject
std::vector<LensFigure> lens_figures(const Report& report, const petzval::LensReport& aberrations,
                                     const std::optional<LightReport>& light);

/// A self-contained HTML page with the figures, the numbers, the prescription and its sources. light: with coatings.
std::string lens_page(const Report& report, const petzval::LensReport& aberrations,
                      const std::vector<LensFigure>& figures, const std::optional<LightReport>& light,
                      const GhostReport& ghosts);

}  // namespace examples
