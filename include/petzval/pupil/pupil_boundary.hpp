// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval {

/// A point of a pupil's boundary: the last ray that passes, and what ends the next one.
struct RimPoint {
  double x = 0, y = 0;                  ///< in the plane, mm
  int surface = -1;                     ///< whose rim limits here; -1: unknown, or the middle, which is no rim
  RayFate beyond = RayFate::vignetted;  ///< fate of a ray just outside
};

/// An interval that passes along one direction from the middle of a region. Central obscurations and folded pupils
/// leave several in one direction or none; `from` is the middle itself where rays pass there.
struct PupilSpan {
  std::size_t direction = 0;              ///< one of PupilRegion::directions
  double from_radius = 0, to_radius = 0;  ///< in units of the half axes
  RimPoint from, to;
};

/// A region of a plane, described by its boundary along directions from a middle.
///
/// Directions are equally spaced angles about `middle`, in coordinates divided by `half_axes`, so that a slim crescent
/// is as well resolved as a disc. Spans are in the order of directions, and outwards within one.
struct PETZVAL_API PupilRegion {
  Vec2<double> middle{0, 0};     ///< x, y in the plane, mm
  Vec2<double> half_axes{0, 0};  ///< x, y, mm
  std::size_t directions = 0;
  std::vector<PupilSpan> spans{};

  /// Nothing passes.
  bool empty() const noexcept { return spans.empty(); }

  /// Unit vector (x, y) of a direction, before the half axes: direction k of n at the angle 2 pi (k + 1/2) / n from +y
  /// towards +x.
  Vec2<double> unit(std::size_t direction) const noexcept;
  /// A point of the plane by direction and radius.
  Vec2<double> at(std::size_t direction, double radius) const noexcept;

  /// Area in the plane, mm^2.
  double area() const noexcept;
};

/// The pupil of one point of the scene or the film: the region of its plane through which its rays pass the lens.
/// Radii are found within 2e-13 of the half axes and always on the passing side: the ray of every RimPoint was traced
/// and passes.
struct PupilBoundary : PupilRegion {
  PupilPlane plane;
  std::size_t wavelength = 0;

  PupilBoundary(const PupilPlane& p, std::size_t w) : plane(p), wavelength(w) {}
};

/// The pupil is the connected set of rays about the chief ray, less central obscurations, which may divide it. Rays
/// that reach the stop through other zones of the surfaces do not belong to it: a ball lens that is stopped down has
/// such zones. Parts count as connected if they are closer than a tenth of the pupil's radius.
///
/// Finds the boundary by tracing, wherever the pupil lies: the search looks at all that can be seen of the surface
/// through which rays enter, at 48 x 48 places, and about those places between them whose rays come nearest to passing.
/// Nothing passes a stop of area 0.
///
/// directions: 3 to 2^20, or 1, which is enough on the axis of a lens of revolution; 256 give areas within 5e-4 (3e-3
/// for crescents with tips as fine as needles).
/// Throws Error where PupilPlane does, for a wavelength that was not compiled, and for other directions.
PETZVAL_API PupilBoundary pupil_boundary(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {},
                                         std::size_t directions = 256);

/// The same for a point of the film: through which part of the lens it sees the scene.
PETZVAL_API PupilBoundary exit_pupil_boundary(const Lens& lens, const FilmPoint& point, Wavelength wavelength = {},
                                              std::size_t directions = 256);

/// Spreads points uniformly over a pupil: over a region little larger than the boundary, made of one ring sector
/// between each two neighbouring directions, so that nearly all sampled rays pass and no ray that passes is left out.
///
///     petzval::PupilSampler sampler(petzval::pupil_boundary(lens, point));
///     petzval::Vec2<double> p = sampler(u, v);        // u, v in [0, 1)
///     petzval::Ray<double> ray = sampler.plane().ray(p.x, p.y);
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
  Vec2<double> operator()(double u, double v) const noexcept;
  /// The same for many. u, v, x, y: N each; points that one of them has no room for are left out. x and y may
  /// be u and v.
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
  Vec2<double> middle_, half_axes_;
  double half_turn_ = 0, area_ = 0;
  std::vector<Piece> pieces_;
  std::vector<double> until_;         ///< share of the area up to the end of each piece
  std::vector<std::uint32_t> first_;  ///< that begins in or before each of as many equal steps of u
};

}  // namespace petzval
