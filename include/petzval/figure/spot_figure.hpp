// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// A spot diagram as SVG text: a row for each field, with a column for all wavelengths and one for each of them.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a row is the centroid of all its rays, so
/// that its cells show lateral colour. RMS and largest radius about the centroid of a cell's rays are printed below it.
/// The dashed Airy circle has the radius 1.22 wavelength N, with the paraxial image-side f-number N. The first 600 rays
/// of a spot are drawn. The same spots give the same bytes.
///
/// @param spots               as spot_diagram gives them for this lens
/// @param wavelength_weights  one per compiled wavelength, by the light in it: of the column of all wavelengths; empty:
///                            equal weights
/// @throws Error  for no spots, a number of spots that is no multiple of the number of wavelengths, and weights that
///                are not one per wavelength, below 0, or all 0
PETZVAL_API std::string spot_figure(const Lens& lens, std::span<const Spot> spots,
                                    std::span<const double> wavelength_weights = {});

}  // namespace petzval
