// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lens_facts.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// Film and pupil point of a line to its height and slope in the plane z behind the lens.
inline RayMatrix line_at(const TwoPlanes& space, double z) noexcept {
  const double slope = 1 / space.depth(), far = (z - space.film_z) * slope;
  return {1 - far, far, -slope, slope};
}

/// First-order rays of a lens between the planes of its image space and the scene, by way of the stop.
struct StopMaps {
  RayMatrix from_film;  ///< film and pupil point to height and slope in the stop, before its surface
  RayMatrix to_front;   ///< on to the plane of the first vertex, in front of the lens
};
StopMaps stop_maps(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section);

/// What a thin lens in the stop adds to slopes on their way to the scene, per height, 1/mm, for rays of first order
/// from the film's centre to meet the plane in which the exact ones from there are sharpest: their RMS distance from
/// the axis, as seen from the entrance pupil, is least there. With spherical aberration it is not the paraxial one.
///
/// The centre of the stop, and with it every chief ray, stays where it is. Of a lens with cylinders heights are those
/// along the section. 0 where no exact ray passes.
double best_focus_power(const LensFacts& facts, std::size_t wavelength, const StopMaps& maps, Meridian section);

}  // namespace petzval::camera_detail
