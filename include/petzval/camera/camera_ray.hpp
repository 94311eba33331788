// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// A sample of a camera: film point, pupil sample, wavelength and time.
struct CameraSample {
  FilmPoint film;
  double pupil_u = 0, pupil_v = 0;  ///< in the unit square, mapped uniformly to the pupil of the film point
  Wavelength wavelength = {};
  /// Fraction of the exposure, 0 to 1 (clamped; NaN: 0): sets the position of a film that travels.
  double time = 0;
};

/// A ray from the front of the lens (see Camera) towards the scene, with its weight and densities.
///
/// The mean of weight * radiance over pupil samples is the irradiance of the film point (for unity_on_axis, relative to
/// the axis). A lost ray has weight 0 and a fate. Densities describe the sample, also of a lost ray; they are at most
/// 1e36, and 0 if the sample is outside the film or has no pupil.
struct CameraRay {
  Ray<double> ray{};
  RayFate fate = RayFate::vignetted;
  double weight = 0;         ///< sr for Normalisation::irradiance, else without unit
  double pdf_film = 0;       ///< 1 / area of the film, also in its margin, 1/mm^2
  double pdf_pupil = 0;      ///< density in the pupil plane, 1/mm^2
  double pdf_direction = 0;  ///< density of the direction at the film point, in solid angle, 1/sr

  explicit operator bool() const noexcept { return weight > 0; }
};

/// N samples as a structure of arrays. CameraRays must not alias the samples.
template <class T>
struct CameraSamples {
  const T* film_x = nullptr;
  const T* film_y = nullptr;
  const T* pupil_u = nullptr;
  const T* pupil_v = nullptr;
  RayWavelengths wavelengths{};
  const T* times = nullptr;  ///< null: 0, as the shutter opens

  /// The samples from index `sample` on.
  CameraSamples from(std::size_t sample) const noexcept {
    return {film_x + sample,  film_y + sample,          pupil_u + sample,
            pupil_v + sample, wavelengths.from(sample), times ? times + sample : nullptr};
  }
};

/// N rays as a structure of arrays.
template <class T>
struct CameraRays {
  RayArrays<T> rays;
  T* weights = nullptr;
  RayFate* fates = nullptr;    ///< may be null
  T* pdf_pupil = nullptr;      ///< may be null
  T* pdf_direction = nullptr;  ///< may be null

  /// The rays from index `ray` on.
  CameraRays from(std::size_t ray) const noexcept {
    return {{rays.x + ray, rays.y + ray, rays.z + ray, rays.dx + ray, rays.dy + ray, rays.dz + ray},
            weights + ray,
            fates ? fates + ray : nullptr,
            pdf_pupil ? pdf_pupil + ray : nullptr,
            pdf_direction ? pdf_direction + ray : nullptr};
  }
};

/// A camera ray and the exact derivatives of its origin and direction by film x and film y (per mm). The offset of the
/// ray from the middle of the pupil stays constant.
struct CameraRayDifferential {
  CameraRay sample{};
  Ray<double> by_film_x{{0, 0, 0}, {0, 0, 0}}, by_film_y{{0, 0, 0}, {0, 0, 0}};
};

/// Derivatives of a camera ray by raster x and by raster y (per pixel), for texture filters. Raster x runs opposite to
/// film x.
PETZVAL_API std::array<Ray<double>, 2> by_raster(const CameraRayDifferential& ray, const Film& film) noexcept;

/// Importance of a ray from the scene, for light tracing and bidirectional methods.
///
/// The mean irradiance of the film is the integral of We * radiance over the scene rays, in the measure cos dA dw of
/// any surface in front of the lens. Rays into the film's margin also have We, but count for pixel filters only. For
/// Normalisation::irradiance, We is the squared index in front of the lens divided by the film's area, for every ray
/// that arrives; it contains no cosine and no index of the film's medium (derivation: lib/camera/importance.cpp). The
/// other normalisations divide We as they divide weights. First-order models do not conserve etendue; their We has the
/// factor (cos t / cos t')^4, with the angles t and t' of the ray to the axis behind and in front of the lens, so that
/// light tracing gives the irradiance of film sampling.
///
/// Accuracy: light tracing and film sampling agree for exact and first-order models. For polynomials of degree 3 and 5
/// they differ by 12 % and 2.5 % for a fisheye, 4 % and 1 % for wide-angle lenses.
struct Importance {
  double we = 0;  ///< 1/mm^2; 0 if the ray is lost or misses the film
  /// invalid if the direction is no unit vector (unit_direction_tolerance) or a number is not finite; outside_spectrum
  /// if the wavelength is outside the compiled range.
  RayFate fate = RayFate::vignetted;
  FilmPoint film{};  ///< intersection of the ray with the film plane
  Vec2<double> raster{0, 0};
  double pdf_film = 0;   ///< 1/mm^2
  double pdf_pupil = 0;  ///< CameraRay::pdf_pupil of the film sample with this ray, 1/mm^2
  /// pdf_position * pdf_direction is the density of this ray among film samples, in the measure cos dA dw of the scene.
  /// pdf_position: 1 / paraxial area of the entrance pupil, in a plane perpendicular to the ray (1/mm^2);
  /// pdf_direction: in solid angle (1/sr). We divided by the product is the weight of the film sample with this ray.
  /// The product times the cosine at a scene point is comparable to the pdf of sample_importance() for points
  /// distributed by area.
  double pdf_position = 0, pdf_direction = 0;

  explicit operator bool() const noexcept { return we > 0; }
};

/// A connection from a scene point to the camera.
struct ImportanceSample {
  Vec3<double> direction{0, 0, 1};  ///< unit, from the point to the lens
  double distance = 0;              ///< from the point to `on_front`, mm
  Vec3<double> on_front{0, 0, 0};   ///< end of the shadow ray, on the front of the lens (see Camera)
  double pdf = 0;                   ///< density of the direction at the point, 1/sr; 0 if there is no connection
  Importance importance{};

  explicit operator bool() const noexcept { return importance.we > 0; }
};

/// A camera ray at one of the wavelengths of a path (Camera::sample_path()).
struct PathWavelength {
  Vec2<double> raster{0, 0};  ///< intersection of the ray with the film at this wavelength
  double weight = 0;  ///< for the mean of weight * radiance at this wavelength, in the unit of CameraRay::weight
  /// Density of the ray among film samples of this wavelength, as Importance::pdf_position * pdf_direction.
  double density = 0;
  RayFate fate = RayFate::vignetted;
};

/// The projection of a scene point; `film` and `raster` are set unless the status is no_ray: the point has no
/// chief ray, or its chief ray meets the film plane far outside the film.
///
/// Accuracy: for vignetted and outside_film, 2e-5 of the film's radius, from a table of exact chief rays
/// (tests/camera/projection_test.cpp).
struct Projection {
  AimStatus status = AimStatus::no_ray;
  FilmPoint film{};
  Vec2<double> raster{0, 0};

  explicit operator bool() const noexcept { return status == AimStatus::converged; }
};

}  // namespace petzval
