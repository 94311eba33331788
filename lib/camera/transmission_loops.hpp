// SPDX-License-Identifier: Apache-2.0
// Loop over rays for a fitted transmittance; transmission_loops.cpp defines it for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// Coefficients of a fitted transmittance, one for each monomial.
inline constexpr std::size_t transmission_terms = 35;

/// A monomial: the product of an earlier monomial and a variable. The first monomial is 1.
struct Monomial {
  std::uint8_t earlier = 0, variable = 0;
};

/// A polynomial in squares and products of film and pupil coordinates: three variables for a lens of revolution, which
/// do not change if the lens is turned, or six for mirror symmetry.
template <class T>
struct TransmissionJob {
  lens_detail::WavelengthRows<T> rows;  ///< coefficients for rays with individual wavelengths
  const double* shared = nullptr;       ///< coefficients if all rays have the same wavelength
  std::array<Monomial, transmission_terms> monomials;
  std::size_t terms = transmission_terms;  ///< number of monomials in use
  bool revolution = true;
  T per_film = 1, per_pupil = 1;  ///< scales of the coordinates, 1/mm
  T least = 0, most = 1;          ///< limits of the result
};

struct TransmissionLoops {
  void (*single)(const TransmissionJob<float>&, std::size_t, const TwoPlaneRays<const float>&, const RayWavelengths&,
                 float*) noexcept;
  void (*twice)(const TransmissionJob<double>&, std::size_t, const TwoPlaneRays<const double>&, const RayWavelengths&,
                double*) noexcept;
};

PETZVAL_WIDEST(TransmissionLoops, transmission_loops)

}  // namespace petzval::camera_detail
