// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "petzval/lens/lens.hpp"

/// The baseline of the benchmarks: a textbook tracer in float. Spheres are intersected in the frame of their centre by
/// a quadratic without cancellation, conics and aspheres by Newton iteration on the sag. Uses glm::refract, normalises
/// every direction, and returns at the first failure.
class TextbookTracer {
 public:
  struct Ray {
    glm::vec3 origin, direction;
  };

  /// Rotationally symmetric surfaces without odd terms, no mirrors.
  explicit TextbookTracer(const petzval::Lens& lens);

  /// Traces from the film to the scene; false if the ray is lost.
  bool trace(const Ray& film_ray, Ray& scene_ray) const;

 private:
  struct Element {
    float radius, thickness, index, aperture_radius;  ///< index of the medium behind, thickness to the next surface
    int shape = -1;  ///< index of the shape; -1 for a sphere, or a plane if the radius is 0
  };
  struct Shape {
    float conic;
    std::vector<float> even;  ///< coefficients of r^4, r^6, ...
  };
  struct Hit {
    bool found = false;
    float t = 0;
    glm::vec3 normal{};
  };
  static Hit intersect_sag(float radius, const Shape& shape, float vertex_z, Ray ray);

  std::vector<Element> elements_;
  std::vector<Shape> shapes_;
  float rear_z_;
};
