// SPDX-License-Identifier: Apache-2.0
#include "iris_images.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace petzval::pupil_table_detail {
namespace {

constexpr double rounded_up = 1 + 1e-6;  // includes corner points of the film after rounding

}  // namespace

IrisImages::IrisImages(const Iris& iris, std::span<const PupilImage> images, double film_radius, std::size_t primary,
                       const lens_detail::CompiledWavelengths& wavelengths)
    : shape_(iris), film_radius_(film_radius), primary_(primary) {
  std::vector<std::array<double, 4>> values;
  for (const auto& [shift, radius] : images) {
    equal_sections_ &= shift.x == shift.y && radius.x == radius.y;
    values.push_back({shift.x, radius.x, shift.y, radius.y});
    images_.push_back({shift.x, shift.y, radius.x, radius.y, shape_.area() * radius.x * radius.y});
  }
  const bool known = wavelengths.count() == images.size();
  between_ = {known ? wavelengths : lens_detail::CompiledWavelengths(), values};
}

IrisImages IrisImages::tilted(const FilmTilt& tilt) const {
  IrisImages result = *this;
  result.film_radius_ = tilt.radius;
  result.slope_x_ = tilt.slope_x;
  result.slope_y_ = tilt.slope_y;
  return result;
}

IrisImages IrisImages::with_round_stop() const {
  IrisImages result = *this;
  result.shape_ = {};
  for (Image& image : result.images_) image.area = result.shape_.area() * image.radius_x * image.radius_y;
  return result;
}

template <class R>
SeenIris<R> IrisImages::seen() const noexcept {
  return {shape_.sectors<R>(), static_cast<R>(film_radius_ * rounded_up), static_cast<R>(slope_x_),
          static_cast<R>(slope_y_)};
}

template <class R>
IrisImageTable<R> IrisImages::table(Wavelength all) const noexcept {
  const auto number = [](double x) { return static_cast<R>(x); };
  const Image shared = image(all);
  return {seen<R>(),
          between_.rows<R>(),
          equal_sections_,
          {number(shared.shift_x), number(shared.shift_y), number(shared.radius_x), number(shared.radius_y),
           number(shared.area)},
          number(shape_.area())};
}

IrisImages::Image IrisImages::image(Wavelength at) const noexcept {
  if (const auto nm = at.in_nm()) {
    if (!between_.covers(*nm)) return {};
    const auto [shift_x, radius_x, shift_y, radius_y] = between_(*nm);
    return {shift_x, shift_y, radius_x, radius_y, shape_.area() * radius_x * radius_y};
  }
  const std::size_t w = at.position(primary_);
  return w < images_.size() ? images_[w] : Image{};
}

IrisImages::Image IrisImages::image(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const double reach = film_radius_ * rounded_up, square = film.x * film.x + film.y * film.y;
  if (!(square <= reach * reach)) return {};
  return on_tilted(image(wavelength), slope_x_ * film.x + slope_y_ * film.y);
}

PupilSample IrisImages::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  return iris_images().one(seen<double>(), image(wavelength), film.x, film.y, u, v);
}

double IrisImages::area(const FilmPoint& film, Wavelength wavelength) const noexcept {
  return image(film, wavelength).area;
}

double IrisImages::area_of_stop(const FilmPoint& film, Wavelength wavelength) const noexcept {
  return area(film, wavelength) * (std::numbers::pi / shape_.area());
}

Vec2<double> IrisImages::middle(const FilmPoint& film, Wavelength wavelength) const noexcept {
  const Image seen = image(film, wavelength);
  if (!(seen.area > 0)) return {0, 0};
  return {seen.shift_x * film.x, seen.shift_y * film.y};
}

bool IrisImages::contains(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  const Image seen = image(film, wavelength);
  return seen.area > 0 &&
         shape_.contains((x - seen.shift_x * film.x) / seen.radius_x, (y - seen.shift_y * film.y) / seen.radius_y);
}

Vec2<double> IrisImages::position(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  const Image seen = image(film, wavelength);
  if (!(seen.area > 0)) return {0, 2};
  return shape_.position((x - seen.shift_x * film.x) / seen.radius_x, (y - seen.shift_y * film.y) / seen.radius_y);
}

FilmPupilTable::Derivatives IrisImages::derivatives(const FilmPoint& film, const PupilSample& sample,
                                                    Wavelength wavelength) const noexcept {
  // Derivatives of part (shift film + radius place), where part changes by -part^2 shift slope.
  const auto [x, y, area] = sample;
  if (!(area > 0)) return {};
  const Image seen = image(film, wavelength);
  return {{seen.shift_x - seen.shift_x * slope_x_ * x, -seen.shift_y * slope_x_ * y},
          {-seen.shift_x * slope_y_ * x, seen.shift_y - seen.shift_y * slope_y_ * y}};
}

template <class T>
void IrisImages::sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
                        const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept {
  iris_images().of<T>().sample(table<T>(wavelengths.all), count, film_x, film_y, u, v, wavelengths, x, y, areas);
}

template <class T>
void IrisImages::sample_areas(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                              T* areas) const noexcept {
  iris_images().of<T>().sample_areas(table<T>(wavelengths.all), count, lines, wavelengths, areas);
}

#define PETZVAL_IRIS_IMAGES(T)                                                                                         \
  template void IrisImages::sample(std::size_t, const T*, const T*, const T*, const T*, const RayWavelengths&, T*, T*, \
                                   T*) const noexcept;                                                                 \
  template void IrisImages::sample_areas(std::size_t, const TwoPlaneRays<const T>&, const RayWavelengths&, T*)         \
      const noexcept;
PETZVAL_IRIS_IMAGES(float)
PETZVAL_IRIS_IMAGES(double)
#undef PETZVAL_IRIS_IMAGES

}  // namespace petzval::pupil_table_detail
