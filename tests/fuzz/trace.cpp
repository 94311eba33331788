// SPDX-License-Identifier: Apache-2.0
// Any rays through any lens, one at a time and in batches, in float and in double.
#include "petzval/trace/trace.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <type_traits>

#include <glm/geometric.hpp>

#include "laws.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

constexpr std::size_t count = 9;   // more than a register of AVX-512 holds in double
constexpr double farthest = 1e15;  // mm; beyond it rims end all rays unless apertures are ignored

/// Rays from anywhere near the lens, mostly in the direction of travel.
Ray<double> wild_ray(fuzz::Bytes& bytes, const Lens& lens, Travel travel) {
  const double z = travel == Travel::to_film ? 0 : lens.surfaces().back().vertex_z;
  Ray<double> ray{{bytes.number(-10, 10), bytes.number(-10, 10), z + bytes.number(-20, 20)}, {0, 0, 1}};
  if (bytes.byte() < 16) {
    ray.direction = {bytes.wild(), bytes.wild(), bytes.wild()};
    return ray;
  }
  const double x = bytes.between(-0.7, 0.7), y = bytes.between(-0.7, 0.7);
  const double along = travel == Travel::to_film ? 1 : -lens.light_direction(lens.surface_count());
  ray.direction = {x, y, along * std::sqrt(1 - x * x - y * y)};
  return ray;
}

template <class T>
Ray<T> rounded(const Ray<double>& ray) {
  return {Vec3<T>(ray.origin), Vec3<T>(ray.direction)};
}

template <class T>
bool same_bits(const Ray<T>& a, const Ray<T>& b) {
  using Numbers = std::array<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>, 6>;
  return std::bit_cast<Numbers>(a) == std::bit_cast<Numbers>(b);
}

template <class T>
void check(const TracedRay<T>& traced, const Lens& lens) {
  fuzz::require(fuzz::finite(traced.ray), "a traced ray is finite");
  fuzz::require(traced.surface >= 0 && traced.surface < static_cast<int>(lens.surface_count()),
                "a ray ends at a surface");
  if (traced.transmitted()) {
    fuzz::require(fuzz::unit(traced.ray.direction, 1000.0 * std::numeric_limits<T>::epsilon()),
                  "a ray that passes has unit length");
  }
}

template <class T>
void one_against_batches(const Lens& lens, const std::array<Ray<double>, count>& wanted, const TraceOptions& options) {
  std::array<Ray<T>, count> rays;
  std::ranges::transform(wanted, rays.begin(), rounded<T>);
  std::array<TracedRay<T>, count> exact, fast;
  BatchOptions batch{.travel = options.travel, .apertures = options.apertures, .arithmetic = Arithmetic::reproducible};
  trace<T>(lens, rays, exact.data(), batch);
  batch.arithmetic = Arithmetic::fast;
  trace<T>(lens, rays, fast.data(), batch);
  for (std::size_t i = 0; i < count; ++i) {
    const TracedRay<T> one = trace(lens, rays[i], options);
    check(one, lens), check(exact[i], lens);
    if (glm::length(Vec3<double>(one.ray.origin)) < farthest) check(fast[i], lens);
    fuzz::require(one.fate == exact[i].fate && one.surface == exact[i].surface,
                  "a reproducible batch has the same fates");
    if (one.transmitted()) fuzz::require(same_bits(one.ray, exact[i].ray), "a reproducible batch has the same bits");
  }
}

/// Distance between the ends of two rays.
double apart(const Ray<double>& a, const Ray<double>& b) {
  return glm::length(a.origin - b.origin) + glm::length(a.direction - b.direction);
}

/// Checks that a float ray ends like the double ray within 1000 times the effect of one float eps in any number of the
/// ray, plus 1000 eps. Rounding of the constants of the lens is equivalent to another ray in front of the surface.
void float_against_double(const Lens& lens, const Ray<double>& wanted, const TraceOptions& options) {
  constexpr double eps = std::numeric_limits<float>::epsilon();
  const Ray<float> narrow = rounded<float>(wanted);
  const Ray<double> wide = rounded<double>({Vec3<double>(narrow.origin), Vec3<double>(narrow.direction)});
  const TracedRay<float> in_float = trace(lens, narrow, options);
  const TracedRay<double> in_double = trace(lens, wide, options);
  if (!in_float.transmitted() || !in_double.transmitted()) return;
  constexpr double farthest_start = 1e9, most_curved = 1e9;  // mm, 1/mm: the limits of tests/README.md
  if (!(glm::length(wide.origin) < farthest_start)) return;
  if (std::ranges::any_of(lens.surfaces(), [](const LensSurface& s) { return std::abs(s.curvature) > most_curved; })) {
    return;
  }
  bool beyond = false;  // at the rim of an asphere any crossing is accepted
  trace<double>(lens, wide, options, [&](int i, const Vec3<double>& hit) {
    const LensSurface& surface = lens.surfaces()[static_cast<std::size_t>(i)];
    beyond |= !surface.aspheric.empty() && !(std::hypot(hit.x, hit.y) <= surface.semi_diameter);
  });
  if (beyond) return;

  double moved = eps * (1 + glm::length(wide.origin) + glm::length(in_double.ray.origin));
  for (int k = 0; k < 12; ++k) {
    Ray<double> beside = wide;
    double& number = k < 6 ? beside.origin[k / 2] : beside.direction[k / 2 - 3];
    number += (k % 2 ? eps : -eps) * std::max(std::abs(number), 1.0);
    const TracedRay<double> end = trace(lens, beside, options);
    if (!end.transmitted()) return;  // at an edge any end is accepted
    moved += apart(end.ray, in_double.ray);
  }
  const Ray<double> end{Vec3<double>(in_float.ray.origin), Vec3<double>(in_float.ray.direction)};
  fuzz::require(apart(end, in_double.ray) <= 1000 * moved, "float and double rays end at the same point");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const Lens lens = fuzz::wild_lens(bytes);
    const TraceOptions options{.travel = bytes.one_in(2) ? Travel::to_scene : Travel::to_film,
                               .apertures = !bytes.one_in(4)};
    std::array<Ray<double>, count> rays;
    for (auto& ray : rays) ray = wild_ray(bytes, lens, options.travel);
    one_against_batches<double>(lens, rays, options);
    one_against_batches<float>(lens, rays, options);
    float_against_double(lens, rays[0], options);
  });
  return 0;
}
