// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The two planes that parametrise image-space rays: the film, and the plane of the pupil behind the lens, that of the
/// paraxial exit pupil where it lies in reach. Lens frame, mm.
struct TwoPlanes {
  double film_z = 0;
  double pupil_z = 0;

  /// From the film to the plane of the pupil along z; negative where that lies towards the scene, as in most lenses.
  double depth() const noexcept { return pupil_z - film_z; }
};

/// The planes of a lens. The plane of the pupil is that of the paraxial exit pupil (of the primary wavelength, in the
/// main meridian) where that is 0.05 to 20 focal lengths from the film, else the plane of the last vertex. Throws Error
/// for a film in the plane of the last vertex.
PETZVAL_API TwoPlanes two_planes(const Lens& lens);

/// 1 where the way from the film to the plane of the pupil leads towards the scene, -1 where it leads away from it.
PETZVAL_API double towards_scene(const Lens& lens, const TwoPlanes& space);

/// Image-space rays as a structure of arrays, N values each: where they meet the film and the plane of the pupil, mm.
/// The direction of travel is not part of them.
template <class T>
struct TwoPlaneRays {
  T* film_x = nullptr;
  T* film_y = nullptr;
  T* pupil_x = nullptr;
  T* pupil_y = nullptr;

  TwoPlaneRays from(std::size_t ray) const noexcept {
    return {film_x + ray, film_y + ray, pupil_x + ray, pupil_y + ray};
  }
};

/// An image-space ray by two planes: where it meets the film and the plane of the pupil, mm.
struct TwoPlaneRay {
  double film_x = 0, film_y = 0, pupil_x = 0, pupil_y = 0;
};

/// Such a ray and its derivatives by two parameters.
struct TwoPlaneRayDerivatives {
  TwoPlaneRay line{}, by_u{}, by_v{};
};

/// A ray and the derivatives of its origin and direction by two parameters; 0 for a ray that is lost.
struct RayDerivatives {
  RayFate fate = RayFate::transmitted;
  Ray<double> ray{}, by_u{{0, 0, 0}, {0, 0, 0}}, by_v{{0, 0, 0}, {0, 0, 0}};
};

}  // namespace petzval
