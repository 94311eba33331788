// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::detail {

/// A ray behind the lens as it moves across a film: at (x, y) in a plane, and how much further a millimetre behind it.
struct Line {
  double x = 0, y = 0, slope_x = 0, slope_y = 0;
  double weight = 0;
};

/// What a criterion sees of one subject: the film where it is sharpest, and the blur's diameter on any other.
struct Image {
  double film_z = 0;  ///< infinite where the rays leave parallel
  double plane_z = 0;
  /// min_rms: the diameter is a hyperbola over the film's position, its least value and its slope far off.
  double least = 0, slope = 0;
  /// The other criteria: twice the largest radius of these, relative to the centroids of their fields in plane_z.
  std::vector<Line> lines;

  double diameter(double film_z) const noexcept;
};

struct WavelengthWeight {
  std::size_t wavelength;
  double weight;
};

/// By exact rays through whatever passes every rim, in bundles of all fields and wavelengths from the plane
/// subject_z. Rays lie at the nodes of a quadrature within the spans of pupil_outline, so that the result is a smooth
/// function of the subject and can be solved for. None where a field has no rays. criterion: min_rms or min_max.
/// Weights: above 0. Throws Error where pupil_outline does.
std::optional<Image> exact_image(const Lens& lens, double subject_z, std::span<const FocusField> fields,
                                 std::span<const WavelengthWeight> wavelengths, FocusCriterion criterion);

}  // namespace petzval::detail
