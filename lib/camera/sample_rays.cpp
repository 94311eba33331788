// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/sample_rays.hpp"

#include <array>

#include "camera_loops.hpp"

namespace petzval::detail {
namespace {

template <class T>
FilmBounds<T> bounds_of(const Film& film) noexcept {
  return {static_cast<T>(film.centre_x_mm), static_cast<T>(film.centre_y_mm), static_cast<T>(film.half_width<T>()),
          static_cast<T>(film.half_height<T>())};
}

}  // namespace

template <class T>
void keep_on_film(std::size_t count, const Film& film, const T* film_x, const T* film_y, T* kept_x,
                  T* kept_y) noexcept {
  camera_loops().of<T>().keep_on_film(bounds_of<T>(film), count, film_x, film_y, kept_x, kept_y);
}

template <class T>
void weigh(std::size_t count, const Film& film, const FilmSpace& space, const CameraSamples<T>& samples,
           const FilmLines<const T>& lines, const T* areas, const double* scale, std::size_t known_wavelengths,
           RayFate* fates, const CameraRays<T>& rays) noexcept {
  constexpr std::size_t block = 64;
  std::array<T, block> scales;
  const auto scale_of = [&](std::size_t w) { return w < known_wavelengths ? static_cast<T>(scale[w]) : T(0); };
  if (!samples.wavelengths.each) scales.fill(scale_of(samples.wavelengths.all));
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    if (samples.wavelengths.each) {
      for (std::size_t i = 0; i < n; ++i) scales[i] = scale_of(samples.wavelengths.each[begin + i]);
    }
    camera_loops().of<T>().weigh(bounds_of<T>(film), static_cast<T>(space.depth()), n, samples.film_x + begin,
                                 samples.film_y + begin, lines.from(begin), areas + begin, scales.data(), fates + begin,
                                 rays.from(begin));
  }
}

#define PETZVAL_SAMPLES(T)                                                                                   \
  template PETZVAL_API void keep_on_film(std::size_t, const Film&, const T*, const T*, T*, T*) noexcept;     \
  template PETZVAL_API void weigh(std::size_t, const Film&, const FilmSpace&, const CameraSamples<T>&,       \
                                  const FilmLines<const T>&, const T*, const double*, std::size_t, RayFate*, \
                                  const CameraRays<T>&) noexcept;
PETZVAL_SAMPLES(float)
PETZVAL_SAMPLES(double)
#undef PETZVAL_SAMPLES

}  // namespace petzval::detail
