// SPDX-License-Identifier: Apache-2.0
// The maker of all bundles: rays that a function starts, block by block, are traced and meet a plane behind the lens.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/ray_bundle.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::pupil_detail {

/// Rays that are traced together: few enough to stay in the first cache on their way from the pupil to the plane, and
/// many enough for several blocks of the tracer.
inline constexpr std::size_t block_rays = 512;

/// Writes the rays from `begin` to `end` of a bundle, at most block_rays, to the front of the arrays and returns how
/// many they are: at most end - begin, and as many where the bundle has weights.
using StartRays = std::function<std::size_t(std::size_t begin, std::size_t end, const RayArrays<double>& rays)>;

struct TraceRaysOptions {
  Wavelength wavelength = {};
  bool slopes = true;
  std::span<const double> weights{};  ///< one for each ray, or none
  Arithmetic arithmetic = Arithmetic::reproducible;
  int threads = 1;
};

/// Traces `count` rays and keeps those that pass the lens and run towards the film; a plane in front of the last
/// surface is met by their lines. The bundle does not depend on the number of threads: each block has its own place.
/// sampled_area is left at 0. Throws Error for less than one thread.
PETZVAL_API RayBundle trace_rays(const Lens& lens, double plane_z, std::size_t count, const TraceRaysOptions& options,
                                 const StartRays& start);

/// Adds the rays of another bundle in the same plane. Both have slopes and weights.
PETZVAL_API void append(RayBundle& bundle, const RayBundle& more);

/// Where a ray that leaves the lens meets its film. Nothing where it runs along it or away from it.
PETZVAL_API std::optional<Vec3<double>> meet_film(const Lens& lens, const Ray<double>& ray) noexcept;

}  // namespace petzval::pupil_detail
