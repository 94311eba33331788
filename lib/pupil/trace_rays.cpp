// SPDX-License-Identifier: Apache-2.0
#include "trace_rays.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/meet_plane.hpp"
#include "core/scalar.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::pupil_detail {
namespace {

bool arrives(double x, double y, double towards_film) noexcept {
  return kernel::all_of(towards_film > 0, kernel::finite(x), kernel::finite(y));
}

struct RayBlock {
  std::array<double, block_rays> x, y, z, dx, dy, dz;
  std::array<RayFate, block_rays> fates;

  RayArrays<double> arrays() noexcept { return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}; }
  RayArrays<const double> const_arrays() const noexcept {
    return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()};
  }
};

/// Intersects the rays that passed the lens with the plane and stores the hits in their order from index `first` on.
/// Returns the number of hits.
std::size_t meet(const RayBlock& rays, std::size_t count, double light_direction, std::span<const double> weights,
                 std::size_t first, RayBundle& bundle) noexcept {
  std::array<double, block_rays> x, y, slope_x, slope_y;
  const bool slopes = !bundle.slope_x.empty();
  if (slopes) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto line = core_detail::slope_ray(core_detail::ray_at(rays.const_arrays(), i), bundle.plane_z);
      x[i] = line.x, y[i] = line.y;
      slope_x[i] = line.slope_x, slope_y[i] = line.slope_y;
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> hit = core_detail::meet_plane(core_detail::ray_at(rays.const_arrays(), i), bundle.plane_z);
      x[i] = hit.x, y[i] = hit.y;
    }
  }
  // Branch-free: every ray is written and, if it does not reach the plane, overwritten by the next ray. Few rays are
  // lost, but the processor cannot predict which.
  std::size_t kept = first;
  for (std::size_t i = 0; i < count; ++i) {
    bundle.x[kept] = x[i], bundle.y[kept] = y[i];
    if (slopes) bundle.slope_x[kept] = slope_x[i], bundle.slope_y[kept] = slope_y[i];
    if (!weights.empty()) bundle.weights[kept] = weights[first + i];
    kept += kernel::all_of(rays.fates[i] == RayFate::transmitted, arrives(x[i], y[i], rays.dz[i] * light_direction));
  }
  return kept - first;
}

/// Removes the gaps between the results of the blocks.
void close_gaps(std::vector<double>& values, const std::vector<std::size_t>& kept) {
  if (values.empty()) return;
  auto end = values.begin();
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(k * block_rays);
    const auto stop = begin + static_cast<std::ptrdiff_t>(kept[k]);
    end = begin == end ? stop : std::copy(begin, stop, end);
  }
  values.erase(end, values.end());
}

}  // namespace

RayBundle trace_rays(const Lens& lens, double plane_z, std::size_t count, const TraceRaysOptions& options,
                     const StartRays& start) {
  RayBundle bundle;
  bundle.plane_z = plane_z;
  bundle.sent = count;
  bundle.x.resize(count), bundle.y.resize(count);
  if (options.slopes) bundle.slope_x.resize(count), bundle.slope_y.resize(count);
  if (!options.weights.empty()) bundle.weights.resize(count);

  const double light = lens.light_direction(lens.surface_count());
  std::vector<std::size_t> kept((count + block_rays - 1) / block_rays);
  parallel_for(count, block_rays, options.threads, [&](std::size_t begin, std::size_t end) {
    RayBlock rays;
    const std::size_t started = start(begin, end, rays.arrays());
    trace<double>(lens, started, rays.const_arrays(), rays.arrays(), rays.fates.data(), nullptr,
                  {.wavelengths = {options.wavelength}, .arithmetic = options.arithmetic});
    kept[begin / block_rays] = meet(rays, started, light, options.weights, begin, bundle);
  });
  for (auto* values : {&bundle.x, &bundle.y, &bundle.slope_x, &bundle.slope_y, &bundle.weights}) {
    close_gaps(*values, kept);
  }
  return bundle;
}

void append(RayBundle& bundle, const RayBundle& more) {
  for (const auto values :
       {&RayBundle::x, &RayBundle::y, &RayBundle::slope_x, &RayBundle::slope_y, &RayBundle::weights}) {
    (bundle.*values).insert((bundle.*values).end(), (more.*values).begin(), (more.*values).end());
  }
  bundle.sent += more.sent;
}

std::optional<Vec3<double>> meet_film(const Lens& lens, const Ray<double>& ray) noexcept {
  const Vec3<double> hit = core_detail::meet_plane(ray, lens.film_z());
  if (!arrives(hit.x, hit.y, ray.direction.z * lens.light_direction(lens.surface_count()))) return {};
  return hit;
}

}  // namespace petzval::pupil_detail
