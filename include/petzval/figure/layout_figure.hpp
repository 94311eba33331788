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

}  // namespace petzval::inline v0
