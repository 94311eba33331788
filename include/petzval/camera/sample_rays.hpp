// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/film.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

namespace detail {
/// Film points for models to work with: those of the film, its middle instead of all others.
template <class T>
PETZVAL_API void keep_on_film(std::size_t count, const Film& film, const T* film_x, const T* film_y, T* kept_x,
                              T* kept_y) noexcept;

/// Weights and densities of film samples from their lines, pupil areas and fates. Samples from beside the film get
/// outside_film, those without a wavelength missed_surface, those without a pupil vignetted, and none of them a weight.
/// scale: [wavelength].
template <class T>
PETZVAL_API void weigh(std::size_t count, const Film& film, const FilmSpace& space, const CameraSamples<T>& samples,
                       const FilmLines<const T>& lines, const T* areas, const double* scale,
                       std::size_t known_wavelengths, RayFate* fates, const CameraRays<T>& rays) noexcept;
}  // namespace detail

/// Samples N camera rays of any model, block by block: pupil, ray, weight.
///
/// scale: what weights are multiplied with, for each wavelength of the model: the square of the index behind the lens
/// for irradiance. Camera does the same for its own models.
template <RayModel M, class T>
void sample_rays(const M& model, const Film& film, const double* scale, std::size_t count,
                 const CameraSamples<T>& samples, const CameraRays<T>& out) noexcept {
  constexpr std::size_t block = 256;
  alignas(64) std::array<T, block> film_x, film_y, x, y, areas;
  std::array<RayFate, block> local_fates;
  const PupilMap& pupils = model.pupils();
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const CameraSamples<T> some = samples.from(begin);
    detail::keep_on_film(n, film, some.film_x, some.film_y, film_x.data(), film_y.data());
    pupils.sample(n, film_x.data(), film_y.data(), some.pupil_u, some.pupil_v, some.wavelengths, x.data(), y.data(),
                  areas.data());
    const FilmLines<const T> lines{film_x.data(), film_y.data(), x.data(), y.data()};
    const CameraRays<T> rays = out.from(begin);
    RayFate* fates = rays.fates ? rays.fates : local_fates.data();
    model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
    detail::weigh(n, film, pupils.space(), some, lines, areas.data(), scale, pupils.wavelengths(), fates, rays);
  }
}

}  // namespace petzval
