// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0 {

struct LayoutOptions {
  std::size_t rays = 5;            ///< that pass, a field: 3 to 7
  Meridian section = Meridian::y;  ///< the plane of the drawing, in which the fields lie too
};

/// A lens cut open, as SVG text: the section through the axis to scale, light from left to right, +y up.
///
/// Glass is filled, darker for a higher index; mirrors are thick lines, central holes stay open; the stop is two ticks
/// at its rim (dashed: no surface is marked, the one that limits the axial beam is meant); a line shows the film. Rays
/// of each field, in its colour, fill what passes of its pupil in the section, from edge to edge and with the chief
/// ray; rays through the stop's rim or centre that the lens does not let pass are thin, up to the surface where they
/// end. Surfaces without a rim are drawn as far as rays need them. All at the compiled wavelength nearest to the d
/// line. The same lens gives the same bytes.
///
/// subject_z: lens frame, mm, -inf at infinity. fields_rad: may be empty (no rays), and 90 degrees or more.
/// Throws Error where aim does, and for a number of rays outside 3 to 7.
PETZVAL_API std::string layout_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                      const LayoutOptions& options = {});

}  // namespace petzval::inline v0
