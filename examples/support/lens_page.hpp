// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "lens_report.hpp"

namespace examples {

/// Options of the figures of a report.
struct PageOptions {
  std::vector<double> field_deg;  ///< empty: the axis, 0.7 and 1 of the declared half field
  double subject_mm = std::numeric_limits<double>::infinity();  ///< from the front vertex
  petzval::Lens colours;  ///< the lens for the wavelengths of the spots and the focus curve
};

struct LensFigure {
  std::string name;  ///< "layout"; its file is LENS_layout.svg
  std::string title, caption;
  std::string svg;
};

/// The figures of a lens; only the layout, without rays, if nothing limits the beam. Throws petzval::Error for fields
/// and subjects that the lens cannot see.
std::vector<LensFigure> lens_figures(const Report& report, const PageOptions& options);

/// A page with the figures, the numbers, the prescription and its sources. It needs no other file.
std::string lens_page(const Report& report, const std::vector<LensFigure>& figures);

}  // namespace examples
