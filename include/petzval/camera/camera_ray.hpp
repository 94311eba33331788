// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/ray.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval::inline v0 {

/// A film point, a sample of its pupil, and a wavelength.
struct CameraSample {
  FilmPoint film;
  double pupil_u = 0, pupil_v = 0;  ///< in the unit square; mapped uniformly to the pupil of this film point
  Wavelength wavelength = {};
};

/// A ray that leaves the lens towards the scene.
///
/// The mean of weight x radiance over pupil samples is the irradiance of the film point (for unity_on_axis, relative to
/// that of the axis for the same radiance). A lost ray has weight 0 and its fate. Densities are those of the sample,
/// lost or not; they are 0 for a sample outside the film or without a pupil.
struct CameraRay {
  Ray<double> ray{};
  RayFate fate = RayFate::vignetted;
  double weight = 0;         ///< sr (irradiance), or without unit (unity_on_axis)
  double pdf_film = 0;       ///< of film points distributed uniformly over the film, 1/mm^2
  double pdf_pupil = 0;      ///< in the plane of the pupil, 1/mm^2
  double pdf_direction = 0;  ///< of the direction at the film point, in solid angle, 1/sr

  explicit operator bool() const noexcept { return weight > 0; }
};

/// The same as structures of arrays, N values each. Outputs must not alias inputs.
template <class T>
struct CameraSamples {
  const T* film_x = nullptr;
  const T* film_y = nullptr;
  const T* pupil_u = nullptr;
  const T* pupil_v = nullptr;
  RayWavelengths wavelengths{};

  /// The samples from a position on.
  CameraSamples from(std::size_t sample) const noexcept {
    return {film_x + sample, film_y + sample, pupil_u + sample, pupil_v + sample, wavelengths.from(sample)};
  }
};
template <class T>
struct CameraRays {
  RayArrays<T> rays;
  T* weights = nullptr;
  RayFate* fates = nullptr;    ///< may be null
  T* pdf_pupil = nullptr;      ///< may be null
  T* pdf_direction = nullptr;  ///< may be null

  /// The rays from a position on.
  CameraRays from(std::size_t ray) const noexcept {
    return {{rays.x + ray, rays.y + ray, rays.z + ray, rays.dx + ray, rays.dy + ray, rays.dz + ray},
            weights + ray,
            fates ? fates + ray : nullptr,
            pdf_pupil ? pdf_pupil + ray : nullptr,
            pdf_direction ? pdf_direction + ray : nullptr};
  }
};

/// A camera ray and the exact derivatives of its point and direction by film x and film y, per mm, for a constant pupil
/// sample.
struct CameraRayDifferential {
  CameraRay sample{};
  Ray<double> by_film_x{{0, 0, 0}, {0, 0, 0}}, by_film_y{{0, 0, 0}, {0, 0, 0}};
};

}  // namespace petzval::inline v0
