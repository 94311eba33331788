// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lens_facts.hpp"
#include "paraxial/ray_matrix.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// Maps film and pupil point of an image-space ray to height and slope in the plane z behind the lens.
inline RayMatrix line_at(const TwoPlanes& space, double z) noexcept {
  const double slope = 1 / space.depth(), far = (z - space.film_z) * slope;
  return {1 - far, far, -slope, slope};
}

/// First-order maps of rays from the two planes of image space (TwoPlanes) through the stop to the scene.
struct StopMaps {
  RayMatrix from_film;  ///< film and pupil point to height and slope in the stop, before its surface
  RayMatrix to_front;   ///< from the stop to the plane of the first vertex, in front of the lens
};
StopMaps stop_maps(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section);

/// Power (1/mm) of the thin lens in the stop that focuses first-order rays of the film centre where exact rays are
/// sharpest: in the plane with the smallest RMS distance from the axis, seen from the entrance pupil. Spherical
/// aberration moves this plane away from the paraxial focus. Chief rays do not change.
///
/// With cylinders only the heights along `section` are used. 0 if no exact ray passes.
double best_focus_power(const LensFacts& facts, std::size_t wavelength, const StopMaps& maps, Meridian section);

}  // namespace petzval::camera_detail
