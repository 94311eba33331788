// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/analysis/colour.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// The fraction of unpolarised light that a lens passes along a ray. Clear apertures do not matter.
///
/// The product of the fractions of the surfaces, surface_light() at refracting surfaces and its reflectance at mirrors,
/// and of the internal transmittances of the media between the first and the last surface (Lens::absorption()).
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
/// Limitations: light is unpolarised again in front of each surface. Glasses without a table of absorption, all of
/// data/glass, absorb nothing.
PETZVAL_API std::optional<double> transmittance(const Lens& lens, const Ray<double>& ray, Wavelength wavelength = {},
                                                Travel travel = Travel::to_film);

/// The mean transmittance() over the vignetted pupil of a scene point; nullopt if no ray passes.
///
/// @throws Error  under the conditions of transmittance() of a ray and of aim()
///
/// Accuracy: 1e-5 (tests/analysis/transmittance_test.cpp).
PETZVAL_API std::optional<double> transmittance(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {});

/// The transmittance() of fields at all compiled wavelengths: [field][wavelength]; nullopt if no ray passes.
///
/// @param lens        the lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad)
/// @param threads     number of threads, at least 1
/// @throws Error      under the conditions of transmittance() of a point
PETZVAL_API Grid<std::optional<double>> transmittance(const Lens& lens, double subject_z,
                                                      std::span<const double> fields_rad, int threads = 1);

/// True if a coating is stated for at least one surface (LensSurface::coating), so that the transmittance of the lens
/// is known. Programs state transmittances and T-stops only then.
PETZVAL_API bool states_coatings(const Lens& lens);

/// Refracting surfaces between air (index below 1.01) and another medium without a stated coating. transmittance()
/// takes them as uncoated.
PETZVAL_API std::vector<std::size_t> uncoated_surfaces(const Lens& lens);

/// The f-number of a round pupil with the area of the pupil of the axis. It accounts for blades and central
/// obscurations, but not for losses. The focal length is the geometric mean of both sections.
///
/// @throws Error under the conditions of first_order() and aim()
PETZVAL_API double area_f_number(const Lens& lens, Wavelength wavelength = {});

/// The effect of the transmittance of the axis on white light.
struct LensColour {
  double luminous_transmittance = 0;  ///< of CIE Y
  std::array<double, 2> xy{};         ///< CIE 1931 chromaticity of the light behind the lens
  std::array<double, 2> light_xy{};   ///< chromaticity of the light
  std::optional<double> cct_k{};      ///< correlated_colour_temperature() of the light behind the lens
  std::optional<double> light_cct_k{};
};

/// The colour of a lens on the axis.
///
/// @param lens      the lens, compiled for several wavelengths of the visible spectrum; its transmittance is linear
///                  between them and constant outside
/// @param subject_z subject plane (lens frame, mm); -inf at infinity
/// @param light     the light
/// @param table     the colour matching functions
/// @return          nullopt if no ray or no light passes
/// @throws Error    under the conditions of transmittance() and tristimulus()
PETZVAL_API std::optional<LensColour> lens_colour(const Lens& lens, double subject_z, const Spectrum& light,
                                                  const ColourMatching& table);

/// The f-numbers and the T-stop of a lens, for reports and file formats.
struct ApertureState {
  double f_number = 0;       ///< real_f_number(), the argument of with_f_number() if the lens is stopped down
  double area_f_number = 0;  ///< area_f_number(), at least f_number: with blades and obscurations, without losses
  /// T-stop: area_f_number divided by the root of the transmittance() of the axis at infinity, at the primary
  /// wavelength; nullopt unless a coating is stated (states_coatings()): the losses are unknown.
  std::optional<double> t_number{};
};

/// The aperture state of a lens at its primary wavelength.
///
/// @throws Error under the conditions of real_f_number() and area_f_number(), and of transmittance() if a coating is
///               stated
PETZVAL_API ApertureState aperture_state(const Lens& lens);

}  // namespace petzval
