// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/two_plane_rays.hpp"

#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

TwoPlanes two_planes(const Lens& lens) {
  const double film_z = lens.film_z(), last_z = lens.surfaces().back().vertex_z;
  if (film_z == last_z) {
    throw Error(lens.name() + ": film: z = " + to_text(last_z) + " mm; must differ from z of the last vertex");
  }
  if (!has_pupils(lens)) return {film_z, last_z};
  const std::size_t wavelength = lens.primary_wavelength();
  const Meridian meridian = main_meridian(lens, wavelength);
  const double exit_z = pupils(lens, wavelength, meridian).exit.z;
  const double reach = std::abs(first_order(lens, wavelength, meridian).effective_focal_length);
  const double depth = std::abs(exit_z - film_z);
  constexpr double nearest = 0.05, farthest = 20;  // focal lengths
  return {film_z, depth > nearest * reach && depth < farthest * reach ? exit_z : last_z};
}

double towards_scene(const Lens& lens, const TwoPlanes& space) {
  // Light travels towards +z, except behind an odd number of mirrors; the result has the opposite direction.
  return lens.light_direction(lens.surface_count()) * space.depth() > 0 ? -1 : 1;
}

}  // namespace petzval
