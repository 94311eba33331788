// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval {

/// One layer of a coating.
struct CoatingLayer {
  double index = 1;         ///< refractive index, the same at all wavelengths
  double absorption = 0;    ///< k of the complex index n + i k
  double thickness_nm = 0;  ///< 0: no layer

  bool operator==(const CoatingLayer&) const = default;
};

/// One entry of a table of reflectances.
struct ReflectanceEntry {
  double wavelength_nm = 0, reflectance = 0;

  bool operator==(const ReflectanceEntry&) const = default;
};

/// The coating of a surface: layers, or a table of reflectances without absorption. Neither: an uncoated surface.
struct Coating {
  /// The first layer is next to the medium in front of the surface, on the object side.
  std::vector<CoatingLayer> layers{};
  /// Reflectance over wavelength for every angle, used instead of `layers`; linear between entries with increasing
  /// wavelengths.
  std::vector<ReflectanceEntry> table{};

  /// A single layer with an optical thickness of a quarter of a wavelength; by default magnesium fluoride.
  PETZVAL_API static Coating quarter_wave(double index = 1.38, double wavelength_nm = 550);

  bool operator==(const Coating&) const = default;
};

/// @throws Error that names `what` if the coating has layers and a table, an index or a thickness is negative or not
///               finite, an index is 0, a reflectance is outside 0 to 1, or wavelengths do not increase
PETZVAL_API void validate(const Coating& coating, const std::string& what);

/// The coating seen from the other side.
PETZVAL_API Coating reversed(Coating coating);

/// Fractions of the light of both polarisations that a surface reflects, transmits and absorbs.
struct SurfaceLight {
  double reflectance_s = 0, reflectance_p = 0, transmittance_s = 1, transmittance_p = 1;
  double absorptance_s = 0, absorptance_p = 0;

  /// Unpolarised light.
  double reflectance() const noexcept { return (reflectance_s + reflectance_p) / 2; }
  double transmittance() const noexcept { return (transmittance_s + transmittance_p) / 2; }
  double absorptance() const noexcept { return (absorptance_s + absorptance_p) / 2; }
};

/// Light at a coated surface between two transparent media, by the characteristic matrices of the layers.
///
/// Without layers the values are Fresnel's equations. Light that a table does not reflect is transmitted.
///
/// @param coating        a valid coating, as validate() accepts
/// @param index_before   refractive index of the medium from which light arrives, in front of the first layer
/// @param index_behind   refractive index of the medium behind the last layer
/// @param cosine         cosine of the angle of incidence, 0 to 1
/// @param wavelength_nm  wavelength in vacuum
/// @throws Error         if an index, the cosine or the wavelength is out of range, or the wavelength is outside the
///                       table
///
/// Source: H. A. Macleod, Thin-Film Optical Filters, chapter 2. Accuracy: 1e-12 (tests/prescription/coating_test.cpp).
PETZVAL_API SurfaceLight surface_light(const Coating& coating, double index_before, double index_behind, double cosine,
                                       double wavelength_nm);

}  // namespace petzval
