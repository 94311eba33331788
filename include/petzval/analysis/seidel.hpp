// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// Object and field of paraxial_rays().
struct ParaxialField {
  /// Distance of the object in front of the first vertex (mm); negative for a virtual object; beyond 1e100 mm infinite.
  double object_distance = std::numeric_limits<double>::infinity();
  double field_rad = 0;  ///< angle of the chief ray in object space; positive if the ray rises along z
  /// Height of the object (mm), used instead of `field_rad`. The object must be at a finite distance.
  std::optional<double> object_height{};
};

/// Heights and slopes of the marginal ray and the chief ray at one surface.
struct ParaxialRayPair {
  double marginal_y = 0;  ///< mm
  double marginal_u = 0;  ///< slope dy/dz behind the surface, also while light runs backwards
  double chief_y = 0;     ///< mm
  double chief_u = 0;     ///< slope dy/dz behind the surface
};

/// The paraxial marginal ray and chief ray of a lens.
struct ParaxialRays {
  double object_marginal_u = 0, object_chief_u = 0;  ///< slopes in object space
  double invariant = 0;                              ///< optical invariant n (u ybar - ubar y), mm
  std::vector<ParaxialRayPair> surfaces;             ///< in the order of the lens
};

/// Paraxial marginal ray and chief ray, surface by surface.
///
/// The marginal ray starts at the axial point of the object, passes the rim of the stop, and has a positive height at
/// the first vertex. The chief ray passes the centre of the stop. The stop is pupils().stop.
///
/// @param lens        the lens
/// @param field       object and field
/// @param wavelength  the wavelength
/// @throws Error      if the lens has cylindrical surfaces or no stop, if a value of `field` is out of range, or if a
///                    ray does not exist, such as a chief ray by angle in front of a telecentric lens
PETZVAL_API ParaxialRays paraxial_rays(const Lens& lens, const ParaxialField& field = {}, Wavelength wavelength = {});

/// Third-order and chromatic aberrations, in mm.
struct SeidelTerms {
  double s1 = 0;  ///< spherical aberration
  double s2 = 0;  ///< coma
  double s3 = 0;  ///< astigmatism
  double s4 = 0;  ///< Petzval curvature
  double s5 = 0;  ///< distortion
  double c1 = 0;  ///< axial colour
  double c2 = 0;  ///< lateral colour
};

/// The terms of each surface and their sums.
struct SeidelSums {
  std::vector<SeidelTerms> surfaces;  ///< in the order of the lens
  SeidelTerms sums;
};

/// Seidel sums and chromatic sums of a lens, surface by surface.
///
/// Formulas and signs: W. T. Welford, Aberrations of Optical Systems (1986), chapters 8 and 10. The wavefront is
/// W = S1/8 r^4 + S2/2 h y r^2 + S3/2 h^2 y^2 + (S3 + S4)/4 h^2 r^2 + S5/2 h^3 y with pupil radius r and field h
/// relative to the marginal ray and the chief ray. S1 and C1 of a positive single lens are positive. C1 and C2 are
/// linear in the index differences n(`shorter`) - n(`longer`). Conic constants and terms of order 2 and 4 contribute,
/// and mirrors have signed indices.
///
/// @param lens        the lens
/// @param field       object and field of paraxial_rays()
/// @param wavelength  the wavelength of the rays and of S1 to S5
/// @param shorter     first wavelength of C1 and C2
/// @param longer      second wavelength of C1 and C2; equal wavelengths give 0
/// @throws Error      as paraxial_rays(); if a surface has an aspheric term of order 3, which has no third-order sums;
///                    if the lens has no index at a wavelength
///
/// Accuracy: sums equal limits of exact rays within 1e-4, and closed forms within 1e-9
/// (tests/analysis/seidel_test.cpp).
PETZVAL_API SeidelSums seidel_sums(const Lens& lens, const ParaxialField& field = {}, Wavelength wavelength = {},
                                   Wavelength shorter = {}, Wavelength longer = {});

}  // namespace petzval
