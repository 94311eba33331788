// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil.hpp"

namespace petzval {

/// A point of the scene: towards +y from the axis, seen from the centre of the paraxial entrance pupil. So a field of
/// +10 degrees is imaged at negative y by a lens that turns its image upside down.
///
/// The pupil is that of the compiled wavelength nearest to the d line and the meridian y, so that a point is the same
/// for every wavelength.
struct ScenePoint {
  double field_rad = 0;  ///< within 90 degrees: a plane takes in no more
  double z = 0;          ///< lens frame, mm; the plane the point lies in; -inf at infinity
};

/// A rectangle of the paraxial entrance-pupil plane, and the point whose rays cross it.
///
/// The rays that a lens passes from a point cross some region of that plane; off axis and for fast lenses it is neither
/// the paraxial pupil nor centred on it. The rectangle encloses that region.
struct PupilWindow {
  ScenePoint point;
  double plane_z = 0;
  double x_min = 0, x_max = 0, y_min = 0, y_max = 0;  ///< mm
  bool empty = true;                                  ///< nothing gets through

  double area() const noexcept { return empty ? 0.0 : (x_max - x_min) * (y_max - y_min); }
};

/// Finds the window by tracing a grid over all that the first surface lets in, then finer ones, until the passing
/// region fills a good part of it; a margin of 3 % a side is left.
///
/// Regions smaller than 1/1000 of what the first surface lets in are not seen. Where the first surface is unlimited,
/// four times the widest rim or pupil stands for it. A stop of no area gives an empty window. Throws Error for a field
/// of 90 degrees or more, an entrance pupil at infinity (object-space telecentric: neither a field angle nor a
/// throughput has a meaning there), a point in the pupil's plane, and a point that does not lie in front of all of the
/// first surface.
PETZVAL_API PupilWindow pupil_window(const Lens& lens, const ScenePoint& point, std::size_t wavelength = 0);

/// The ray of a scene point through a point (x, y) of the entrance-pupil plane, started there and never at the object:
/// nothing is lost however far that is.
PETZVAL_API Ray<double> ray_through(const ScenePoint& point, const Pupil& entrance, double x, double y) noexcept;

/// Where the rays of one point and wavelength meet the film.
struct FilmHits {
  std::vector<double> x, y;  ///< of the transmitted rays, mm, film plane of the lens, lens frame
  std::size_t sent = 0;      ///< rays started
  double window_area = 0;    ///< of the pupil plane they were spread over, mm^2
  double transmitted_area() const noexcept {
    return sent == 0 ? 0.0 : window_area * static_cast<double>(x.size()) / static_cast<double>(sent);
  }
};

/// Traces `samples` rays (Owen-scrambled Sobol over the window) onto the film. The same hits in the same order for any
/// `threads` (>= 1; more than one starts threads, and ends them before it returns). A ray that leaves the lens away
/// from the film is lost. Throws Error for no threads.
PETZVAL_API FilmHits trace_bundle(const Lens& lens, const PupilWindow& window, std::uint32_t samples,
                                  std::size_t wavelength = 0, std::uint32_t seed = 0, int threads = 1);

}  // namespace petzval
