// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "petzval/analysis/psf.hpp"
#include "petzval/core/export.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// The picture of a PSF: irradiance on the film as a share of the light on the paraxial entrance pupil, per mm^2.
/// Pictures of one light through different lenses and apertures have the same scale; the sum of all pixels times the
/// area of one is the throughput, less the rays outside the picture.
///
/// It shows the film as a photograph does, turned by half a turn: to the left and down are +x and +y of the film, and a
/// light beyond the focus shows the iris upright.
///
/// weights: a linear RGB triple for each wavelength, as rgb_weights gives them. Throws Error for another number of
/// them, and for a PSF without a count for each pixel and wavelength.
PETZVAL_API RgbImage render(const Psf& psf, std::span<const std::array<double, 3>> weights);

/// The same by wavelength, for write_exr(): a channel for each, and R, G, B of render() for viewers.
///
/// The channel of 587.5618 nm is S0.587,5618nm (a point would begin a layer). Its values are those of render() for the
/// light of that wavelength alone, whatever its weight. Its attributes say the version of the layout and the
/// unit, mm^-2. Throws Error where render() does.
/// Source: Fichet, Pacanowski, Wilkie, An OpenEXR Layout for Spectral Images, JCGT 10(3), 2021.
PETZVAL_API ExrPart spectral_image(const Psf& psf, std::span<const std::array<double, 3>> weights);

}  // namespace petzval
