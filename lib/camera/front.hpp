// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// The front of a lens, on which the rays of every model start: see Camera.
struct Front {
  double vertex_z = 0;
  double curvature = 0;       ///< of a sphere; 0: a plane
  bool first_surface = true;  ///< it is the lens's first surface: exact rays start there by themselves
};
/// Throws Error where glass reaches beyond 1e12 mm, as steep polynomials may.
Front front_of(const Lens& lens);

/// How far a ray in the direction of the scene is from the front, along it.
double way_to_front(const Front& front, const Ray<double>& ray) noexcept;
/// A ray whose origin is moved there, and its derivatives.
RayDerivatives at_front(const Front& front, const RayDerivatives& ray) noexcept;

}  // namespace petzval::camera_detail
