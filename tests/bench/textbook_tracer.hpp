// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "petzval/lens/lens.hpp"

/// The tracer that a textbook leads to, in float, for the library to be measured against: spheres in the frame of their
/// centre, the quadratic solved without cancellation, glm::refract, everything normalised, an early way out. Stops by a
/// radius of zero.
class TextbookTracer {
 public:
  struct Ray {
    glm::vec3 origin, direction;
  };

  /// Spherical surfaces only.
  explicit TextbookTracer(const petzval::Lens& lens);

  /// From the film to the scene; false where the ray is lost.
  bool trace(const Ray& film_ray, Ray& scene_ray) const;

 private:
  struct Element {
    float radius, thickness, index, aperture_radius;  ///< index of the medium behind, thickness to the next surface
  };
  std::vector<Element> elements_;
  float rear_z_;
};
