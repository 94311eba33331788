// SPDX-License-Identifier: Apache-2.0
#include "textbook_tracer.hpp"

#include <algorithm>
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
    if (s.conic == 0 && s.aspheric.empty()) continue;
    elements_.back().shape = static_cast<int>(shapes_.size());
    shapes_.push_back({static_cast<float>(s.conic), {}});
    for (const petzval::AsphereTerm& term : s.aspheric) {
      auto& even = shapes_.back().even;
      const auto place = static_cast<std::size_t>(term.order / 2 - 2);
      even.resize(std::max(even.size(), place + 1));
      even[place] = static_cast<float>(term.coefficient);
    }
  }
  rear_z_ = static_cast<float>(surfaces.back().vertex_z);
}

// Passed by value, because the loop below keeps its ray in registers only if no code takes the address.
TextbookTracer::Hit TextbookTracer::intersect_sag(float radius, const Shape& shape, float vertex_z, Ray ray) {
  const glm::vec3 o = ray.origin - glm::vec3(0, 0, vertex_z);
  const float c = radius == 0 ? 0.f : 1 / radius;
  float t = -o.z / ray.direction.z;
  for (int i = 0; i < 20; ++i) {
    const glm::vec3 p = o + t * ray.direction;
    const float r2 = p.x * p.x + p.y * p.y;
    const float inside = 1 - (1 + shape.conic) * c * c * r2;
    if (inside < 0) break;
    const float root = std::sqrt(inside);
    float polynomial = 0, derivative = 0;  // of r^2; derivative with respect to r^2
    for (std::size_t k = shape.even.size(); k-- > 0;) {
      derivative = derivative * r2 + polynomial;
      polynomial = polynomial * r2 + shape.even[k];
    }
    const float sag = c * r2 / (1 + root) + polynomial * r2 * r2;
    const float slope = c / root + 2 * (2 * polynomial + derivative * r2) * r2;
    const glm::vec3 gradient(-slope * p.x, -slope * p.y, 1);
    const float step = (p.z - sag) / glm::dot(gradient, ray.direction);
    t -= step;
    if (std::abs(step) < 2e-6f * (1 + std::abs(t))) {
      const glm::vec3 normal = glm::normalize(gradient);
      return {t >= 0, t, glm::dot(normal, ray.direction) > 0 ? -normal : normal};
    }
  }
  return {};
}

bool TextbookTracer::trace(const Ray& film_ray, Ray& scene_ray) const {
  float element_z = rear_z_;
  Ray ray = film_ray;
  for (std::size_t i = elements_.size(); i-- > 0;) {
    const Element& element = elements_[i];
    if (i + 1 < elements_.size()) element_z -= element.thickness;
    float t;
    glm::vec3 normal;
    if (element.shape >= 0) {
      const Hit met = intersect_sag(element.radius, shapes_[static_cast<std::size_t>(element.shape)], element_z, ray);
      if (!met.found) return false;
      t = met.t;
      normal = met.normal;
    } else if (element.radius == 0) {
      t = (element_z - ray.origin.z) / ray.direction.z;
      if (t < 0) return false;
      normal = glm::vec3(0, 0, ray.direction.z > 0 ? -1 : 1);
    } else if (!intersect_sphere(element.radius, element_z + element.radius, ray, t, normal)) {
      return false;
    }
    const glm::vec3 hit = ray.origin + t * ray.direction;
    if (hit.x * hit.x + hit.y * hit.y > element.aperture_radius * element.aperture_radius) return false;
    ray.origin = hit;
    const float behind = element.index, before = i > 0 ? elements_[i - 1].index : 1.f;
    if (behind != before) {
      const glm::vec3 refracted = glm::refract(glm::normalize(ray.direction), normal, behind / before);
      if (refracted == glm::vec3(0)) return false;
      ray.direction = refracted;
    }
  }
  scene_ray = ray;
  return true;
}
