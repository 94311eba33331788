// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "petzval/analysis/colour.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// The fraction of unpolarised light that the surfaces of a lens pass along a ray. Clear apertures do not matter.
///
/// The product of the fractions of the surfaces: surface_light() at refracting surfaces, its reflectance at mirrors.
/// Surfaces whose coating is unknown (LensSurface::coating) are uncoated; such mirrors lose nothing. with_coating()
/// sets a coating.
///
/// @param lens        the lens
/// @param ray         in object space if it travels to the film, else behind the lens
/// @param wavelength  a compiled wavelength
/// @param travel      direction of travel; the reversed ray has the same transmittance
/// @return            nullopt if the ray does not pass the lens
/// @throws Error      if the wavelength is outside a table of reflectances or is not compiled
///
/// Limitations: light is unpolarised again in front of each surface; bulk absorption is not modelled.
PETZVAL_API std::optional<double> transmittance(const Lens& lens, const Ray<double>& ray, Wavelength wavelength = {},
                                                Travel travel = Travel::to_film);

/// The mean transmittance() over the vignetted pupil of a scene point; nullopt if no ray passes.
///
/// @throws Error  under the conditions of transmittance() of a ray and of aim()
///
/// Accuracy: 1e-5 (tests/analysis/transmittance_test.cpp).
PETZVAL_API std::optional<double> transmittance(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {});

/// The effect of the transmittance of the axis on white light.
struct LensColour {
  double luminous_transmittance = 0;  ///< of CIE Y
  double t_stop = 0;                  ///< f-number by exact rays divided by the root of luminous_transmittance
  std::array<double, 2> xy{};         ///< CIE 1931 chromaticity of the light behind the lens
  std::array<double, 2> light_xy{};   ///< chromaticity of the light
};

/// T-stop and colour of a lens on the axis.
///
/// @param lens      the lens, compiled for several wavelengths of the visible spectrum; its transmittance is linear
///                  between them and constant outside
/// @param subject_z subject plane (lens frame, mm); -inf at infinity
/// @param light     the light
/// @param table     the colour matching functions
/// @return          nullopt if no ray passes
/// @throws Error    under the conditions of transmittance(), real_f_number() and tristimulus()
PETZVAL_API std::optional<LensColour> lens_colour(const Lens& lens, double subject_z, const Spectrum& light,
                                                  const ColourMatching& table);

}  // namespace petzval
