// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/vec3.hpp"

namespace petzval {

/// A point that a plane should pass, with the weight of its squared distance.
struct PlanePoint {
  Vec3<double> position{0, 0, 0};
  double weight = 1;
};

/// Result of fitting a plane to points.
struct PlaneFit {
  enum class Status {
    solved,
    /// No plane is special: fewer than three points of weight, all on a line (second spread within 1e-9 of the first),
    /// or spread as widely across the plane as in it (second and third spread alike within 1e-9 of the first).
    degenerate,
    not_converged,
  };
  Status status = Status::degenerate;
  Vec3<double> normal{0, 0, 1};  ///< unit, z >= 0; left as it is here where the points are degenerate
  Vec3<double> point{0, 0, 0};   ///< weighted centroid, on the plane
  double rms_distance = 0;       ///< weighted RMS distance of the points
  explicit operator bool() const noexcept { return status == Status::solved; }
};

/// The plane with the least weighted sum of squared distances to points: total least squares, solved by Ceres on the
/// unit sphere of normals and started from the singular vectors of the centred, scaled points. Sound for planes that
/// contain the view direction and for points far from the origin.
///
/// Accuracy (tests/movement): exact points give their normal within 1e-12 rad in any unit, points of 1 mm spread 1e9 mm
/// away within 2e-6 rad, which is what the rounding of their coordinates leaves. Throws Error for a position or weight
/// that is not finite, a negative weight, and points whose distances overflow.
PETZVAL_API PlaneFit fit_plane(std::span<const PlanePoint> points);

}  // namespace petzval
