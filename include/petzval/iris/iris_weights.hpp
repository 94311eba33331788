// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval {

/// The weight of a place of an iris: 1 + p (d + 1) x^d - p for the distribution d and the strength p, not below 0.
///
/// x is the share of the iris's area that lies nearer to its centre, by lines that have the shape of the iris; for
/// d < 0 it is 1 less that share, and |d| stands for d. So the mean over the iris is 1 whatever its shape, as long as
/// no weight is cut: d > 0 makes the rim of a blur bright, d < 0 its middle (a strength below 0 the other way round).
/// The weights conserve the light that passes the iris. On the film each part of the pupil counts with the cosine of
/// its rays to the fourth, so that the light of a picture changes: by 1 % at f/4, by 1.5 % (exact) to 3.5 % (thin) at
/// f/2 and by 6 % to 13 % at f/1.1 for d = 4 or -4 and p = 0.8. Source: "Recreating realistic bokeh by biasing
/// lens-sample positions", 2017.
struct EdgeWeight {
  double distribution = 0;  ///< d, -1000 to 1000
  double strength = 0.5;    ///< p: 0 to 1, of which nothing is cut; -1e6 to 1e6

  /// All weights are 1.
  bool even() const noexcept { return distribution == 0 || strength == 0; }
  /// share: of the area nearer to the centre, 0 to 1.
  PETZVAL_API double at(double share) const noexcept;
  /// The mean weight less 1: what the cut at 0 adds. 0 for strengths from 0 to 1.
  PETZVAL_API double light_added() const noexcept;
};

/// Weights over the square around the stop's rim as a grey picture, seen with +x to the right and +y up: the shape of
/// an iris, dirt, turned rings, an apodisation. Places between the centres of pixels are interpolated.
struct IrisMap {
  int width = 0, height = 0;
  std::vector<float> values;  ///< [row][column], from the top; 0 or more
  /// Weights are divided by their mean over the iris, so that the map takes no light.
  bool keep_mean = false;

  bool empty() const noexcept { return values.empty(); }
};

/// The area in squares of the stop's semi-diameter of an iris without a map that lets as much light through: within 1 %
/// for maps of details that are a pixel wide. Throws Error as iris_area() does, for weights that are negative or not
/// finite, and for a map that is black on the iris.
PETZVAL_API double iris_area(const Iris& iris, const IrisMap& map);

/// The rings that turning leaves on an aspheric mould, which blurs show as those of an onion.
struct OnionRings {
  double period = 0.06;   ///< of the radius, from ring to ring
  double contrast = 0.2;  ///< of the weight, between the mean and the brightest, 0 to 1
  double jitter = 0.15;   ///< by how many periods the spacing of two rings differs from the period at most
  std::uint32_t seed = 0;
};

/// The map of such rings, pixels x pixels, of mean 1 nearly; it keeps its mean. Throws Error for a period below two
/// pixels or above 2, a contrast out of range, a negative or infinite jitter, and pixels outside 2 to 8192.
PETZVAL_API IrisMap onion_rings(const OnionRings& rings, int pixels = 1024);

}  // namespace petzval
