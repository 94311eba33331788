// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/ray.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/field_point.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// What a renderer asks for: a point of the film, a sample of its pupil, a wavelength.
struct CameraSample {
  FilmPoint film;
  double pupil_u = 0, pupil_v = 0;  ///< in the unit square; evenly over the model's own pupil of this film point
  Wavelength wavelength = {};
};

/// A ray that leaves the lens towards the scene.
///
/// weight: the mean of weight x radiance over pupil samples is the irradiance of the film point (or, normalised to the
/// axis, relative to what the axis gets from the same radiance). It is 0, with the fate, for a ray that is lost; the
/// densities are those of the sample all the same, and 0 for one that has none (beside the film, without a pupil).
struct CameraRay {
  Ray<double> ray{};
  RayFate fate = RayFate::vignetted;
  double weight = 0;         ///< sr (irradiance), or without unit
  double pdf_film = 0;       ///< of film points spread evenly over the film, 1/mm^2
  double pdf_pupil = 0;      ///< in the plane of the pupil, 1/mm^2
  double pdf_direction = 0;  ///< of the direction at the film point, in solid angle, 1/sr

  explicit operator bool() const noexcept { return weight > 0; }
};

/// The same as structures of arrays, N values each. Rays must not lie where samples do: these are read once more.
template <class T>
struct CameraSamples {
  const T* film_x = nullptr;
  const T* film_y = nullptr;
  const T* pupil_u = nullptr;
  const T* pupil_v = nullptr;
  RayWavelengths wavelengths{};

  /// Those from a position on.
  CameraSamples from(std::size_t sample) const noexcept {
    return {film_x + sample, film_y + sample, pupil_u + sample, pupil_v + sample, wavelengths.from(sample)};
  }
};
template <class T>
struct CameraRays {
  RayArrays<T> rays;
  T* weights = nullptr;
  RayFate* fates = nullptr;    ///< may be null, where they are not wanted
  T* pdf_pupil = nullptr;      ///< may be null
  T* pdf_direction = nullptr;  ///< may be null

  /// Those from a position on.
  CameraRays from(std::size_t ray) const noexcept {
    return {{rays.x + ray, rays.y + ray, rays.z + ray, rays.dx + ray, rays.dy + ray, rays.dz + ray},
            weights + ray,
            fates ? fates + ray : nullptr,
            pdf_pupil ? pdf_pupil + ray : nullptr,
            pdf_direction ? pdf_direction + ray : nullptr};
  }
};

/// How a camera ray changes with the film point, the pupil sample held: exact derivatives of its point and direction by
/// film x and film y, per mm.
struct CameraRayDifferential {
  CameraRay sample{};
  Ray<double> by_film_x{{0, 0, 0}, {0, 0, 0}}, by_film_y{{0, 0, 0}, {0, 0, 0}};
};

}  // namespace petzval::inline v0
