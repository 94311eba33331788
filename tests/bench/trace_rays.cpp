// SPDX-License-Identifier: Apache-2.0
#include "trace_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "../trace/extended.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

namespace {

using petzval::Ray;
using petzval::Travel;
using petzval::Vec3;

Ray<double> towards(const Vec3<double>& film, double x, double y, double z) {
  const Vec3<double> d = Vec3<double>(x, y, z) - film;
  return {film, d / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)};
}

Ray<float> rounded(const Ray<double>& ray) { return {Vec3<float>(ray.origin), Vec3<float>(ray.direction)}; }

struct Box {
  double x0, x1, y0, y1;
};

/// Bounding box of the transmitted rays from the film point (radius, 0), on a grid over a region of the plane of the
/// rear vertex, enlarged by a cell; the whole region if no ray passes.
Box passing_box(const petzval::Lens& lens, double inner, double outer, const Box& searched, std::mt19937& random) {
  constexpr int cells = 72;
  const double width = (searched.x1 - searched.x0) / cells, height = (searched.y1 - searched.y0) / cells;
  const double z = lens.surfaces().back().vertex_z;
  std::uniform_real_distribution<double> radius(inner, outer);
  std::vector<Ray<float>> rays;
  std::vector<std::array<double, 2>> places;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const double x = searched.x0 + width * (column + 0.5), y = searched.y0 + height * (row + 0.5);
      places.push_back({x, y});
      rays.push_back(rounded(towards({radius(random), 0, lens.film_z()}, x, y, z)));
    }
  }
  std::vector<petzval::TracedRay<float>> traced(rays.size());
  petzval::trace<float>(lens, rays, traced.data(), {.travel = Travel::to_scene});

  Box box{searched.x1, searched.x0, searched.y1, searched.y0};
  for (std::size_t i = 0; i < traced.size(); ++i) {
    if (!traced[i].transmitted()) continue;
    const auto [x, y] = places[i];
    box = {std::min(box.x0, x - width), std::max(box.x1, x + width), std::min(box.y0, y - height),
           std::max(box.y1, y + height)};
  }
  return box.x0 < box.x1 ? box : searched;
}

/// Searches 1.5 times the rear element, then the box of the first search, because only a narrow cone passes if the rear
/// element is near the film.
Box box_of_ring(const petzval::Lens& lens, double inner, double outer, std::mt19937& random) {
  const double half = 1.5 * lens.surfaces().back().semi_diameter;
  const Box coarse = passing_box(lens, inner, outer, {-half, half, -half, half}, random);
  return passing_box(lens, inner, outer, coarse, random);
}

/// The lens in long double. Curvatures and coefficients are the doubles of the compiled lens, which every code gets;
/// the constants of refraction are recomputed from the indices, because the tested codes round them differently.
testing_lenses::Tables<long double> exact_tables(const petzval::Lens& lens) {
  auto tables = testing_lenses::extended(petzval::kernel::view<double>(lens));
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const long double n0 = lens.index(i, 0), n1 = lens.index(i + 1, 0);
    tables.to_scene[i] = {n1 / n0, (n0 - n1) * (n0 + n1) / (n0 * n0)};
  }
  return tables;
}

/// Uses a ray as a line, independent of the length of its rounded direction.
template <class T>
void add_exact(const petzval::kernel::LensView<long double>& view, RaySet::Of<T>& set) {
  using L = petzval::kernel::Vec<long double>;
  for (const Ray<T>& ray : set.rays) {
    const L o{ray.origin.x, ray.origin.y, ray.origin.z}, d{ray.direction.x, ray.direction.y, ray.direction.z};
    const auto end = trace(view, o, d * (1 / std::sqrt(dot(d, d))), {.travel = Travel::to_scene});
    const bool passed = end.fate == petzval::RayFate::transmitted;
    set.exact.push_back(passed ? std::optional(end.direction) : std::nullopt);
  }
}

}  // namespace

BenchLens::BenchLens(const petzval::Prescription& prescription, double half_diagonal, std::size_t count)
    : id(prescription.id), name(prescription.name), lens(petzval::compile(prescription)) {
  constexpr int rings = 64;
  std::mt19937 random(1);
  std::vector<Box> boxes;
  boxes.reserve(rings);
  for (int i = 0; i < rings; ++i) {
    boxes.push_back(box_of_ring(lens, half_diagonal * i / rings, half_diagonal * (i + 1) / rings, random));
  }

  const double half_width = 3 / std::sqrt(13.) * half_diagonal, half_height = 2 / std::sqrt(13.) * half_diagonal;
  const double rear_z = lens.surfaces().back().vertex_z;
  std::uniform_real_distribution<double> uniform;
  std::size_t tried = 0, passed = 0;
  while (pass.in_double.rays.size() < count) {
    // The film point is exact in float, so that both precisions have the same start.
    const Vec3<double> film(Vec3<float>(
        Vec3<double>(half_width * (2 * uniform(random) - 1), half_height * (2 * uniform(random) - 1), lens.film_z())));
    const double r = std::hypot(film.x, film.y);
    const Box& box = boxes[static_cast<std::size_t>(std::min(rings - 1., r / half_diagonal * rings))];
    const double u = std::lerp(box.x0, box.x1, uniform(random)), v = std::lerp(box.y0, box.y1, uniform(random));
    const double cosine = r > 0 ? film.x / r : 1, sine = r > 0 ? film.y / r : 0;
    const Ray<double> ray = towards(film, u * cosine - v * sine, u * sine + v * cosine, rear_z);
    const auto add = [&](RaySet& set) {
      set.in_double.rays.push_back(ray);
      set.in_float.rays.push_back(rounded(ray));
    };
    const bool out = petzval::trace(lens, ray, {.travel = Travel::to_scene}).transmitted();
    if (mix.in_double.rays.size() < count) add(mix);
    if (out) add(pass);
    ++tried;
    passed += out;
  }
  mix.passing = static_cast<double>(passed) / static_cast<double>(tried);
  pass.passing = 1;

  const auto exact = exact_tables(lens);
  for (RaySet* set : {&pass, &mix}) {
    add_exact(exact.view(), set->in_float);
    add_exact(exact.view(), set->in_double);
  }
}
