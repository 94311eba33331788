// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lens_section.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::figure_detail {

/// The path of one ray through a lens in a section.
struct RayPath {
  std::size_t field = 0;              ///< index of the field
  double stop_height = 0;             ///< relative height in the stop: 0 at the centre, 1 at the rim
  SectionLine hits;                   ///< on the surfaces in the order of travel, up to the surface that ends the ray
  std::vector<std::size_t> surfaces;  ///< of the hits
  SectionPoint before, behind;        ///< directions in object space and after the last hit
  RayFate fate = RayFate::transmitted;
};

/// Traces rays of each field in a section: `count` transmitted rays (3 or more), equally spaced in the stop from edge
/// to edge, including the chief ray.
///
/// Vignetted rays through the rim or the centre of the stop come last and end at a surface. Rays that do not exist or
/// miss the first surface are left out.
std::vector<RayPath> ray_paths(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                               Meridian meridian, std::size_t count, std::size_t wavelength);

}  // namespace petzval::figure_detail
