// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval {

/// The shape of a stop: round, or a regular polygon of blades with straight or rounded edges.
///
///     petzval::Lens bladed = petzval::with_iris(lens, {.blades = 6, .roundness = 0.3});
///
/// The corners lie on the rim of the stop. with_f_number() changes the size and keeps the shape, so that at the same
/// f-number the iris transmits the fraction iris_area(iris) / pi of the light of a round iris. Photographers' f-numbers
/// mean equal areas: see equal_area_f_number().
struct Iris {
  int blades = 0;  ///< 3 to 20; 0: round
  /// Angle between the edge of a blade and the chord from corner to corner, divided by the angle of the rim. 0:
  /// straight edges; 1: round; below 0: edges bend inwards; -1: edges are mirror images of the rim or, for at most five
  /// blades, halve the corner angles of the straight polygon.
  double roundness = 0;
  /// Angle of the first corner from +y towards -x, within 1e6: anticlockwise if +x points right and +y up.
  double rotation_rad = 0;

  bool round() const noexcept { return blades == 0 || roundness == 1; }
};

/// Area of an iris in units of the squared semi-diameter of the stop; pi for a round iris.
///
/// @throws Error if blades, roundness or rotation are out of range
PETZVAL_API double iris_area(const Iris& iris);

/// The f-number, for with_f_number(), at which an iris transmits as much light as a round iris at f_number: f_number *
/// sqrt(iris_area(iris) / pi).
///
/// @throws Error if iris_area() does, or f_number is not positive and finite
///
///     petzval::Lens lens = with_f_number(with_iris(wide_open, hexagon), petzval::equal_area_f_number(hexagon, 4));
PETZVAL_API double equal_area_f_number(const Iris& iris, double f_number);

/// Weight of a point of an iris: max(0, 1 + p (d + 1) x^d - p), for the distribution d and the strength p.
///
/// x is the fraction of the iris area nearer to the centre, inside a scaled copy of the iris through the point. If d is
/// negative, x is 1 minus this fraction, and |d| replaces d. The mean weight over the iris is 1 unless weights are
/// clamped at 0. A positive d makes the rim of a blur bright, a negative d its middle; a negative strength inverts
/// this. Source: "Recreating realistic bokeh by biasing lens-sample positions", 2017.
///
/// Limitations: weights conserve the light through the iris, but the film also weights each part of the pupil with
/// cos^4. For d = 4 or -4 and p = 0.8, the exposure changes by 1 % at f/4, 1.5 % (exact) to 3.5 % (thin) at f/2, and 6
/// to 13 % at f/1.1.
struct EdgeWeight {
  double distribution = 0;  ///< d, -1000 to 1000
  double strength = 0.5;    ///< p, -1e6 to 1e6; from 0 to 1 no weight is clamped

  /// All weights are 1.
  bool even() const noexcept { return distribution == 0 || strength == 0; }
  /// Weight at a fraction of the area nearer to the centre, 0 to 1.
  PETZVAL_API double at(double area_fraction) const noexcept;
  /// Mean weight minus 1, caused by weights clamped at 0; 0 for strengths from 0 to 1.
  PETZVAL_API double light_added() const noexcept;
};

/// Weights over the square around the stop's rim, as a grey image with +x to the right and +y up: an iris shape, dirt,
/// turning marks or an apodisation. Weights are interpolated between pixel centres.
struct IrisMap {
  int width = 0, height = 0;
  std::vector<float> values;  ///< [row][column], from the top; at least 0
  /// true: weights are divided by their mean over the iris, so that the map keeps the exposure.
  bool keep_mean = false;

  bool empty() const noexcept { return values.empty(); }
};

/// Area of the iris without a map that transmits as much light, in units of the squared semi-diameter of the stop.
///
/// @throws Error if iris_area() does, a weight is negative or not finite, or the map is black on the iris
///
/// Accuracy: 1 % for maps with details one pixel wide.
PETZVAL_API double iris_area(const Iris& iris, const IrisMap& map);

/// Onion rings: concentric rings in the blur, from turning marks of an aspheric mould.
struct OnionRings {
  double period = 0.06;   ///< distance of neighbouring rings, as a fraction of the radius
  double contrast = 0.2;  ///< brightest weight minus mean weight, 0 to 1
  double jitter = 0.15;   ///< largest deviation of the distance of two rings, in periods
  std::uint32_t seed = 0;
};

/// A square map of onion rings; its mean is about 1, and keep_mean is set.
///
/// @param rings   the rings
/// @param pixels  width and height, 2 to 8192
/// @throws Error  if the period is less than two pixels or above 2, the contrast is out of range, the jitter is
///                negative or infinite, or pixels is out of range
PETZVAL_API IrisMap onion_rings(const OnionRings& rings, int pixels = 1024);

}  // namespace petzval
