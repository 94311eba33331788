// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// The front of a lens, on which the rays of every model start; see Camera.
struct Front {
  double vertex_z = 0;
  double curvature = 0;       ///< curvature of a sphere; 0 for a plane
  bool first_surface = true;  ///< true if the front is the first surface, where exact rays start
};
/// @throws Error  if glass extends beyond 1e12 mm, which steep polynomials may cause
Front front_of(const Lens& lens);

}  // namespace petzval::camera_detail
