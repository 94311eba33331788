// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval::inline v0 {

/// A point of a pupil's edge: the last ray that still passes, and what ends the next one.
struct RimPoint {
  double x = 0, y = 0;                  ///< in the PupilPlane, mm
  int surface = -1;                     ///< the rim that limits here; -1 at the middle of the outline, which is no edge
  RayFate beyond = RayFate::vignetted;  ///< what becomes of a ray just outside
};

/// What passes along one direction from the outline's middle: from one edge to the next. A lens with a hole, or a
/// folded pupil, has several in one direction or none; `from` is the middle itself where rays pass there.
struct PupilSpan {
  std::size_t direction = 0;              ///< one of PupilOutline::directions
  double from_radius = 0, to_radius = 0;  ///< in units of the outline's half axes
  RimPoint from, to;
};

/// The pupil of a point of the scene or the film: which of its rays a lens passes, by tracing the boundary of that
/// region.
///
/// Directions are equally spaced angles about `middle`, in coordinates divided by `half_axes`, so that a slim crescent
/// is as well resolved as a disc. Spans are in the order of directions and outwards within one. Edges are found to
/// within 2e-13 of the half axes and always on the passing side: every edge was traced and passes.
struct PETZVAL_API PupilOutline {
  PupilPlane plane;
  std::size_t wavelength = 0;
  std::array<double, 2> middle{0, 0};     ///< x, y in the plane, mm
  std::array<double, 2> half_axes{0, 0};  ///< x, y, mm
  std::size_t directions = 0;
  std::vector<PupilSpan> spans{};

  /// Nothing gets through.
  bool empty() const noexcept { return spans.empty(); }

  /// Unit vector (x, y) of a direction, before the half axes: direction k of n at the angle 2 pi (k + 1/2) / n from +y.
  std::array<double, 2> unit(std::size_t direction) const noexcept;
  /// A point of the plane by direction and radius.
  std::array<double, 2> at(std::size_t direction, double radius) const noexcept;

  /// Area in the plane, mm^2.
  double area() const noexcept;
};

/// Traces the outline. The search starts at the chief ray; where that is lost, it looks for the ray that comes nearest
/// to passing all rims. Nothing passes a stop of area 0.
///
/// directions: 3 or more, or 1, which is enough on the axis of a lens of revolution; 256 give areas within 5e-4 (3e-3
/// for crescents with tips as fine as needles).
/// Throws Error where PupilPlane does, for a wavelength that was not compiled, and for other directions.
PETZVAL_API PupilOutline pupil_outline(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {},
                                       std::size_t directions = 256);

/// The same for a point of the film: what of the lens it sees the scene through.
PETZVAL_API PupilOutline exit_pupil_outline(const Lens& lens, const FilmPoint& point, Wavelength wavelength = {},
                                            std::size_t directions = 256);

}  // namespace petzval::inline v0
