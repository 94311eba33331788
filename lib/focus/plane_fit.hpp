// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::focus_detail {

/// A scene point as a pinhole at the principal point sees it.
struct PicturePoint {
  double x = 0, y = 0;          ///< over depth
  double inverse_distance = 0;  ///< reciprocal of the depth, 1/mm; 0 at infinity
  double weight = 1;
};

/// Points lie on a line of the picture if their RMS spread across it is within this part of that along it.
inline constexpr double line_aspect = 0.02;

/// Points lie in one place of the picture if their RMS spread is within this: half a micrometre on the film of a 50 mm
/// lens, less than a film or an eye resolves.
inline constexpr double one_place = 1e-5;

/// What a pinhole at (0, 0, z) sees of a scene point in front of it.
PETZVAL_API PicturePoint picture_point(const ScenePoint& point, double z) noexcept;

/// A plane of the scene: inverse distance = a x + b y + c.
struct PlaneFit {
  PlaneRank rank = PlaneRank::none;
  double a = 0, b = 0, c = 0;
  double mean_x = 0, mean_y = 0;    ///< weighted centroid
  double along_x = 0, along_y = 0;  ///< unit main direction of the points in the picture; rank line: of the line
  double spread = 0;                ///< RMS along it
  double aspect = 0;                ///< spread across it over that along it
};

/// The weighted least squares plane in inverse distance: the plane of focus of least squared blur of a thin lens, which
/// exists for all points. For points on a line of the picture (line_aspect) its slope across is 0; for points in one
/// place (one_place) both slopes are: the plane of least tilt. Weights: finite, at least 0.
PETZVAL_API PlaneFit fit_plane(std::span<const PicturePoint> points);

/// The plane in the scene, with depths counted from z towards -z; normal.z >= 0. Nothing for the plane at infinity.
PETZVAL_API std::optional<Plane> plane_of(const PlaneFit& fit, double z);

}  // namespace petzval::focus_detail
