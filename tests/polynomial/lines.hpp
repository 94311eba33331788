// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "polynomial/ray_polynomial.hpp"

namespace petzval::testing {

/// Lines and their rays, as arrays.
template <class T>
struct Lines {
  std::vector<T> film_x, film_y, pupil_x, pupil_y;
  std::array<std::vector<T>, 6> ray;
  std::vector<RayFate> fates;

  std::size_t size() const { return film_x.size(); }
  void add(double fx, double fy, double px, double py) {
    film_x.push_back(static_cast<T>(fx)), film_y.push_back(static_cast<T>(fy));
    pupil_x.push_back(static_cast<T>(px)), pupil_y.push_back(static_cast<T>(py));
  }
  TwoPlaneRays<const T> lines() const { return {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()}; }
  template <class U = T>
  RayArrays<U> rays() {
    return {ray[0].data(), ray[1].data(), ray[2].data(), ray[3].data(), ray[4].data(), ray[5].data()};
  }
  void allocate() {
    for (auto& a : ray) a.assign(size(), T(0));
    fates.assign(size(), RayFate::missed_surface);
  }
  Lines& through(const RayPolynomial& polynomial, const RayWavelengths& wavelengths = {}) {
    allocate();
    polynomial.to_scene<T>(size(), lines(), wavelengths, rays(), fates.data());
    return *this;
  }
  Vec3<double> origin(std::size_t i) const { return {ray[0][i], ray[1][i], ray[2][i]}; }
  Vec3<double> direction(std::size_t i) const { return {ray[3][i], ray[4][i], ray[5][i]}; }
};

/// `count` lines, uniform on the film and in its pupils.
template <class T>
Lines<T> lines_through(const FilmPupilTable& pupils, std::size_t count, std::uint32_t seed,
                       std::size_t wavelength = 0) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Lines<T> result;
  while (result.size() < count) {
    const double r = pupils.film_radius() * std::sqrt(uniform(generator));
    const double turn = 2 * std::numbers::pi * uniform(generator);
    const double x = r * std::sin(turn), y = r * std::cos(turn), u = uniform(generator), v = uniform(generator);
    const PupilSample sample = pupils.sample({x, y}, u, v, wavelength);
    if (sample.area > 0) result.add(x, y, sample.x, sample.y);
  }
  return result;
}

}  // namespace petzval::testing
