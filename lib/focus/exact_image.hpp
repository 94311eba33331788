// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "image.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::focus_detail {

struct WavelengthWeight {
  std::size_t wavelength;
  double weight;
};

/// The image of the plane subject_z, by exact rays of all fields and wavelengths. The rays pass through quadrature
/// nodes in each pupil, so that the result is a smooth function of subject_z. nullopt if a field has no rays. Weights
/// must be above 0. Throws the errors of pupil_boundary().
/// @param criterion min_rms or min_max
std::optional<Image> exact_image(const Lens& lens, double subject_z, std::span<const FocusField> fields,
                                 std::span<const WavelengthWeight> wavelengths, FocusCriterion criterion);

}  // namespace petzval::focus_detail
