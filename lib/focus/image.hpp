// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

/// The blur of rays as a function of the position of an upright film.
namespace petzval::inline v0::focus_detail {

/// A ray behind the lens: where it meets a plane across the axis, and its slopes per mm of z.
struct Line {
  double x = 0, y = 0, slope_x = 0, slope_y = 0;
  double weight = 0;
};

/// The image of one subject by a criterion: the film on which it is sharpest, and its blur on any other.
struct Image {
  double film_z = 0;  ///< infinite if the rays leave parallel
  double plane_z = 0;
  /// min_rms: the diameter is a hyperbola over the position of the film; its least value and its asymptotic slope.
  double least = 0, slope = 0;
  /// The other criteria: twice the largest radius of these, relative to the centroids of their fields in plane_z.
  std::vector<Line> lines;

  double diameter(double film_z) const noexcept;
};

/// The image by RMS radius. lines: rays in plane_z, relative to the centroids of their fields; weights sum to 1.
/// film_z is infinite for parallel rays.
Image least_rms(std::span<const Line> lines, double plane_z);
/// The image by the largest radius; weights do not count.
Image least_maximum(std::vector<Line> lines, double plane_z);

}  // namespace petzval::inline v0::focus_detail
