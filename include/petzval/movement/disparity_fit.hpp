// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/plane.hpp"
#include "petzval/movement/ideal_lens.hpp"

namespace petzval::inline v0 {

/// A point as a pinhole at the principal point sees it: x and y over depth, and the reciprocal of the depth.
struct DisparityPoint {
  double x = 0, y = 0;
  double disparity = 0;  ///< 1/mm; 0 at infinity
  double weight = 1;
};

/// Points of a picture lie in a line where their second spread is within this part of the first.
inline constexpr double line_aspect = 0.02;

/// Points are in one place of the picture where their RMS spread in it, x and y over depth, is within this: half a
/// micrometre on the film of a 50 mm lens, less than film or eye can tell.
inline constexpr double one_place = 1e-5;

/// What a pinhole at (0, 0, z) sees of a place in front of it.
PETZVAL_API DisparityPoint disparity_point(const ScenePoint& place, double z) noexcept;

/// How much of a plane points tell.
enum class PlaneRank : unsigned char {
  none,   ///< no points of weight
  point,  ///< one, or several in one place of the picture: only its depth
  line,   ///< two, or several on one line of the picture: depth and the slope along it
  plane,
};

/// "none", "point", "line", "plane".
PETZVAL_API std::string_view name(PlaneRank rank) noexcept;

/// A plane of the scene: disparity = a x + b y + c.
struct DisparityFit {
  PlaneRank rank = PlaneRank::none;
  double a = 0, b = 0, c = 0;
  double mean_x = 0, mean_y = 0;    ///< weighted centroid
  double along_x = 0, along_y = 0;  ///< unit main direction of the points in the picture; rank line: of the line
  double spread = 0;                ///< RMS along it
  double aspect = 0;                ///< their spread across it over that along it
};

/// The weighted least squares plane in disparity: the plane of focus of least squared blur of a thin lens, and one that
/// is renderable whatever the points are. Where points lie in a line of the picture (line_aspect) its slope across is
/// 0; in one place (one_place), both slopes are: the plane of least tilt.
/// Weights: finite, at least 0.
PETZVAL_API DisparityFit fit_disparity(std::span<const DisparityPoint> points);

/// The plane in the scene, for depths from z towards -z: normal.z >= 0. Nothing where it is the plane at infinity.
PETZVAL_API std::optional<Plane> plane_of(const DisparityFit& fit, double z);

}  // namespace petzval::inline v0
