// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include "../camera/camera_samples.hpp"
#include "laws.hpp"
#include "petzval/camera/camera.hpp"

/// Laws for all results of a camera.
namespace petzval::fuzz {

inline bool finite(const FilmPoint& point) noexcept { return std::isfinite(point.x) && std::isfinite(point.y); }

inline bool density(double value) noexcept { return value >= 0 && std::isfinite(value); }

inline void check(const CameraRay& ray) {
  require(finite(ray.ray), "a camera ray is finite");
  require(density(ray.weight) && density(ray.pdf_film) && density(ray.pdf_pupil) && density(ray.pdf_direction),
          "weight and densities of a camera ray are finite and not negative");
  if (!ray) return;
  require(ray.fate == RayFate::transmitted, "a ray with a weight passes");
  require(unit(ray.ray.direction, 2e-5), "a camera ray has unit length");
}

/// Checks the results of samples.
template <class T>
void check(const testing::Samples<T>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    check(CameraRay{samples.ray(i), samples.fates[i], samples.weights[i], 0, samples.pdf_pupil[i],
                    samples.pdf_direction[i]});
  }
}

inline void check(const Importance& found) {
  require(density(found.we) && density(found.pdf_film) && density(found.pdf_pupil) && density(found.pdf_position) &&
              density(found.pdf_direction),
          "importance and its densities are finite and not negative");
  if (!found) return;
  require(found.fate == RayFate::transmitted, "a ray with importance passes");
  require(finite(found.film) && finite(found.raster), "a ray with importance meets the film");
}

/// rounding: tolerance of |direction|^2.
inline void check(const ImportanceSample& found, double rounding) {
  check(found.importance);
  require(density(found.pdf), "the density of a connection is finite and not negative");
  if (!found) return;
  require(found.pdf > 0, "the density of a connection is positive");
  require(unit(found.direction, rounding) && finite(found.on_front), "a connection is finite");
  require(found.distance >= 0, "the length of a connection is 0 or more");
}

inline void check(const Projection& seen) {
  if (seen.status == AimStatus::no_ray) return;
  require(finite(seen.film) && finite(seen.raster), "a projection is finite");
}

}  // namespace petzval::fuzz
