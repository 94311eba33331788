// SPDX-License-Identifier: Apache-2.0
#include "textbook_tracer.hpp"

#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace {

bool solve_quadratic(float a, float b, float c, float& t0, float& t1) {
  const float discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return false;
  const float root = std::sqrt(discriminant);
  const float q = b < 0 ? -0.5f * (b - root) : -0.5f * (b + root);
  t0 = q / a;
  t1 = c / q;
  if (t0 > t1) std::swap(t0, t1);
  return true;
}

bool intersect_sphere(float radius, float centre_z, const TextbookTracer::Ray& ray, float& t, glm::vec3& normal) {
  const glm::vec3 o = ray.origin - glm::vec3(0, 0, centre_z);
  const float a = glm::dot(ray.direction, ray.direction);
  const float b = 2 * glm::dot(ray.direction, o);
  const float c = glm::dot(o, o) - radius * radius;
  float t0, t1;
  if (!solve_quadratic(a, b, c, t0, t1)) return false;
  const bool closer = (ray.direction.z > 0) == (radius > 0);
  t = closer ? t0 : t1;
  if (t < 0) return false;
  normal = glm::normalize(o + t * ray.direction);
  normal = glm::dot(normal, ray.direction) > 0 ? -normal : normal;
  return true;
}

}  // namespace

TextbookTracer::TextbookTracer(const petzval::Lens& lens) {
  const auto surfaces = lens.surfaces();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const auto& s = surfaces[i];
    elements_.push_back({s.curvature == 0 ? 0.f : static_cast<float>(1 / s.curvature), static_cast<float>(s.thickness),
                         static_cast<float>(lens.index(i + 1, 0)), static_cast<float>(s.semi_diameter)});
  }
  rear_z_ = static_cast<float>(surfaces.back().vertex_z);
}

bool TextbookTracer::trace(const Ray& film_ray, Ray& scene_ray) const {
  float element_z = rear_z_;
  Ray ray = film_ray;
  for (std::size_t i = elements_.size(); i-- > 0;) {
    const Element& element = elements_[i];
    if (i + 1 < elements_.size()) element_z -= element.thickness;
    float t;
    glm::vec3 normal;
    const bool is_stop = element.radius == 0;
    if (is_stop) {
      t = (element_z - ray.origin.z) / ray.direction.z;
      if (t < 0) return false;
    } else if (!intersect_sphere(element.radius, element_z + element.radius, ray, t, normal)) {
      return false;
    }
    const glm::vec3 hit = ray.origin + t * ray.direction;
    if (hit.x * hit.x + hit.y * hit.y > element.aperture_radius * element.aperture_radius) return false;
    ray.origin = hit;
    if (!is_stop) {
      const float behind = element.index, before = i > 0 ? elements_[i - 1].index : 1.f;
      const glm::vec3 refracted = glm::refract(glm::normalize(ray.direction), normal, behind / before);
      if (refracted == glm::vec3(0)) return false;
      ray.direction = refracted;
    }
  }
  scene_ray = ray;
  return true;
}
