// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::focus_detail {

/// A scene point as seen by a pinhole at the principal point.
struct PicturePoint {
  double x = 0, y = 0;          ///< divided by the depth
  double inverse_distance = 0;  ///< reciprocal of the depth, 1/mm; 0 at infinity
  double weight = 1;
};

/// Points of the picture are collinear up to this ratio of the RMS spreads across and along their line.
inline constexpr double line_aspect = 0.02;

/// Points of the picture coincide up to this RMS spread: half a micrometre on the film of a 50 mm lens, below the
/// resolution of films and eyes.
inline constexpr double coincidence_spread = 1e-5;

/// A scene point in front of a pinhole at (0, 0, z), as seen by the pinhole.
PETZVAL_API PicturePoint picture_point(const ScenePoint& point, double z) noexcept;

/// A plane of the scene: inverse distance = a x + b y + c.
struct PlaneFit {
  PlaneRank rank = PlaneRank::none;
  double a = 0, b = 0, c = 0;
  double mean_x = 0, mean_y = 0;    ///< weighted centroid
  double along_x = 0, along_y = 0;  ///< unit main direction of the points in the picture
  double spread = 0;                ///< RMS along the main direction
  double aspect = 0;                ///< spread across divided by spread along
};

/// The weighted least-squares plane in inverse distance. For a thin lens it is the plane of focus with the least
/// squared blur; it exists for all points. If the points are collinear in the picture (line_aspect), the slope across
/// the line is set to 0; if they coincide (one_place), both slopes are set to 0. The result is then the plane of least
/// tilt. Weights: finite, >= 0.
PETZVAL_API PlaneFit fit_plane(std::span<const PicturePoint> points);

/// The plane in the scene, with depths counted from z towards -z; normal.z >= 0. nullopt if the plane is at infinity.
PETZVAL_API std::optional<Plane> plane_of(const PlaneFit& fit, double z);

}  // namespace petzval::focus_detail
