// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "front.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "tilted_film.hpp"

namespace petzval::inline v0::camera_detail {

/// What samples of a film are drawn from.
struct FilmView {
  const AnyRayModel& model;
  const Film& film;
  const TiltedFilm* tilted =
      nullptr;  ///< of the same film, with the model's pupils; null for an upright one that stays
  /// What weights are multiplied with, one for each wavelength: the square of the index behind the lens for irradiance.
  std::span<const double> scale;
  Front front = {};  ///< of the lens

  /// Rays of the model start elsewhere.
  bool moves_rays() const noexcept {
    const bool exact = model.kind() == ModelKind::exact_float || model.kind() == ModelKind::exact_double;
    return !(exact && front.first_surface);
  }
};

/// Samples N camera rays, block by block: pupil, ray, weight.
template <class T>
PETZVAL_API void sample_rays(const FilmView& view, std::size_t count, const CameraSamples<T>& samples,
                             const CameraRays<T>& rays) noexcept;
/// One ray, within rounding that of a batch. The wavelength is a position. pdf_film is left out.
CameraRay sample_ray(const FilmView& view, const FilmPoint& film, double u, double v, std::size_t wavelength,
                     double time) noexcept;

}  // namespace petzval::inline v0::camera_detail
