// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "batches.hpp"
#include "petzval/trace/trace.hpp"

/// Batches of rays with derivatives. A tangent is stored like a ray: the changes of origin and direction.
namespace testing_differentials {

using namespace testing_batches;
using petzval::RayTangents;
using petzval::Vec3;
using testing_batches::same_bits;

template <class T>
class DifferentialsOf : public testing::Test {};

template <class T>
using Tangents = std::vector<Ray<T>>;

/// Random tangents of rays: positions change by up to the size of the lens, directions by up to 1, perpendicularly.
template <class T>
Tangents<T> tangents_for(const std::vector<Ray<T>>& rays, double size, std::uint64_t seed) {
  Numbers random(seed);
  const auto one = [&](double scale) {
    return Vec3<double>{scale * random(-1, 1), scale * random(-1, 1), scale * random(-1, 1)};
  };
  Tangents<T> tangents;
  for (const Ray<T>& ray : rays) {
    const Vec3<double> d(ray.direction), place = one(size), turn = one(1);
    tangents.push_back({Vec3<T>(place), Vec3<T>(turn - d * (glm::dot(turn, d) / glm::dot(d, d)))});
  }
  return tangents;
}

/// Rays and their tangents for two parameters.
template <class T>
struct Beam {
  std::vector<Ray<T>> rays;
  Tangents<T> u, v;

  Beam(std::vector<Ray<T>> with, double size, std::uint64_t seed = 11)
      : rays(std::move(with)), u(tangents_for(rays, size, seed)), v(tangents_for(rays, size, seed + 1)) {}
};

/// The result of a batch with derivatives.
template <class T>
struct Followed {
  Answer<T> end;
  Arrays<T> u, v;

  bool guards_hold() const { return end.rays.guards_hold() && u.guards_hold() && v.guards_hold(); }
};

template <class T>
Followed<T> followed(const Lens& lens, const Beam<T>& beam, const BatchOptions& options) {
  const std::size_t count = beam.rays.size();
  const Arrays<T> in(beam.rays), u(beam.u), v(beam.v);
  Followed<T> answer{{Arrays<T>(count), std::vector<RayFate>(count), std::vector<int>(count, -7)},
                     Arrays<T>(count, 1),
                     Arrays<T>(count, 2)};
  petzval::trace_differentials<T>(lens, count, in.in(), {u.in(), v.in()}, answer.end.rays.out(),
                                  {answer.u.out(), answer.v.out()}, answer.end.fates.data(), answer.end.surfaces.data(),
                                  options);
  return answer;
}

template <class T>
bool same_bits(const Followed<T>& a, std::size_t i, const Followed<T>& b, std::size_t j) {
  return same_bits(a.end, i, b.end, j) && same_bits(a.u[i], b.u[j]) && same_bits(a.v[i], b.v[j]);
}

template <class T>
bool is_zero(const Ray<T>& tangent) {
  const Vec3<T> none{0, 0, 0};
  return tangent.origin == none && tangent.direction == none;
}

/// A lens with one surface of a kind that is missing in data/.
inline testing_lenses::Sample one_surface(const std::string& id, petzval::SurfaceRow row, double rim) {
  row.semi_diameter = rim;
  row.thickness = row.mirror ? -3 * rim : 3 * rim;
  if (!row.mirror) row.medium.nd = 1.6;
  petzval::Prescription p;
  p.id = p.name = id;
  p.surfaces = {row};
  return {id, p, petzval::compile(p), rim};
}

/// Kinds of surfaces that are missing in data/.
inline const std::vector<testing_lenses::Sample>& made() {
  using petzval::Section;
  static const std::vector<testing_lenses::Sample> samples{
      one_surface("mirror, prolate", {.radius = -60, .conic = -0.6, .mirror = true}, 25),
      one_surface("mirror, aspheric", {.radius = -80, .conic = 1, .aspheric = {{4, 1e-6}, {6, 2e-9}}, .mirror = true},
                  20),
      one_surface("mirror, cylindrical", {.radius = 50, .mirror = true, .curved_in = Section::y}, 20),
      one_surface("mirror, plane", {.mirror = true}, 20),
      one_surface("annular hyperboloid", {.radius = 30, .obscuration_semi_diameter = 5, .conic = -3}, 20),
      one_surface("conic cylinder", {.radius = 30, .conic = -2, .curved_in = Section::x}, 15),
      one_surface("aspheric cylinder",
                  {.radius = 40, .conic = 0.5, .aspheric = {{4, -4e-6}, {6, 1e-9}}, .curved_in = Section::y}, 15),
      one_surface("odd asphere", {.radius = 40, .aspheric = {{3, 1e-4}, {5, -1e-7}}}, 15),
      one_surface("gull wing", {.aspheric = {{2, 0.05}, {4, -0.00015}}}, 15),
  };
  return samples;
}

}  // namespace testing_differentials
