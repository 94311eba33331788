// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "camera/ray_model.hpp"
#include "lens_facts.hpp"
#include "local_focus_steps.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "tilted_film.hpp"

namespace petzval::camera_detail {

/// Maps from the film to the entrance pupil.
/// @param map from film and pupil point to height and slope in the plane z of the scene
/// @param middle centre of the image of the stop, divided by the film point
/// @param radius radius of the image of the stop, mm
EntranceMaps<double> entrance_maps(const RayMatrix& map, double z, double middle, double radius) noexcept;

/// Individual focus for every film point, radius in the pupil and wavelength, for a first-order model: a focal surface
/// and the aberrations of an expressive lens. Rays of the model are bent in the plane of the entrance pupil
/// (local_focus_steps.hpp), so that film points, pupils and weights stay the same. Pinholes do not change.
///
/// Immutable, cheap to copy, thread-safe.
class LocalFocus {
 public:
  /// Does not bend rays.
  LocalFocus() = default;
  /// @throws Error  if the model is not of first order, the lens has cylinders, numbers are not finite or out of range,
  ///                the surface is too close to the entrance pupil, or film offsets reach the pupil
  LocalFocus(const LensFacts& facts, const Film& film, const std::shared_ptr<const RayModel>& model,
             const std::optional<FocalSurface>& surface, const ExpressiveLens& expressive);

  explicit operator bool() const noexcept { return data_ != nullptr; }

  /// Bends N rays of the model to the scene, in place.
  /// @param film_x, film_y positions on the (tilted) film, mm
  /// @param excess TiltedPlane::distance_excess(); null for an upright film
  template <class T>
  void bend(std::size_t count, const T* film_x, const T* film_y, const T* excess, const RayWavelengths& wavelengths,
            const RayArrays<T>& rays) const noexcept;
  void bend(const FilmPoint& film, double excess, Wavelength wavelength, Ray<double>& ray) const noexcept;
  /// Bends a ray with its derivatives with respect to film x and y.
  void bend(const FilmPoint& film, const kernel::Dual& excess, Wavelength wavelength,
            RayOf<kernel::Dual>& ray) const noexcept;

  /// The ray of the model that is bent to a given ray of the scene. The ray travels towards the lens.
  struct Straight {
    Ray<double> ray{};
    double spread = 0;  ///< area of heights and slopes of bent rays over area of the model's; 0 if there is no ray
  };
  Straight straighten(const Ray<double>& ray, Wavelength wavelength,
                      const std::optional<TiltedPlane>& plane) const noexcept;

  /// See Camera::focal_steepness().
  /// @param plane plane of a film that is tilted or travels
  double steepness(const std::optional<TiltedPlane>& plane, FilmPoint* steepest) const noexcept;
  /// The entrance pupils for points of the scene: discs that enclose the pupils of all film points.
  EntrancePupilTable entrances(const Lens& lens, const RayModel& model, int threads) const;
  /// Intersection of chief rays with the pupil plane, divided by the film point.
  double middle(std::size_t wavelength) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
