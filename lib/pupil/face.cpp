// SPDX-License-Identifier: Apache-2.0
#include "face.hpp"

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
  return 4 * widest;
}

Face face_of(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept {
  Face face{.half = half_height(lens, surface, entrance), .vertex_z = lens.surfaces()[surface].vertex_z};
  // A cylinder is curved in one of the two sections only.
  constexpr int samples = 64;
  for (const bool along_x : {false, true}) {
    for (int i = 0; i <= samples; ++i) {
      const double r = face.half * i / samples;
      const double z = sag(lens, surface, along_x ? r : 0, along_x ? 0 : r);
      if (std::isnan(z)) break;
      face.z_min = std::min(face.z_min, z);
      face.z_max = std::max(face.z_max, z);
    }
  }
  const double between_samples = 0.02 * (face.z_max - face.z_min);
  face.z_min += face.vertex_z - between_samples;
  face.z_max += face.vertex_z + between_samples;
  return face;
}

Face last_face(const Lens& lens) {
  const Pupil entrance = has_pupils(lens) ? pupils(lens, lens.primary_wavelength()).entrance : Pupil{};
  return face_of(lens, lens.surface_count() - 1, entrance);
}

}  // namespace petzval::pupil_detail
