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

/// The image of the plane subject_z by exact rays of all fields and wavelengths. Rays lie at the nodes of a quadrature
/// of each pupil, so that the result is a smooth function of the subject and can be solved for. Nothing where a field
/// has no rays. criterion: min_rms or min_max. Weights: above 0. Throws Error where pupil_boundary does.
std::optional<Image> exact_image(const Lens& lens, double subject_z, std::span<const FocusField> fields,
                                 std::span<const WavelengthWeight> wavelengths, FocusCriterion criterion);

}  // namespace petzval::focus_detail
