// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/kernel_vec.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The two planes that parametrise image-space rays: the film and the pupil plane. Lens frame, mm.
struct TwoPlanes {
  double film_z = 0;
  double pupil_z = 0;

  /// Distance from the film to the pupil plane along z; negative if the pupil plane lies in front of the film, as in
  /// most lenses.
  double depth() const noexcept { return pupil_z - film_z; }
};

/// The two planes of a lens.
///
/// The pupil plane is the plane of the paraxial exit pupil (primary wavelength, main meridian) if it is 0.05 to 20
/// focal lengths from the film, else the plane of the last vertex.
///
/// @throws Error if the film lies in the plane of the last vertex
PETZVAL_API TwoPlanes two_planes(const Lens& lens);

/// 1 if the direction from the film to the pupil plane is towards the scene, -1 if it is away from the scene.
PETZVAL_API double towards_scene(const Lens& lens, const TwoPlanes& space);

/// N image-space rays as a structure of arrays: their points on the film and on the pupil plane (mm), without a
/// direction of travel.
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

/// An image-space ray over a scalar: its points on the film and on the pupil plane (mm).
template <class V>
struct TwoPlaneRayOf {
  V film_x{}, film_y{}, pupil_x{}, pupil_y{};
};
using TwoPlaneRay = TwoPlaneRayOf<double>;

/// A ray over any scalar, with the members of Ray.
template <class V>
struct RayOf {
  kernel::Vec<V> origin, direction;
};

}  // namespace petzval
