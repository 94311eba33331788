// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/io/image.hpp"
#include "petzval/psf/psf.hpp"

namespace petzval::inline v0 {

/// The picture of a PSF: irradiance on the film, per mm^2 and in units of the light that falls onto the paraxial
/// entrance pupil, so that pictures of one light through different lenses and apertures compare, and the pixels' sum
/// times their area is the throughput (less what the crop lost). Rows from the top.
///
/// weights: one linear RGB triple a wavelength, as rgb_weights gives them; the light of all wavelengths is then white.
/// Throws Error where their number is not that of the wavelengths.
PETZVAL_API RgbImage render(const Psf& psf, std::span<const std::array<double, 3>> weights);

}  // namespace petzval::inline v0
