// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

struct LayoutOptions {
  std::size_t rays = 5;            ///< transmitted rays per field, 3 to 7
  Meridian section = Meridian::y;  ///< the plane of the drawing and of the fields
};

/// Draws a scaled section of a lens through the axis as SVG text: light from left to right, +y up.
///
/// Glass is filled, darker for a higher index; mirrors are thick lines; central holes stay open. Two ticks mark the rim
/// of the stop. They are dashed if the lens has no marked stop and the surface that limits the axial beam is used
/// instead. A line shows the film. The rays of a field have one colour and cross its vignetted pupil from edge to edge,
/// including the chief ray. Vignetted rays through the rim or the centre of the stop are thin and end at the surface
/// that clips the ray. Surfaces without a rim are drawn up to the outermost ray. The output is deterministic.
///
/// @param lens        the lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad), also 90 degrees or more; empty: no rays are drawn
/// @param options     number of rays and section
/// @throws Error      if the number of rays is not 3 to 7; also under the conditions of aim()
PETZVAL_API std::string layout_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                      const LayoutOptions& options = {});

/// Draws the vignetted pupil of each field at the primary wavelength as SVG text.
///
/// A cell shows the transmitting region of the PupilPlane, its boundary with one colour per limiting surface, and the
/// paraxial entrance pupil dashed. All cells have the same scale, x to the right and +y up. The area relative to the
/// axis and the relative illumination are printed below. If the pupil is far from the paraxial pupil, the cell shows
/// the pupil only and prints the distance. The output is deterministic.
///
/// @param lens        the lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad)
/// @throws Error      if there are no fields; also under the conditions of pupil_boundary()
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

/// Draws relative illumination against field angle at the primary wavelength, with cos^4 for comparison, as SVG text.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is not positive; also under the conditions of relative_illumination()
PETZVAL_API std::string illumination_figure(const Lens& lens, double subject_z, double field_rad);

}  // namespace petzval
