// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// The front of a lens, on which the rays of every model start; see Camera.
struct Front {
  double vertex_z = 0;
  double curvature = 0;       ///< curvature of a sphere; 0 for a plane
  bool first_surface = true;  ///< true if the front is the first surface, where exact rays start
};
/// @throws Error  if glass extends beyond 1e12 mm, which steep polynomials may cause
Front front_of(const Lens& lens);

/// Distance from the origin of a ray to the front, along the ray. The ray must travel towards the scene.
double distance_to_front(const Front& front, const Ray<double>& ray) noexcept;
/// The ray with its origin moved to the front, with derivatives.
RayDerivatives at_front(const Front& front, const RayDerivatives& ray) noexcept;

}  // namespace petzval::camera_detail
