// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// Compiles rows for the primary wavelength of their design, with the n_d/V_d model if a glass is unknown. Uses the
/// reference wavelength if the design has no wavelength or a glass does not cover it.
Lens at_primary_wavelength(const Prescription& rows, const GlassCatalogue* glasses);

/// Rows without configurations and with all rims open.
Prescription without_rims(Prescription rows);

/// Index of the marked stop; the number of surfaces if no stop is marked.
std::size_t stop_of(const Prescription& rows);

/// Position of the entrance pupil from the first surface (mm); infinite if the object space is telecentric.
double entrance_pupil_z(const Lens& compiled, std::size_t stop);

/// Height (mm) of a design's marginal ray at the stop: exact if a parallel beam enters, otherwise to first order.
///
/// @param compiled the lens without rims
/// @param position the stop
/// @param object distance of the object from the first surface (mm); may be infinite
/// @param aperture the declaration of the beam
/// @return 0 or a non-finite number if the aperture does not determine the height
double marginal_height_at_the_stop(const Lens& compiled, std::size_t position, double object,
                                   const DesignAperture& aperture);

}  // namespace petzval::formats_detail
