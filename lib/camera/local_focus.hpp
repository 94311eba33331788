// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "lens_facts.hpp"
#include "local_focus_steps.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/expressive_lens.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "tilted_film.hpp"

namespace petzval::camera_detail {

/// map: from film and pupil point to height and slope in the plane z of the scene; middle, radius: of the stop's image,
/// middle over the film point.
EntranceMaps<double> entrance_maps(const RayMatrix& map, double z, double middle, double radius) noexcept;

/// A focus of its own for every film point, radius in the pupil and wavelength, in front of a first-order model:
/// a focal surface, and the aberrations of an expressive lens. It bends the model's rays of the scene in the plane of
/// the entrance pupil (local_focus_steps.hpp), so that film points, pupils and weights stay those of the model. It does
/// nothing to a pinhole.
///
/// Immutable, cheap to copy, shared freely between threads.
class LocalFocus {
 public:
  /// Changes nothing.
  LocalFocus() = default;
  /// Throws Error for a model that is not of first order, a
  /// lens with cylinders, numbers that are not finite or out of range, a surface nearer than the entrance pupil allows,
  /// and offsets that lead to the pupil.
  LocalFocus(const LensFacts& facts, const Film& film, const AnyRayModel& model,
             const std::optional<FocalSurface>& surface, const ExpressiveLens& expressive);

  explicit operator bool() const noexcept { return data_ != nullptr; }

  /// Bends rays of the model to the scene, in place. film_x, film_y: on the film itself; nearer: as
  /// TiltedPlane::nearer_by(), null for an upright film; N each.
  template <class T>
  void bend(std::size_t count, const T* film_x, const T* film_y, const T* nearer, const RayWavelengths& wavelengths,
            const RayArrays<T>& rays) const noexcept;
  void bend(const FilmPoint& film, double nearer, Wavelength wavelength, Ray<double>& ray) const noexcept;
  /// A ray with its derivatives by film x and y. nearer_by: those of nearer.
  void bend(const FilmPoint& film, double nearer, const Vec2<double>& nearer_by, Wavelength wavelength,
            RayDerivatives& ray) const noexcept;

  /// The model's ray that is bent to a ray of the scene (which travels towards the lens).
  struct Straight {
    Ray<double> ray{};
    double spread = 0;  ///< area of heights and slopes of bent rays over that of the model's; 0: there is no such ray
  };
  Straight straighten(const Ray<double>& ray, Wavelength wavelength,
                      const std::optional<TiltedPlane>& plane) const noexcept;

  /// See Camera::focal_steepness(). plane: of a film that is tilted or travels.
  FocalSteepness steepness(const std::optional<TiltedPlane>& plane) const noexcept;
  /// The entrance pupils that the scene sees: discs about those of all film points.
  EntrancePupilTable entrances(const Lens& lens, const AnyRayModel& model) const;
  /// Where the chief ray of a film point passes the plane of the pupils, over the point.
  double middle(std::size_t wavelength) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
