// SPDX-License-Identifier: Apache-2.0
#include "surface_box.hpp"

#include <algorithm>
#include <cmath>

#include "petzval/lens/lens.hpp"

namespace petzval::pupil_detail {

double half_height(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept {
  const double own = lens.surfaces()[surface].semi_diameter;
  if (std::isfinite(own)) return own;
  double widest = std::isfinite(entrance.diameter) ? entrance.diameter / 2 : 0;
  for (const LensSurface& s : lens.surfaces()) {
    if (std::isfinite(s.semi_diameter)) widest = std::max(widest, s.semi_diameter);
  }
  return widest;
}

SurfaceBox surface_box(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept {
  SurfaceBox box{.half = half_height(lens, surface, entrance), .vertex_z = lens.surfaces()[surface].vertex_z};
  // A cylinder is curved in one of the two sections only.
  constexpr int samples = 64;
  for (const bool along_x : {false, true}) {
    for (int i = 0; i <= samples; ++i) {
      const double r = box.half * i / samples;
      const double z = sag(lens, surface, along_x ? r : 0, along_x ? 0 : r);
      if (std::isnan(z)) break;
      box.z_min = std::min(box.z_min, z);
      box.z_max = std::max(box.z_max, z);
    }
  }
  const double between_samples = 0.02 * (box.z_max - box.z_min);
  box.z_min += box.vertex_z - between_samples;
  box.z_max += box.vertex_z + between_samples;
  return box;
}

SurfaceBox last_surface_box(const Lens& lens) {
  const Pupil entrance = has_pupils(lens) ? pupils(lens, lens.primary_wavelength()).entrance : Pupil{};
  return surface_box(lens, lens.surface_count() - 1, entrance);
}

}  // namespace petzval::pupil_detail
