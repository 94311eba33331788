// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "section.hpp"

namespace petzval::inline v0::figure_detail {

/// The way of one ray through a lens, seen in a section.
struct RayPath {
  std::size_t field = 0;        ///< its place in the list
  double stop_height = 0;       ///< where it passes the stop: 0 the centre, 1 the rim
  SectionLine hits;             ///< on the surfaces, in their order, to the one that ends it
  SectionPoint before, behind;  ///< direction in object space, and where it was last
  RayFate fate = RayFate::transmitted;
};

/// Rays of each field in a section: `count` (3 or more) spread over what passes, from its one edge to the other and
/// with the chief ray among them, equally spaced on the stop. Where rims take a part of the stop, the rays through its
/// own rim, or centre, come last and end there. Rays that do not exist, or pass beside the first surface, are left out.
std::vector<RayPath> ray_paths(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                               Meridian meridian, std::size_t count, std::size_t wavelength);

}  // namespace petzval::inline v0::figure_detail
