// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// A film point, a sample of its pupil, and a wavelength.
struct CameraSample {
  FilmPoint film;
  double pupil_u = 0, pupil_v = 0;  ///< in the unit square; mapped uniformly to the pupil of this film point
  Wavelength wavelength = {};
  double time = 0;  ///< part of the time that the shutter is open, 0 to 1 (clamped; not a number: 0): where a film that
                    ///< travels is
};

/// A ray that leaves the lens towards the scene, from the front of the lens (see Camera).
///
/// The mean of weight x radiance over pupil samples is the irradiance of the film point (for unity_on_axis, relative to
/// that of the axis for the same radiance). A lost ray has weight 0 and its fate. Densities are those of the sample,
/// lost or not; they are 0 for a sample outside the film or without a pupil, and 1e36 at most.
struct CameraRay {
  Ray<double> ray{};
  RayFate fate = RayFate::vignetted;
  double weight = 0;     ///< sr (irradiance), or without unit
  double pdf_film = 0;   ///< of film points distributed uniformly over the film, and as densely over its margin, 1/mm^2
  double pdf_pupil = 0;  ///< in the plane of the pupil, 1/mm^2
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
  const T* times = nullptr;  ///< null: 0, when the shutter opens

  /// The samples from a position on.
  CameraSamples from(std::size_t sample) const noexcept {
    return {film_x + sample,  film_y + sample,          pupil_u + sample,
            pupil_v + sample, wavelengths.from(sample), times ? times + sample : nullptr};
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

/// The derivatives by raster position, per pixel: those that a host's texture filters take. The raster's x runs against
/// the film's.
struct RasterDifferential {
  Ray<double> by_x{{0, 0, 0}, {0, 0, 0}}, by_y{{0, 0, 0}, {0, 0, 0}};
};
PETZVAL_API RasterDifferential by_raster(const CameraRayDifferential& ray, const Film& film) noexcept;

/// The importance of a ray from the scene, for light tracing and bidirectional methods.
///
/// The film's mean irradiance is the integral of We x radiance over the rays of the scene, in the measure cos dA dw of
/// any surface in front of the lens. (Rays that meet the film's margin have We as well, and their raster outside the
/// picture: they count for pixel filters and not for that mean.) For Normalisation::irradiance, We is the square of the
/// index in front of the lens over the film's area for every ray that arrives; there is no cosine in it. The other
/// normalisations divide We as they divide weights. The index of the film's medium changes the weights of film samples
/// by its square, and not We: derivation in lib/camera/importance.cpp.
///
/// First-order models are linear in slopes and do not conserve etendue, as no lens can that images planes sharply.
/// There We has the factor (cos t / cos t')^4, t and t' the angles of the ray with the axis behind and before the lens,
/// so that film and scene hold the same light, as they do in exact models. With polynomials they differ, the less the
/// better the fit: by 12 % at degree 3 and 2.5 % at degree 5 for a fisheye, by 4 % and 1 % for wide lenses.
struct Importance {
  double we = 0;  ///< 1/mm^2; 0 for a ray that is lost or misses the film
  /// invalid: a direction that is no unit vector (unit_direction_tolerance), or numbers that are not finite;
  /// outside_spectrum: a wavelength outside the compiled range.
  RayFate fate = RayFate::vignetted;
  FilmPoint film{};  ///< where the ray meets the plane of the film
  Vec2<double> raster{0, 0};
  double pdf_film = 0;   ///< 1/mm^2
  double pdf_pupil = 0;  ///< of the film sample with this ray, 1/mm^2
  /// The density of this ray among film samples, in the measure cos dA dw of the scene, as a product: of its position
  /// on the entrance pupil (1 / the pupil's paraxial area, 1/mm^2, in a plane across the ray) and of its direction
  /// there (1/sr). We over the product is the weight of the film sample with this ray. The product times the cosine at
  /// a scene point compares with the pdf of sample_importance() for points distributed by area.
  double pdf_position = 0, pdf_direction = 0;

  explicit operator bool() const noexcept { return we > 0; }
};

/// A connection from a scene point to the camera.
struct ImportanceSample {
  Vec3<double> direction{0, 0, 1};  ///< unit, from the point to the lens
  double distance = 0;              ///< from the point to `on_front`, mm
  Vec3<double> on_front{0, 0, 0};   ///< where the line meets the front of the lens (see Camera): shadow rays end there
  double pdf = 0;                   ///< of the direction at the point, 1/sr; 0 without a connection
  Importance importance{};

  explicit operator bool() const noexcept { return importance.we > 0; }
};

/// How the search for a film point ended.
enum class ProjectionStatus : std::uint8_t {
  converged,     ///< the point's chief ray meets the film
  outside_film,  ///< it meets the film plane outside the film
  vignetted,     ///< the lens clips it; other rays of the point may pass
  not_visible,   ///< the point has no chief ray, or one that meets the film plane far outside the film
};
/// "converged", "outside_film", "vignetted" or "not_visible".
PETZVAL_API std::string_view name(ProjectionStatus status) noexcept;

/// film and raster are set except for not_visible. For vignetted and outside_film they may have the error of a table of
/// exact chief rays, 2e-5 of the film's radius (tests/camera/projection_test.cpp).
struct Projection {
  ProjectionStatus status = ProjectionStatus::not_visible;
  FilmPoint film{};
  Vec2<double> raster{0, 0};

  explicit operator bool() const noexcept { return status == ProjectionStatus::converged; }
};

}  // namespace petzval
