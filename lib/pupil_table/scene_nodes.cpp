// SPDX-License-Identifier: Apache-2.0
#include "scene_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "pupil/boundary_search.hpp"

namespace petzval::pupil_table_detail {

void RayClearances::test(std::size_t count, double* clearances) {
  through_.resize(count);
  const auto at = [this](std::size_t k) { return components_[k].data(); };
  passing_(count, {at(0), at(1), at(2), at(3), at(4), at(5)}, wavelength_, through_.data());
  std::transform(through_.begin(), through_.end(), clearances, pupil_detail::clearance_of);
}

Bearing bearing_on_sphere(const Vec3<double>& centre, const Ray<double>& ray, double reciprocal_radius) noexcept {
  const Vec3<double> from = ray.origin - centre;
  const double b = glm::dot(from, ray.direction), beside2 = glm::dot(from, from) - b * b;
  const double along =
      std::sqrt(std::max(1 - beside2 * (reciprocal_radius * reciprocal_radius), 0.0)) - b * reciprocal_radius;
  const Vec3<double> unit = from * reciprocal_radius + ray.direction * along;
  return bearing_of(unit.x, unit.y, unit.z);
}

PupilPlane plane_facing(const Vec3<double>& centre, const Bearing& bearing, double reciprocal_distance) noexcept {
  return PupilPlane::facing(centre, bearing.field, {bearing.azimuth_x, bearing.azimuth_y}, reciprocal_distance);
}

double widest_field(const Vec3<double>& centre, const std::vector<Ray<double>>& rays,
                    double reciprocal_radius) noexcept {
  double widest = 0;
  for (const Ray<double>& ray : rays) {
    widest = std::max(widest, bearing_on_sphere(centre, ray, reciprocal_radius).field);
  }
  return widest;
}

}  // namespace petzval::pupil_table_detail
