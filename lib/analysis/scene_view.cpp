// SPDX-License-Identifier: Apache-2.0
#include "scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "core/meet_plane.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::analysis_detail {
namespace {

double angle(const Vec3<double>& a, const Vec3<double>& b) noexcept {
  return 2 * std::asin(std::min(1.0, glm::length(a - b) / 2));
}

/// A unit vector perpendicular to another.
Vec3<double> across(const Vec3<double>& d) noexcept {
  const Vec3<double> least = std::abs(d.x) < std::abs(d.y) ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  return glm::normalize(least - d * glm::dot(least, d));
}

/// A ray and its derivatives as arrays of length 1, for trace_differentials().
struct OneRay {
  std::array<double, 18> v{};

  RayArrays<double> arrays(std::size_t first = 0) noexcept {
    return {&v[first], &v[first + 1], &v[first + 2], &v[first + 3], &v[first + 4], &v[first + 5]};
  }
  RayArrays<const double> const_arrays(std::size_t first = 0) const noexcept {
    return {&v[first], &v[first + 1], &v[first + 2], &v[first + 3], &v[first + 4], &v[first + 5]};
  }
  Ray<double> ray(std::size_t first = 0) const noexcept {
    return {{v[first], v[first + 1], v[first + 2]}, {v[first + 3], v[first + 4], v[first + 5]}};
  }
  void set(std::size_t first, const Vec3<double>& origin, const Vec3<double>& direction) noexcept {
    for (int k = 0; k < 3; ++k) v[first + k] = origin[k], v[first + 3 + k] = direction[k];
  }
};

}  // namespace

SceneView::SceneView(double focal_length, const Vec3<double>& chief)
    : focal_length_(focal_length), normal_(chief), x_axis_(across(chief)), y_axis_(glm::cross(chief, x_axis_)) {}

SceneView::SceneView(double focal_length, double z, const Ray<double>& chief, const Ray<double>& by_film_x,
                     const Ray<double>& by_film_y)
    : SceneView(focal_length, chief.direction) {
  const double edge_on = std::cos(radians(80.0)), depth = chief.origin.z - z;
  const bool turned = -chief.direction.z < edge_on;
  const double length = turned ? depth / edge_on : depth / -chief.direction.z;
  centre_ = chief.origin + chief.direction * length;
  if (!turned) normal_ = {0, 0, -1}, x_axis_ = {1, 0, 0}, y_axis_ = {0, 1, 0};

  // The motion of the hit is the motion of the ray's origin and direction, minus the component out of the plane.
  const auto moves = [&](const Ray<double>& by) {
    const Vec3<double> free = by.origin + by.direction * length;
    const Vec3<double> hit = free - chief.direction * (glm::dot(free, normal_) / glm::dot(chief.direction, normal_));
    return std::array{glm::dot(hit, x_axis_), glm::dot(hit, y_axis_)};
  };
  const auto by_x = moves(by_film_x), by_y = moves(by_film_y);
  const double determinant = by_x[0] * by_y[1] - by_x[1] * by_y[0];
  to_film_ = {by_y[1] / determinant, -by_y[0] / determinant, -by_x[1] / determinant, by_x[0] / determinant};
  plane_ = std::isfinite(to_film_[0] + to_film_[1] + to_film_[2] + to_film_[3]);
}

bool SceneView::meets(const Ray<double>& ray) const noexcept {
  return plane_ && glm::dot(ray.direction, normal_) > 1e-3;
}

Vec2<double> SceneView::hit(const Ray<double>& ray) const noexcept {
  const Vec3<double> position = core_detail::meet_plane(ray, centre_, normal_) - centre_;
  const double x = glm::dot(position, x_axis_), y = glm::dot(position, y_axis_);
  return {to_film_[0] * x + to_film_[1] * y, to_film_[2] * x + to_film_[3] * y};
}

Vec2<double> SceneView::position(const Ray<double>& ray) const noexcept {
  if (meets(ray)) return hit(ray);
  return {focal_length_ * glm::dot(ray.direction, x_axis_), focal_length_ * glm::dot(ray.direction, y_axis_)};
}

double SceneView::distance(const Ray<double>& a, const Ray<double>& b) const noexcept {
  if (!meets(a) || !meets(b)) return focal_length_ * angle(a.direction, b.direction);
  const auto hit_a = hit(a), hit_b = hit(b);
  const double x = hit_a[0] - hit_b[0], y = hit_a[1] - hit_b[1];
  return std::sqrt(x * x + y * y);
}

SceneView ChiefRay::view(double z) const {
  if (!found) return SceneView(focal_length);
  constexpr double infinite_distance_mm = 1e15;  // mm
  if (z < -infinite_distance_mm) return SceneView(focal_length, ray.direction);
  return SceneView(focal_length, z, ray, by_film_x, by_film_y);
}

ChiefRays::ChiefRays(const Lens& lens, const TwoPlanes& space) : lens_(lens), space_(space) {
  const std::size_t wavelength = lens.primary_wavelength();
  const Meridian meridian = main_meridian(lens, wavelength);
  const FirstOrder first = first_order(lens, wavelength, meridian);
  if (first.afocal) throw Error(lens.name() + ": the lens is afocal; must have a focal length to measure errors");
  focal_length_ = std::abs(first.effective_focal_length);
  sense_ = signed_index(lens, lens.surface_count(), wavelength) > 0 ? 1 : -1;
  pivot_ = pupils(lens, wavelength, meridian).exit.z - space.film_z;
  if (pivot_ == 0) pivot_ = space.depth();
}

ChiefRay ChiefRays::through(const FilmPoint& film, const Vec2<double>& pupil, std::size_t wavelength) const {
  // The direction of the line, away from the film. If the film point moves by 1 mm, the slope of the line changes by -1
  // / pivot, and its unit vector by the perpendicular component of this change.
  const Vec3<double> line{(pupil[0] - film.x) / space_.depth(), (pupil[1] - film.y) / space_.depth(), 1};
  const double length = glm::length(line);
  const Vec3<double> unit = line / length;
  OneRay ray;
  ray.set(0, {film.x, film.y, space_.film_z}, unit * -sense_);
  for (const int k : {0, 1}) {
    Vec3<double> point{0, 0, 0}, slope{0, 0, 0};
    point[k] = 1, slope[k] = -1 / (pivot_ * length);
    ray.set(6 + 6 * static_cast<std::size_t>(k), point, (slope - unit * glm::dot(unit, slope)) * -sense_);
  }
  RayFate fate;
  trace_differentials<double>(lens_, 1, ray.const_arrays(), {ray.const_arrays(6), ray.const_arrays(12)}, ray.arrays(),
                              {ray.arrays(6), ray.arrays(12)}, &fate, nullptr,
                              {.travel = Travel::to_scene, .wavelengths = {wavelength}, .apertures = false});

  return {pupil, fate == RayFate::transmitted, focal_length_, ray.ray(), ray.ray(6), ray.ray(12)};
}

}  // namespace petzval::analysis_detail
