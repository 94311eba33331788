// SPDX-License-Identifier: Apache-2.0
#include "iris_images.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "film_loops.hpp"

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
IrisImageTable<R> IrisImages::seen() const noexcept {
  return {shape_.sectors<R>(), static_cast<R>(film_radius_ * rounded_up), static_cast<R>(slope_x_),
          static_cast<R>(slope_y_)};
}

template <class R>
IrisImageTable<R> IrisImages::table(Wavelength all) const noexcept {
  const auto number = [](double x) { return static_cast<R>(x); };
  const auto [shift_x, shift_y, radius_x, radius_y, area] = image(all);
  IrisImageTable<R> result = seen<R>();
  result.images = between_.rows<R>(), result.equal_sections = equal_sections_;
  result.image = {number(shift_x), number(shift_y), number(radius_x), number(radius_y), number(area)};
  result.area = number(shape_.area());
  return result;
}

IrisImages::Image IrisImages::image(Wavelength at) const noexcept {
  if (const auto nm = at.in_nm()) {
    if (!between_.covers(*nm)) return {};
    const auto [shift_x, radius_x, shift_y, radius_y] = between_(*nm);
    return {shift_x, shift_y, radius_x, radius_y, shape_.area() * radius_x * radius_y};
  }
  const std::size_t w = at.index(primary_);
  return w < images_.size() ? images_[w] : Image{};
}

IrisImages::Image IrisImages::image(const FilmPoint& film, Wavelength wavelength) const noexcept {
  return image_at(seen<double>(), image(wavelength), film.x, film.y, true);
}

PupilSample IrisImages::sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept {
  return film_loops().image_sample(seen<double>(), image(wavelength), film.x, film.y, u, v);
}

double IrisImages::sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept {
  return area_in_image(seen<double>(), image(wavelength), film.x, film.y, x, y);
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

template IrisImageTable<float> IrisImages::table(Wavelength) const noexcept;
template IrisImageTable<double> IrisImages::table(Wavelength) const noexcept;

}  // namespace petzval::pupil_table_detail
