// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "petzval/focus/image_rays.hpp"
#include "tilt_problem.hpp"

namespace petzval::fit_detail {

/// The blur of a bundle of exact rays: the distances of all hits from their centroid, scaled so that the sum of squares
/// is the squared diameter; unlike the diameter, they are smooth at its minimum. A bundle to be blurred counts as one
/// to be sharp on a film so much nearer to the lens that defocus makes the blur: the squared diameter is the sum of the
/// square due to defocus and of the least one, on the sharpest film.
class RayBlur final : public BlurErrors {
 public:
  /// wanted: signed diameter, in units of the frame.
  RayBlur(const RayBundle& bundle, const TiltFrame& frame, double root, double wanted);
  int rows() const noexcept override { return 4; }
  bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const override;

 private:
  Eigen::ArrayXd x_, y_, slope_x_, slope_y_;  // where rays cross z = 0 of the frame
  double root_, defocus_ = 0;                 // the part of the wanted diameter due to defocus
};

}  // namespace petzval::fit_detail
