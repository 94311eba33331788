// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/psf/spot.hpp"

namespace petzval::inline v0 {

/// A spot diagram as SVG text: a row for each field; first a column with all wavelengths, then one for each.
///
/// All cells have one scale, named by a bar, and the origin of a row is the centroid of all its rays, so that lateral
/// colour shows between its cells; +y is up. Under each cell stand RMS and largest radius about the centroid of what it
/// holds. Dashed is the Airy circle, 1.22 wavelength N, N the paraxial f-number on the film's side. Only the first 600
/// rays of a spot are drawn. No date, no fonts beyond sans-serif: the same spots give the same bytes.
///
/// spots: as spot_diagram gives them for this lens.
/// Throws Error for no spots, or some that do not fill fields by the lens's wavelengths.
PETZVAL_API std::string spot_figure(const Lens& lens, std::span<const Spot> spots);

}  // namespace petzval::inline v0
