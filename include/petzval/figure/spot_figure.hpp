// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Draws a spot diagram as SVG text: one row per field, with a column for all wavelengths and one per wavelength.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a row is the centroid of all its rays, so
/// that its cells show lateral colour. Below each cell, the RMS and largest radius about the centroid of its rays are
/// printed. The dashed Airy circle has the radius 1.22 wavelength N, with the paraxial image-side f-number N. The first
/// 600 rays of a spot are drawn. The output is deterministic.
///
/// @param lens                the lens
/// @param spots               result of spot_diagram() for this lens
/// @param wavelength_weights  weights of the compiled wavelengths in the column of all wavelengths; empty: equal
///                            weights
/// @throws Error              if there are no spots or a wrong number of spots, or if the weights are negative, all 0
///                            or of the wrong number
PETZVAL_API std::string spot_figure(const Lens& lens, std::span<const Spot> spots,
                                    std::span<const double> wavelength_weights = {});

}  // namespace petzval
