// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// Rows compiled for the primary wavelength of their design, with the n_d/V_d model if a glass is unknown. For
/// their reference wavelength if the design has no wavelength, or one outside the range of a glass.
Lens at_primary_wavelength(const Prescription& rows, const GlassCatalogue* glasses);

/// Rows without configurations, with every rim open.
Prescription without_rims(Prescription rows);

/// Number of the marked stop; the number of surfaces if no stop is marked.
std::size_t stop_of(const Prescription& rows);

/// Position of the entrance pupil, from the first surface, mm; infinite in a telecentric object space.
double entrance_pupil_z(const Lens& compiled, std::size_t stop);

/// Height of a design's marginal ray at the stop, in mm: of an exact ray if a parallel beam enters, else to first
/// order.
///
/// @param compiled  the lens without rims
/// @param position  the stop
/// @param object    distance of the object from the first surface, mm; may be infinite
/// @param aperture  how the design declares the beam
/// @return          0 or a number that is not finite if the aperture does not determine it
double marginal_height_at_the_stop(const Lens& compiled, std::size_t position, double object,
                                   const DesignAperture& aperture);

}  // namespace petzval::formats_detail
