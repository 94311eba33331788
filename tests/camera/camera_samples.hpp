// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "petzval/camera/camera.hpp"

namespace petzval::testing {

/// Camera samples in arrays and their results.
template <class T>
struct Samples {
  std::vector<T> film_x, film_y, pupil_u, pupil_v;
  Wavelength wavelength{};                 ///< used if both lists are empty
  std::vector<std::uint16_t> wavelengths;  ///< indices
  std::vector<float> nm;                   ///< replaces both
  std::vector<T> times;                    ///< 0 if empty
  std::vector<T> x, y, z, dx, dy, dz, weights, pdf_pupil, pdf_direction;
  std::vector<RayFate> fates;

  std::size_t size() const { return film_x.size(); }

  void add(double fx, double fy, double u, double v) {
    film_x.push_back(static_cast<T>(fx));
    film_y.push_back(static_cast<T>(fy));
    pupil_u.push_back(static_cast<T>(u));
    pupil_v.push_back(static_cast<T>(v));
  }

  RayWavelengths ray_wavelengths() const {
    return {wavelength, wavelengths.empty() ? nullptr : wavelengths.data(), nm.empty() ? nullptr : nm.data()};
  }

  CameraSample one(std::size_t i) const {
    return {{film_x[i], film_y[i]}, pupil_u[i], pupil_v[i], ray_wavelengths().at(i), times.empty() ? 0 : times[i]};
  }

  /// Computes `count` samples from `first` on.
  void run(const Camera& camera, std::size_t first, std::size_t count) {
    for (auto* column : {&x, &y, &z, &dx, &dy, &dz, &weights, &pdf_pupil, &pdf_direction}) column->resize(size());
    fates.resize(size());
    const CameraSamples<T> samples{film_x.data() + first,         film_y.data() + first,
                                   pupil_u.data() + first,        pupil_v.data() + first,
                                   ray_wavelengths().from(first), times.empty() ? nullptr : times.data() + first};
    const CameraRays<T> rays{{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()},
                             weights.data(),
                             fates.data(),
                             pdf_pupil.data(),
                             pdf_direction.data()};
    camera.sample<T>(count, samples, rays.from(first));
  }
  void run(const Camera& camera) { run(camera, 0, size()); }

  Ray<double> ray(std::size_t i) const { return {{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}}; }
};

/// Uniform samples on film and pupils.
template <class T = double>
Samples<T> random_samples(const Film& film, std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one;
  Samples<T> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = film.width_mm * (one(random) - 0.5), y = film.height_mm * (one(random) - 0.5), u = one(random);
    samples.add(film.shift_x_mm + x, film.shift_y_mm + y, u, one(random));
  }
  return samples;
}

}  // namespace petzval::testing
