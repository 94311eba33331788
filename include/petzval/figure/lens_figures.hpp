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
  std::size_t rays = 5;            ///< per field, of those that pass: 3 to 7
  Meridian section = Meridian::y;  ///< the plane of the drawing and of the fields
};

/// The section of a lens through the axis, to scale, as SVG text: light from left to right, +y up.
///
/// Glass is filled, darker for a higher index; mirrors are thick lines; central holes stay open. Two ticks mark the rim
/// of the stop (dashed where no surface is marked and the one that limits the axial beam stands in). A line shows the
/// film. The rays of a field have its colour and cross its vignetted pupil from edge to edge, with the chief ray among
/// them. Vignetted rays through the rim or the centre of the stop are thin and end at the surface that stops them.
/// Surfaces without a rim are drawn as far as rays reach. The same lens gives the same bytes.
///
/// subject_z: lens frame, mm, -inf at infinity. fields_rad: may be empty (no rays), and 90 degrees or more.
/// Throws Error where aim does, and for a number of rays outside 3 to 7.
PETZVAL_API std::string layout_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                      const LayoutOptions& options = {});

/// The vignetted pupil of each field, as SVG text. A cell shows the region of the PupilPlane that passes, its boundary
/// in a colour for each limiting surface, and the paraxial entrance pupil dashed. All cells have the same scale, x to
/// the right and +y up. The area over that on the axis and the relative illumination are printed below. Where the pupil
/// lies far from the paraxial one, the cell shows the pupil and prints the distance.
///
/// At the primary wavelength. The same lens gives the same bytes.
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does, and for no fields.
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

/// Relative illumination of the film against the field angle, from the axis to a field, as SVG text, with cos^4 of the
/// angle for comparison. At the primary wavelength.
///
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where relative_illumination does, and for a field that is
/// not above 0.
PETZVAL_API std::string illumination_figure(const Lens& lens, double subject_z, double field_rad);

}  // namespace petzval
