// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// The two planes between film and lens by which lines are told apart: that of the film, and one behind the lens, that
/// of the paraxial exit pupil where it lies in reach. Lens frame, mm.
struct TwoPlanes {
  double film_z = 0;
  double pupil_z = 0;

  /// From the film to the plane of the pupil along z; negative where that lies towards the scene, as in most lenses.
  double depth() const noexcept { return pupil_z - film_z; }
};

/// The planes of a lens: the pupil's is that of the paraxial exit pupil (of the central wavelength, in the main
/// meridian) where that is 0.05 to 20 focal lengths from the film, else the plane of the last vertex. Throws Error for
/// a film in the plane of the last vertex.
PETZVAL_API TwoPlanes two_planes(const Lens& lens);

/// 1 where lines run towards the scene on their way from the film to the plane of the pupil, -1 where they come from
/// it.
PETZVAL_API double towards_scene(const Lens& lens, const TwoPlanes& space);

/// Lines in the space of the film as a structure of arrays, N values each: where they meet the film and the plane of
/// the pupil, mm. Which way light runs is left to the Travel at hand.
template <class T>
struct TwoPlaneRays {
  T* film_x = nullptr;
  T* film_y = nullptr;
  T* pupil_x = nullptr;
  T* pupil_y = nullptr;

  TwoPlaneRays from(std::size_t line) const noexcept {
    return {film_x + line, film_y + line, pupil_x + line, pupil_y + line};
  }
};

}  // namespace petzval::inline v0
