// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "import.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// Completes the data of a reader to a valid lens, with the library's optics.
///
/// Carries out the requests of the file: film, solved thicknesses, meaning of apertures, names of positions. Sizes the
/// stop by the aperture of the design, sets nominal data by the fields, and computes missing apertures. Each
/// assumption, and each number of the file that the lens does not have, becomes a warning.
///
/// @return         the valid prescription
/// @throws Error   if the prescription is invalid, or a request that it needs cannot be carried out
Prescription complete(Import in);

}  // namespace petzval::formats_detail
