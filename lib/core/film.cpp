// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/film.hpp"

#include <cmath>
#include <glm/geometric.hpp>

#include "core/text.hpp"
#include "film_bounds.hpp"
#include "petzval/core/error.hpp"

namespace petzval {

Film Film::at(double time) const {
  Film result = *this;
  result.z_mm = z() + (time > 0 ? std::min(time, 1.0) : 0.0) * travel_mm;
  result.travel_mm = 0;
  return result;
}

double Film::pixel_mm() const noexcept { return std::sqrt(area_mm2() / (static_cast<double>(columns) * rows)); }

double Film::radius_mm() const noexcept {
  return std::hypot(std::abs(shift_x_mm) + width_mm / 2 + margin_mm, std::abs(shift_y_mm) + height_mm / 2 + margin_mm);
}

std::array<FilmPoint, 4> Film::corners() const noexcept {
  const double across = width_mm / 2 + margin_mm, along = height_mm / 2 + margin_mm;
  const double left = shift_x_mm - across, right = shift_x_mm + across;
  const double low = shift_y_mm - along, high = shift_y_mm + along;
  return {FilmPoint{left, low}, FilmPoint{right, low}, FilmPoint{left, high}, FilmPoint{right, high}};
}

bool Film::contains(const FilmPoint& point) const noexcept {
  const auto bounds = core_detail::bounds_of<double>(*this);
  return std::abs(point.x - shift_x_mm) <= bounds.half_width && std::abs(point.y - shift_y_mm) <= bounds.half_height;
}

FilmPoint Film::point(double column, double row) const noexcept {
  return {shift_x_mm + (0.5 - column / columns) * width_mm, shift_y_mm + (row / rows - 0.5) * height_mm};
}

Vec2<double> Film::raster(const FilmPoint& point) const noexcept {
  return {(0.5 - (point.x - shift_x_mm) / width_mm) * columns, (0.5 + (point.y - shift_y_mm) / height_mm) * rows};
}

template <class T>
void Film::points(std::size_t count, const T* raster_x, const T* raster_y, T* film_x, T* film_y) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint p = point(raster_x[i], raster_y[i]);
    film_x[i] = static_cast<T>(p.x), film_y[i] = static_cast<T>(p.y);
  }
}
template PETZVAL_API void Film::points(std::size_t, const float*, const float*, float*, float*) const noexcept;
template PETZVAL_API void Film::points(std::size_t, const double*, const double*, double*, double*) const noexcept;

Vec3<double> Film::right() const noexcept { return {std::cos(swing_rad), 0, -std::sin(swing_rad)}; }

Vec3<double> Film::up() const noexcept {
  const double along = std::sin(tilt_rad);
  return {std::sin(swing_rad) * along, std::cos(tilt_rad), std::cos(swing_rad) * along};
}

Vec3<double> Film::normal() const noexcept {
  const double level = std::cos(tilt_rad);
  return {std::sin(swing_rad) * level, -std::sin(tilt_rad), std::cos(swing_rad) * level};
}

double Film::angle() const noexcept {
  const Vec3<double> n = normal();
  return std::atan2(std::hypot(n.x, n.y), n.z);
}

double Film::z() const {
  if (!z_mm) throw Error("film: z_mm is not set; must be the film position on the axis");
  return *z_mm;
}

Plane Film::plane() const {
  const Vec3<double> n = normal();
  return {n, n.z * z()};
}

Vec3<double> Film::position(const FilmPoint& point) const {
  return Vec3<double>(0, 0, z()) + point.x * right() + point.y * up();
}

FilmPoint Film::point(const Vec3<double>& position) const {
  const Vec3<double> from_axis = position - Vec3<double>(0, 0, z());
  return {glm::dot(from_axis, right()), glm::dot(from_axis, up())};
}

Film film_in(const Plane& plane, const Film& film) {
  const double z = plane.offset / plane.normal.z;
  const Vec3<double> n = plane.normal.z < 0 ? -plane.normal : plane.normal;
  if (!std::isfinite(z) || !std::isfinite(n.x) || !std::isfinite(n.y)) {
    throw Error("film_in: plane: normal = (" + to_text(plane.normal.x) + ", " + to_text(plane.normal.y) + ", " +
                to_text(plane.normal.z) + "), offset = " + to_text(plane.offset) +
                " mm; must be finite, and the plane must cross the axis");
  }
  Film laid = film;
  laid.z_mm = z;
  laid.tilt_rad = std::atan2(0 - n.y, std::hypot(n.x, n.z));
  laid.swing_rad = std::atan2(n.x + 0, n.z);  // no -0
  return laid;
}

}  // namespace petzval
