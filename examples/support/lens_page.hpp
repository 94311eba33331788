// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lens_report.hpp"

namespace examples {

struct LensFigure {
  std::string name;  ///< "layout"; its file is LENS_layout.svg
  std::string title, caption;
  std::string svg;
};

/// The figures of a lens; only the layout, without rays, if nothing limits the beam. colours: the lens for the
/// wavelengths of the report, which the spots and the focus curve show. Throws petzval::Error for fields and subjects
/// that the lens cannot see.
std::vector<LensFigure> lens_figures(const Report& report, const petzval::Lens& colours);

/// A page with the figures, the numbers, the prescription and its sources. It needs no other file.
std::string lens_page(const Report& report, const std::vector<LensFigure>& figures);

}  // namespace examples
