// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "focus/image_rays.hpp"
#include "tilt_problem.hpp"

namespace petzval::fit_detail {

/// The blur of a bundle of exact rays: the distances of all hits from their centroid, scaled so that the sum of their
/// squares is the squared diameter. Unlike the diameter, the distances are smooth at the minimum. A target with a blur
/// is fitted as a sharp target on a nearer film, at the distance whose defocus causes the blur. (The square of a
/// diameter is the square of the defocus plus the square of the least diameter.)
class RayBlur final : public BlurErrors {
 public:
  /// @param target_blur signed diameter in units of the frame
  RayBlur(const RayBundle& bundle, const TiltFrame& frame, double root, double target_blur);
  int rows() const noexcept override { return 4; }
  bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const override;

 private:
  Eigen::ArrayXd x_, y_, slope_x_, slope_y_;  // rays at z = 0 of the frame
  double root_, defocus_ = 0;                 // defocus_: the diameter due to defocus
};

}  // namespace petzval::fit_detail
