// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Relative illumination of the film against the field angle, from the axis to a field, as SVG text, with cos^4 of the
/// angle for comparison. At the primary wavelength.
///
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where relative_illumination does, and for a field that is
/// not above 0.
PETZVAL_API std::string illumination_figure(const Lens& lens, double subject_z, double field_rad);

}  // namespace petzval::inline v0
