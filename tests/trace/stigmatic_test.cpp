// SPDX-License-Identifier: Apache-2.0
// Single surfaces that image one point sharply at any aperture: every ray passes through the image.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "petzval/pupil/apertures.hpp"
#include "trace/sequential.hpp"

namespace stigmatic_test {

using petzval::kernel::Vec;

petzval::Lens surface(double radius, double n_in, double n_out, double conic = 0) {
  petzval::Prescription p;
  p.name = "surface";
  p.object_space = {.nd = n_in};
  p.surfaces = {{.radius = radius, .thickness = 1, .medium = {.nd = n_out}, .conic = conic}};
  return petzval::compile(p);
}

Vec<double> cross(const Vec<double>& a, const Vec<double>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Distance of a point on the axis from the line of a ray.
double miss(const petzval::kernel::TraceState<double>& ray, double z) {
  const auto c = cross(Vec<double>{-ray.origin.x, -ray.origin.y, z - ray.origin.z}, ray.direction);
  return std::sqrt(dot(c, c));
}

// Rays aimed at the point R (1 + n'/n) behind the vertex meet at R (1 + n/n') and obey the sine condition,
// n' sin u = n sin u', from the axis to the equator of the sphere.
TEST(Stigmatic, AplanaticSphereIsSharp) {
  double worst = 0, worst_sine = 0;
  for (const double n_in : {1.0, 1.33, 1.5}) {
    for (const double n_out : {1.0, 1.5, 1.9}) {
      if (n_in == n_out) continue;
      for (const double r : {-40.0, 5.0, 1e4}) {
        const auto lens = surface(r, n_in, n_out);
        const double object = r * (1 + n_out / n_in), image = r * (1 + n_in / n_out);
        for (int k = 1; k <= 89; ++k) {
          const double polar = k * std::numbers::pi / 180, turn = 0.7 * k;
          const double height = r * std::sin(polar), half = std::sin(polar / 2), z = 2 * r * half * half;
          const Vec<double> place{height * std::sin(turn), height * std::cos(turn), z};
          const Vec<double> to = Vec<double>{0, 0, object} - place;
          const Vec<double> d = to * (std::copysign(1, to.z) / std::sqrt(dot(to, to)));
          const auto end = trace(petzval::kernel::view<double>(lens), place - d * std::abs(r), d, {});
          ASSERT_EQ(end.fate, petzval::RayFate::transmitted) << r << " " << n_in << " " << n_out << " " << k;
          worst = std::max(worst, miss(end, image) / std::abs(r));
          const double sine = std::hypot(d.x, d.y), sine_out = std::hypot(end.direction.x, end.direction.y);
          worst_sine = std::max(worst_sine, std::abs(n_out * sine / (n_in * sine_out) - 1));
        }
      }
    }
  }
  EXPECT_LE(worst, 1e-14);
  EXPECT_LE(worst_sine, 1e-14);
  RecordProperty("worst", std::to_string(worst * 1e15) + "e-15");
}

// Parallel light into the denser medium through the ellipsoid k = -1/n^2, out of it through the hyperboloid k = -n^2.
TEST(Stigmatic, DescartesConicsFocusParallelLight) {
  double worst = 0;
  for (const double n : {1.2, 1.5168, 2.0}) {
    const auto into = surface(30, 1, n, -1 / (n * n)), out_of = surface(-30, n, 1, -n * n);
    for (int k = 1; k <= 29; ++k) {
      const Vec<double> start{k * std::sin(0.7 * k), k * std::cos(0.7 * k), -50}, d{0, 0, 1};
      for (const auto& [lens, focus] : {std::pair{&into, 30 * n / (n - 1)}, {&out_of, 30 / (n - 1)}}) {
        const auto end = trace(petzval::kernel::view<double>(*lens), start, d, {});
        ASSERT_EQ(end.fate, petzval::RayFate::transmitted) << n << " " << k;
        worst = std::max(worst, miss(end, focus) / focus);
      }
    }
  }
  EXPECT_LE(worst, 1e-14);
  RecordProperty("worst", std::to_string(worst * 1e15) + "e-15");
}

}  // namespace stigmatic_test
