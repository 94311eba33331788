// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/pupil/pupil_boundary.hpp"

namespace petzval::inline v0 {

/// Spreads points uniformly over a pupil: over a region little larger than the boundary, made of one ring sector
/// between each two neighbouring directions, so that nearly all sampled rays pass and no ray that passes is left out.
///
///     petzval::PupilSampler sampler(petzval::pupil_boundary(lens, point));
///     auto [x, y] = sampler(u, v);                    // u, v in [0, 1)
///     petzval::Ray<double> ray = sampler.plane().ray(x, y);
///
/// The map preserves area: stratified u and v give stratified points. u runs around the middle, from +y towards +x, v
/// outwards.
class PETZVAL_API PupilSampler {
 public:
  explicit PupilSampler(const PupilBoundary& boundary);

  /// Nothing to sample: the boundary is empty.
  bool empty() const noexcept { return pieces_.empty(); }

  const PupilPlane& plane() const noexcept { return plane_; }
  std::size_t wavelength() const noexcept { return wavelength_; }

  /// Area of the region, mm^2 in the plane: that of the boundary and a margin.
  double area() const noexcept { return area_; }

  /// The point (x, y) of the plane for u, v in [0, 1). The sampler must not be empty.
  std::array<double, 2> operator()(double u, double v) const noexcept;
  /// The same for many. u, v, x, y: N each; x and y may be u and v.
  void operator()(std::span<const double> u, std::span<const double> v, std::span<double> x,
                  std::span<double> y) const noexcept;

 private:
  /// A slim part of a ring: it lies about the unit vector (sine, cosine) from +y.
  struct Piece {
    double before;           ///< share of the area of all pieces before this one
    double angle_per_share;  ///< from one side of it to the other
    double sine, cosine;
    double inner_squared, outer_less_inner;  ///< squared radii
  };

  PupilPlane plane_;
  std::size_t wavelength_;
  std::array<double, 2> middle_, half_axes_;
  double half_turn_ = 0, area_ = 0;
  std::vector<Piece> pieces_;
  std::vector<double> until_;         ///< share of the area up to the end of each piece
  std::vector<std::uint32_t> first_;  ///< that begins in or before each of as many equal steps of u
};

}  // namespace petzval::inline v0
