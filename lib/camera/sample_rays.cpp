// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/sample_rays.hpp"

#include <array>

#include "camera_loops.hpp"
#include "tilted_pinhole.hpp"

namespace petzval::inline v0::camera_detail {
namespace {

/// Nothing lies on a tilted film that is taken for an upright one.
template <class T>
FilmBounds<T> bounds_of(const Film& film) noexcept {
  if (film.tilted()) return {T(0), T(0), T(-1), T(-1)};
  return film_detail::bounds_of<T>(film);
}

template <class T>
TiltedBounds<T> bounds_of(const TiltedFilm& film) noexcept {
  const TiltedPlane& p = film.plane();
  const auto number = [](double x) { return static_cast<T>(x); };
  return {number(p.x_by_x),     number(p.x_by_y),  number(p.y_by_y),  number(p.depth_by_x),
          number(p.depth_by_y), number(p.slope_x), number(p.slope_y), number(p.cosine)};
}

}  // namespace

template <class T>
void to_keys(std::size_t count, const TiltedFilm& film, const T* film_x, const T* film_y, T* key_x, T* key_y) noexcept {
  camera_loops().of<T>().to_keys(bounds_of<T>(film), count, film_x, film_y, key_x, key_y);
}

template <class T>
void to_upright(std::size_t count, const TiltedFilm& film, const T* key_x, const T* key_y, const T* pupil_x,
                const T* pupil_y, T* film_x, T* film_y) noexcept {
  camera_loops().of<T>().to_upright(bounds_of<T>(film), count, key_x, key_y, pupil_x, pupil_y, film_x, film_y);
}

template <class T>
void sample_pinhole(std::size_t count, const TiltedFilm& film, const FilmPupilTable& pupils,
                    std::span<const double> shifts, const CameraSamples<T>& samples, const T* key_x, const T* key_y,
                    T* film_x, T* film_y, T* x, T* y, T* areas) noexcept {
  const auto shift = [&](std::size_t i) {
    const std::size_t w = samples.wavelengths.position(i, pupils.primary_wavelength());
    return w < shifts.size() ? shifts[w] : 0;
  };
  const auto part = [&](std::size_t i) { return part_of_key(film.plane(), {key_x[i], key_y[i]}, shift(i)); };
  for (std::size_t i = 0; i < count; ++i) {
    film_x[i] = static_cast<T>(key_x[i] * part(i)), film_y[i] = static_cast<T>(key_y[i] * part(i));
  }
  pupils.sample(count, film_x, film_y, samples.pupil_u, samples.pupil_v, samples.wavelengths, x, y, areas);
  for (std::size_t i = 0; i < count; ++i) {
    const double p = part(i), chief_x = shift(i) * film_x[i], chief_y = shift(i) * film_y[i];
    x[i] = static_cast<T>(chief_x + p * (x[i] - chief_x)), y[i] = static_cast<T>(chief_y + p * (y[i] - chief_y));
    areas[i] = static_cast<T>(p * p * areas[i]);
  }
}

template <class T>
void keep_within(std::size_t count, const FilmPupilTable& pupils, const TwoPlaneRays<const T>& lines,
                 const RayWavelengths& wavelengths, RayFate* fates) noexcept {
  constexpr std::size_t block = 256;
  std::array<std::uint8_t, block> within;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    pupils.contains(n, lines.from(begin), wavelengths.from(begin), within.data());
    for (std::size_t i = 0; i < n; ++i) fates[begin + i] = within[i] ? fates[begin + i] : RayFate::vignetted;
  }
}

template <class T>
void lean(std::size_t count, const TiltedFilm& film, const T* key_x, const T* key_y, const T* pupil_x, const T* pupil_y,
          RayFate* fates, const CameraRays<T>& rays) noexcept {
  camera_loops().of<T>().lean(bounds_of<T>(film), count, key_x, key_y, pupil_x, pupil_y, fates, rays);
}

template <class T>
void keep_on_film(std::size_t count, const Film& film, const T* film_x, const T* film_y, T* kept_x,
                  T* kept_y) noexcept {
  camera_loops().of<T>().keep_on_film(bounds_of<T>(film), count, film_x, film_y, kept_x, kept_y);
}

template <class T>
void weigh(std::size_t count, const Film& film, const FilmPupilTable& pupils, const CameraSamples<T>& samples,
           const TwoPlaneRays<const T>& lines, const T* areas, const double* scale, RayFate* fates,
           const CameraRays<T>& rays) noexcept {
  constexpr std::size_t block = 64;
  std::array<T, block> scales;
  const auto scale_of = [&](std::size_t w) { return w < pupils.wavelengths() ? static_cast<T>(scale[w]) : T(0); };
  if (!samples.wavelengths.each) scales.fill(scale_of(samples.wavelengths.all.position(pupils.primary_wavelength())));
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    if (samples.wavelengths.each) {
      for (std::size_t i = 0; i < n; ++i) scales[i] = scale_of(samples.wavelengths.each[begin + i]);
    }
    camera_loops().of<T>().weigh(bounds_of<T>(film), static_cast<T>(pupils.space().depth()), n, samples.film_x + begin,
                                 samples.film_y + begin, lines.from(begin), areas + begin, scales.data(), fates + begin,
                                 rays.from(begin));
  }
}

#define PETZVAL_SAMPLES(T)                                                                                           \
  template PETZVAL_API void keep_on_film(std::size_t, const Film&, const T*, const T*, T*, T*) noexcept;             \
  template PETZVAL_API void weigh(std::size_t, const Film&, const FilmPupilTable&, const CameraSamples<T>&,          \
                                  const TwoPlaneRays<const T>&, const T*, const double*, RayFate*,                   \
                                  const CameraRays<T>&) noexcept;                                                    \
  template PETZVAL_API void to_keys(std::size_t, const TiltedFilm&, const T*, const T*, T*, T*) noexcept;            \
  template PETZVAL_API void to_upright(std::size_t, const TiltedFilm&, const T*, const T*, const T*, const T*, T*,   \
                                       T*) noexcept;                                                                 \
  template PETZVAL_API void sample_pinhole(std::size_t, const TiltedFilm&, const FilmPupilTable&,                    \
                                           std::span<const double>, const CameraSamples<T>&, const T*, const T*, T*, \
                                           T*, T*, T*, T*) noexcept;                                                 \
  template PETZVAL_API void keep_within(std::size_t, const FilmPupilTable&, const TwoPlaneRays<const T>&,            \
                                        const RayWavelengths&, RayFate*) noexcept;                                   \
  template PETZVAL_API void lean(std::size_t, const TiltedFilm&, const T*, const T*, const T*, const T*, RayFate*,   \
                                 const CameraRays<T>&) noexcept;
PETZVAL_SAMPLES(float)
PETZVAL_SAMPLES(double)
#undef PETZVAL_SAMPLES

}  // namespace petzval::inline v0::camera_detail
