// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "import.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// Turns the data of a reader into a valid lens, with the optics of the library.
///
/// Carries out the requests of the file: film, solved thicknesses, meaning of apertures, names of positions. Sizes the
/// stop by the aperture of the design, sets nominal data from the fields, and computes missing apertures. Each
/// assumption becomes a warning, and so does each number in the file that differs from the lens.
///
/// @return the valid prescription
/// @throws Error if the prescription is invalid, or if a required request cannot be carried out
Prescription complete(Import in);

}  // namespace petzval::formats_detail
