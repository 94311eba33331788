// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/core/export.hpp"

/// How the blur of rays depends on where an upright film stands.
namespace petzval::inline v0::focus_detail {

/// A ray behind the lens as it moves across a film: at (x, y) in a plane, and how much further a millimetre behind it.
struct Line {
  double x = 0, y = 0, slope_x = 0, slope_y = 0;
  double weight = 0;
};

/// What a criterion sees of one subject: the film where it is sharpest, and the blur's diameter on any other.
struct PETZVAL_API Image {
  double film_z = 0;  ///< infinite where the rays leave parallel
  double plane_z = 0;
  /// min_rms: the diameter is a hyperbola over the film's position, its least value and its slope far off.
  double least = 0, slope = 0;
  /// The other criteria: twice the largest radius of these, relative to the centroids of their fields in plane_z.
  std::vector<Line> lines;

  double diameter(double film_z) const noexcept;
};

/// Of rays where they meet plane_z, relative to the centroids of their fields; weights sum to 1. Infinite film_z for
/// parallel rays.
PETZVAL_API Image least_rms(std::span<const Line> lines, double plane_z);
/// By the largest radius; weights do not count.
PETZVAL_API Image least_maximum(std::vector<Line> lines, double plane_z);

}  // namespace petzval::inline v0::focus_detail
