// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/pupil/outline.hpp"

namespace petzval {

/// Spreads points evenly over a pupil: over a region little larger than the outline, made of one ring sector between
/// each two neighbouring directions, so that next to all rays sent through them pass and none that would is left out.
///
///     petzval::PupilSampler sampler(petzval::pupil_outline(lens, point));
///     auto [x, y] = sampler(u, v);                    // u, v in [0, 1)
///     petzval::Ray<double> ray = sampler.plane().ray(x, y);
///
/// The map keeps areas, so that stratified u and v stay so.
class PETZVAL_API PupilSampler {
 public:
  explicit PupilSampler(const PupilOutline& outline);

  /// Nothing to sample: the outline is empty.
  bool empty() const noexcept { return sectors_.empty(); }

  const PupilPlane& plane() const noexcept { return plane_; }
  std::size_t wavelength() const noexcept { return wavelength_; }

  /// Of the region, mm^2 in the plane: the outline's and a margin.
  double area() const noexcept { return area_; }

  /// The point (x, y) of the plane for u, v in [0, 1). Not for an empty sampler.
  std::array<double, 2> operator()(double u, double v) const noexcept;

 private:
  struct Sector {
    double until;  ///< share of the area of the sectors up to the end of this one
    double angle;  ///< where it begins, from +y
    double inner_squared, outer_squared;
  };

  PupilPlane plane_;
  std::size_t wavelength_;
  std::array<double, 2> middle_, half_axes_;
  double turn_ = 0, area_ = 0;
  std::vector<Sector> sectors_;
};

}  // namespace petzval
