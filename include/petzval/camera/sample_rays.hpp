// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/camera/tilted_film.hpp"
#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"

namespace petzval::inline v0 {

namespace camera_detail {
/// Film points for models to work with: those of the film, its middle instead of all others.
template <class T>
PETZVAL_API void keep_on_film(std::size_t count, const Film& film, const T* film_x, const T* film_y, T* kept_x,
                              T* kept_y) noexcept;

/// Weights and densities of film samples from their lines, pupil areas and fates. Samples from beside the film get
/// outside_film, those without a wavelength missed_surface, those without a pupil vignetted, and none of them a weight.
/// scale: [wavelength].
template <class T>
PETZVAL_API void weigh(std::size_t count, const Film& film, const FilmPupilTable& pupils,
                       const CameraSamples<T>& samples, const TwoPlaneRays<const T>& lines, const T* areas,
                       const double* scale, RayFate* fates, const CameraRays<T>& rays) noexcept;

/// Of a tilted film: keys of film points; upright film points of their lines through the pupil; a pinhole's samples
/// (the upright film points of its rays, and places of the pupil); lines outside a model's pupils vignetted; weights
/// and densities of upright lines made the film's.
template <class T>
PETZVAL_API void to_keys(std::size_t count, const TiltedFilm& film, const T* film_x, const T* film_y, T* key_x,
                         T* key_y) noexcept;
template <class T>
PETZVAL_API void to_upright(std::size_t count, const TiltedFilm& film, const T* key_x, const T* key_y, const T* pupil_x,
                            const T* pupil_y, T* film_x, T* film_y) noexcept;
template <class T>
PETZVAL_API void sample_pinhole(std::size_t count, const TiltedFilm& film, const FilmPupilTable& pupils,
                                std::span<const double> shifts, const CameraSamples<T>& samples, const T* key_x,
                                const T* key_y, T* film_x, T* film_y, T* x, T* y, T* areas) noexcept;
template <class T>
PETZVAL_API void keep_within(std::size_t count, const FilmPupilTable& pupils, const TwoPlaneRays<const T>& lines,
                             const RayWavelengths& wavelengths, RayFate* fates) noexcept;
template <class T>
PETZVAL_API void lean(std::size_t count, const TiltedFilm& film, const T* key_x, const T* key_y, const T* pupil_x,
                      const T* pupil_y, RayFate* fates, const CameraRays<T>& rays) noexcept;
}  // namespace camera_detail

/// Samples N camera rays of any model, block by block: pupil, ray, weight.
///
/// scale: what weights are multiplied with, for each wavelength of the model: the square of the index behind the lens
/// for irradiance. Camera does the same for its own models. film: upright; nothing lies on one that is tilted, which
/// takes the call below.
template <RayModel M, class T>
void sample_rays(const M& model, const Film& film, const double* scale, std::size_t count,
                 const CameraSamples<T>& samples, const CameraRays<T>& out) noexcept {
  constexpr std::size_t block = 256;
  alignas(64) std::array<T, block> film_x, film_y, x, y, areas;
  std::array<RayFate, block> local_fates;
  const FilmPupilTable& pupils = model.pupils();
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const CameraSamples<T> some = samples.from(begin);
    camera_detail::keep_on_film(n, film, some.film_x, some.film_y, film_x.data(), film_y.data());
    pupils.sample(n, film_x.data(), film_y.data(), some.pupil_u, some.pupil_v, some.wavelengths, x.data(), y.data(),
                  areas.data());
    const TwoPlaneRays<const T> lines{film_x.data(), film_y.data(), x.data(), y.data()};
    const CameraRays<T> rays = out.from(begin);
    RayFate* fates = rays.fates ? rays.fates : local_fates.data();
    model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
    camera_detail::weigh(n, film, pupils, some, lines, areas.data(), scale, fates, rays);
  }
}

/// The same for a tilted film, made with the model's pupils.
template <RayModel M, class T>
void sample_rays(const M& model, const TiltedFilm& tilted, const double* scale, std::size_t count,
                 const CameraSamples<T>& samples, const CameraRays<T>& out) noexcept {
  constexpr std::size_t block = 256;
  alignas(64) std::array<T, block> key_x, key_y, film_x, film_y, x, y, areas;
  std::array<RayFate, block> local_fates;
  const FilmPupilTable& pupils = model.pupils();
  Film flat = tilted.film();  // the rectangle in the film's own plane
  flat.tilt_rad = flat.swing_rad = 0;
  std::span<const double> pinhole_shifts;
  if constexpr (requires { model.pinhole_shifts(); }) pinhole_shifts = model.pinhole_shifts();
  const bool pinhole = !pinhole_shifts.empty();
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const CameraSamples<T> some = samples.from(begin);
    camera_detail::keep_on_film(n, flat, some.film_x, some.film_y, film_x.data(), film_y.data());
    camera_detail::to_keys(n, tilted, film_x.data(), film_y.data(), key_x.data(), key_y.data());
    const TwoPlaneRays<const T> lines{film_x.data(), film_y.data(), x.data(), y.data()};
    const CameraRays<T> rays = out.from(begin);
    RayFate* fates = rays.fates ? rays.fates : local_fates.data();
    const auto to_upright = [&] {
      camera_detail::to_upright(n, tilted, key_x.data(), key_y.data(), x.data(), y.data(), film_x.data(),
                                film_y.data());
    };
    if (pinhole) {
      camera_detail::sample_pinhole(n, tilted, pupils, pinhole_shifts, some, key_x.data(), key_y.data(), film_x.data(),
                                    film_y.data(), x.data(), y.data(), areas.data());
    } else {
      tilted.pupils().sample(n, key_x.data(), key_y.data(), some.pupil_u, some.pupil_v, some.wavelengths, x.data(),
                             y.data(), areas.data());
      to_upright();
    }
    model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
    if (pinhole) {
      to_upright();  // of the lines that the weights are for
    } else if constexpr (!ends_at_rims<M>) {
      camera_detail::keep_within(n, pupils, lines, some.wavelengths, fates);
    }
    camera_detail::weigh(n, flat, pupils, some, lines, areas.data(), scale, fates, rays);
    camera_detail::lean(n, tilted, key_x.data(), key_y.data(), x.data(), y.data(), fates, rays);
  }
}

}  // namespace petzval::inline v0
