// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/ray.hpp"

namespace petzval::inline v0 {

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

}  // namespace petzval::inline v0
