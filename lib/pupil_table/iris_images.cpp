// SPDX-License-Identifier: Apache-2.0
#include "iris_images.hpp"

#include <algorithm>
#include <cmath>

namespace petzval::inline v0::pupil_table_detail {
namespace {

constexpr double rounded_up = 1 + 1e-6;  // the corner itself, rounded, still belongs to the film

}  // namespace

IrisImages::IrisImages(const Iris& iris, std::span<const PupilDisc> images, double film_radius, std::size_t primary)
    : shape_(iris), film_radius_(film_radius), primary_(primary) {
  for (const PupilDisc& image : images) {
    const double area = shape_.area() * image.radius * image.radius;
    put(single_, image, area);
    put(twice_, image, area);
  }
}

IrisImages IrisImages::tilted(const FilmTilt& tilt) const {
  IrisImages result = *this;
  result.film_radius_ = tilt.radius;
  result.slope_x_ = tilt.slope_x;
  result.slope_y_ = tilt.slope_y;
  return result;
}

template <class R>
IrisImageTable<R> IrisImages::table() const noexcept {
  const auto number = [](double x) { return static_cast<R>(x); };
  const auto of = [&](const auto& columns) -> IrisImageTable<R> {
    return {shape_.triangles<R>(),
            columns.shift.data(),
            columns.radius.data(),
            columns.area.data(),
            columns.shift.size(),
            primary_,
            number(film_radius_ * rounded_up),
            number(slope_x_),
            number(slope_y_)};
  };
  if constexpr (sizeof(R) == sizeof(float)) {
    return of(single_);
  } else {
    return of(twice_);
  }
}

IrisImages::Image IrisImages::image(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const double reach = film_radius_ * rounded_up, square = film.x * film.x + film.y * film.y;
  if (!(square <= reach * reach) || wavelength >= twice_.shift.size()) return {};
  const double shift = twice_.shift[wavelength], part = 1 / (1 + shift * (slope_x_ * film.x + slope_y_ * film.y));
  return {part * shift, part * twice_.radius[wavelength], part * part * twice_.area[wavelength]};
}

PupilSample IrisImages::sample(const FilmPoint& film, double u, double v, std::size_t wavelength) const noexcept {
  const auto [shift, radius, area] = image(film, wavelength);
  if (!(area > 0 && u - u == 0 && v - v == 0)) return {};
  const Vec2<double> place = shape_.sample(std::clamp(u, 0.0, 1.0), std::clamp(v, 0.0, 1.0));
  return {shift * film.x + radius * place.x, shift * film.y + radius * place.y, area};
}

double IrisImages::area(const FilmPoint& film, std::size_t wavelength) const noexcept {
  return image(film, wavelength).area;
}

Vec2<double> IrisImages::middle(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const double shift = image(film, wavelength).shift;
  return {shift * film.x, shift * film.y};
}

bool IrisImages::contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept {
  const auto [shift, radius, area] = image(film, wavelength);
  return area > 0 && shape_.contains((x - shift * film.x) / radius, (y - shift * film.y) / radius);
}

FilmPupilTable::Derivatives IrisImages::derivatives(const FilmPoint& film, double u, double v,
                                                    std::size_t wavelength) const noexcept {
  // Of part (shift film + radius place), by way of part's own: - part^2 shift slope.
  const auto [x, y, area] = sample(film, u, v, wavelength);
  if (!(area > 0)) return {};
  const double shift = image(film, wavelength).shift, by_x = shift * slope_x_, by_y = shift * slope_y_;
  return {{shift - by_x * x, -by_x * y}, {-by_y * x, shift - by_y * y}};
}

template <class T>
void IrisImages::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                        const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  iris_images().of<T>().sample(table<T>(), count, film_x, film_y, u, v, wavelengths, x, y, areas);
}

template <class T>
void IrisImages::contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                          std::uint8_t* within) const noexcept {
  iris_images().of<T>().contains(table<T>(), count, lines, wavelengths, within);
}

#define PETZVAL_IRIS_IMAGES(T)                                                                                         \
  template void IrisImages::sample(std::size_t, const T*, const T*, const T*, const T*, const RayWavelengths&, T*, T*, \
                                   T*) const noexcept;                                                                 \
  template void IrisImages::contains(std::size_t, const TwoPlaneRays<const T>&, const RayWavelengths&, std::uint8_t*)  \
      const noexcept;
PETZVAL_IRIS_IMAGES(float)
PETZVAL_IRIS_IMAGES(double)
#undef PETZVAL_IRIS_IMAGES

}  // namespace petzval::inline v0::pupil_table_detail
