// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval {

/// A point of a pupil's boundary: the last ray that passes, and the fate of the next ray.
struct RimPoint {
  double x = 0, y = 0;                     ///< in the pupil plane, mm
  int surface = -1;                        ///< surface whose rim limits the pupil; -1: unknown, or `middle`
  RayFate next_fate = RayFate::vignetted;  ///< fate of a ray just outside
};

/// An interval of passing rays along one direction from the middle of a region. With central obscurations or folded
/// pupils a direction may have several spans or no span. If the middle passes, `from` is the middle.
struct PupilSpan {
  std::size_t direction = 0;              ///< one of PupilRegion::directions
  double from_radius = 0, to_radius = 0;  ///< in units of the half axes
  RimPoint from, to;
};

/// A region of a plane, given by its boundary along directions from a middle point.
///
/// Directions are equally spaced angles about `middle`, in coordinates divided by `half_axes`: a slim crescent is
/// resolved as well as a disc. Spans are sorted by direction, then outwards.
struct PETZVAL_API PupilRegion {
  Vec2<double> middle{0, 0};     ///< mm
  Vec2<double> half_axes{0, 0};  ///< mm
  std::size_t directions = 0;
  std::vector<PupilSpan> spans{};

  /// True if no ray passes.
  bool empty() const noexcept { return spans.empty(); }

  /// Unit vector of a direction, before scaling by half_axes: direction k of n lies at 2 pi (k + 1/2) / n from +y
  /// towards +x.
  Vec2<double> unit(std::size_t direction) const noexcept;
  /// The point of the plane (mm) in a direction, at a radius in units of half_axes.
  Vec2<double> at(std::size_t direction, double radius) const noexcept;

  /// Area (mm^2).
  double area() const noexcept;
};

/// The pupil of a scene or film point: the region of its pupil plane through which its rays pass the lens.
///
/// Accuracy: radii within 2e-13 of the half axes, on the passing side: the ray of every RimPoint was traced and passes.
struct PupilBoundary : PupilRegion {
  PupilPlane plane;
  std::size_t wavelength = 0;

  PupilBoundary(const PupilPlane& p, std::size_t w) : plane(p), wavelength(w) {}
};

/// Finds the pupil of a scene point by tracing rays.
///
/// The pupil is the connected set of passing rays about the chief ray, less central obscurations, which may divide the
/// pupil. Components closer than a tenth of the pupil's radius count as connected. Rays through other zones of the
/// surfaces are not part of the pupil; a stopped-down ball lens has such zones. A stop of area 0 gives an empty pupil.
///
/// @param lens        the lens
/// @param point       the scene point
/// @param wavelength  a compiled wavelength
/// @param directions  3 to 2^20, or 1 for a point on the axis of a lens of revolution
/// @throws Error      if PupilPlane does, the wavelength is not compiled, or directions is out of range
///
/// Accuracy: 256 directions give areas within 5e-4, or 3e-3 for crescents with needle-like tips.
PETZVAL_API PupilBoundary pupil_boundary(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {},
                                         std::size_t directions = 256);

/// Finds the pupil of a film point: the part of the lens through which the point sees the scene. Else as above.
PETZVAL_API PupilBoundary exit_pupil_boundary(const Lens& lens, const FilmPoint& point, Wavelength wavelength = {},
                                              std::size_t directions = 256);

/// Samples a pupil uniformly.
///
///     petzval::PupilSampler sampler(petzval::pupil_boundary(lens, point));
///     petzval::Vec2<double> p = sampler(u, v);        // u, v in [0, 1)
///     petzval::Ray<double> ray = sampler.plane().ray(p.x, p.y);
///
/// The sampled region consists of ring sectors between neighbouring directions and is slightly larger than the pupil,
/// so that nearly all sampled rays pass and no passing ray is left out. The map preserves area: stratified u and v give
/// stratified points. u runs around the middle, from +y towards +x; v runs outwards.
class PETZVAL_API PupilSampler {
 public:
  explicit PupilSampler(const PupilBoundary& boundary);

  /// True if the boundary is empty; the sampler must then not be called.
  bool empty() const noexcept { return pieces_.empty(); }

  const PupilPlane& plane() const noexcept { return plane_; }
  std::size_t wavelength() const noexcept { return wavelength_; }

  /// Area of the sampled region (mm^2): the pupil and a margin.
  double area() const noexcept { return area_; }

  /// The point of the pupil plane (mm) for u, v in [0, 1).
  Vec2<double> operator()(double u, double v) const noexcept;
  /// N points, with N the smallest of the four sizes. x and y may be u and v.
  void operator()(std::span<const double> u, std::span<const double> v, std::span<double> x,
                  std::span<double> y) const noexcept;

 private:
  /// A slim ring sector about the unit vector (sine, cosine).
  struct Piece {
    double before;              ///< fraction of the area in the previous pieces
    double angle_per_fraction;  ///< angle of the piece divided by its fraction of the area
    double sine, cosine;
    double inner_squared, outer_less_inner;  ///< squared radii
  };

  PupilPlane plane_;
  std::size_t wavelength_;
  Vec2<double> middle_, half_axes_;
  double half_turn_ = 0, area_ = 0;
  std::vector<Piece> pieces_;
  std::vector<double> until_;         ///< fraction of the area up to the end of each piece
  std::vector<std::uint32_t> first_;  ///< piece at the beginning of each of first_.size() equal steps of u
};

}  // namespace petzval
