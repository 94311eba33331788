// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "petzval/camera/any_model.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/importance.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/camera/tilted_film.hpp"
#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval::inline v0 {

/// What the weights of a camera are measured in.
enum class Normalisation : std::uint8_t {
  irradiance,     ///< of the film, for a scene of radiance 1: natural darkening, f-number and all
  unity_on_axis,  ///< divided by that on the axis: a uniform scene of radiance 1 gives 1 there
};

struct CameraOptions {
  ModelKind model = ModelKind::exact_float;
  Normalisation normalisation = Normalisation::irradiance;
};

/// What a renderer holds: a film behind a focused lens, seen through one of the ray models.
///
///     Lens lens = with_focus(with_f_number(compile(prescription), 2.8), 3000, {.origin = DistanceOrigin::film});
///     Camera camera(lens, {.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280});
///     CameraRay r = camera.sample({.film = camera.film().point(column, row), .pupil_u = u, .pupil_v = v});
///     if (r) pixel += r.weight * radiance(r.ray);
///
/// Built once, immutable, cheap to copy, shared freely between threads. Calls allocate nothing, draw no random numbers
/// and never try again: a sample that is lost has weight 0 and a fate. Lens frame, mm; host_frame.hpp has the frames of
/// hosts.
class PETZVAL_API Camera {
 public:
  /// A tilted film makes it take two to six times as long (34 ms rather than 10 for a double Gauss): tilts are fitted
  /// without cameras. Throws Error for a film without area or pixels, one that is tilted into the lens or beside its
  /// last element or comes near to the plane of the pupil, and where the model cannot be built: no pupil, a film in the
  /// plane of the last vertex, a first-order or polynomial model of a lens with cylinders.
  Camera(const Lens& lens, const Film& film, const CameraOptions& options = {});
  /// With a model of the closed set that was built before: fitted polynomials, say, that were read from a file. Throws
  /// Error also for one with other wavelengths, another place of the film or a film smaller than upright_radius().
  Camera(const Lens& lens, const Film& film, AnyModel model, Normalisation normalisation = Normalisation::irradiance);

  const Lens& lens() const noexcept;
  const Film& film() const noexcept;
  ModelKind model() const noexcept;
  /// Those of the model, by points of the upright film.
  const FilmPupilTable& pupils() const noexcept;
  /// A tilted film and its pupils; null for an upright one.
  const TiltedFilm* tilted_film() const noexcept;

  /// One ray; within rounding that of a batch. A film point outside the film or not finite: outside_film. A wavelength
  /// that was not compiled: missed_surface. A pupil without area and pupil samples that are not finite: vignetted.
  CameraRay sample(const CameraSample& sample) const noexcept;
  /// N rays, float or double, in the precision of the model.
  template <class T>
  void sample(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays) const noexcept;

  /// One ray with its exact derivatives.
  CameraRayDifferential sample_differential(const CameraSample& sample) const noexcept;

  /// What the camera makes of a ray from the scene, anywhere on its line, running towards the lens.
  Importance importance(const Ray<double>& ray, Wavelength wavelength = {}) const noexcept;
  /// Connects a scene point (lens frame, mm) to the lens: a sample of what of the entrance pupil it sees.
  ImportanceSample sample_importance(const Vec3<double>& point, double u, double v,
                                     Wavelength wavelength = {}) const noexcept;
  /// The density with which `sample_importance` gives a direction at a point, 1/sr.
  double pdf_importance(const Vec3<double>& point, const Vec3<double>& direction,
                        Wavelength wavelength = {}) const noexcept;

  /// Where the camera sees a scene point: its chief ray's film point and place in the picture.
  Projection project(const Vec3<double>& point, Wavelength wavelength = {}) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::inline v0
