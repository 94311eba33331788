// SPDX-License-Identifier: Apache-2.0
// Makes all ray bundles: rays are started in blocks, traced, and intersected with a plane behind the lens.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval::pupil_detail {

/// Number of rays traced together: few enough to stay in the first cache from the pupil to the plane, and enough for
/// several blocks of the tracer.
inline constexpr std::size_t block_rays = 512;

/// Writes rays `begin` to `end` of a bundle, at most block_rays, to the front of the arrays.
///
/// @return  number of rays written: at most end - begin, and exactly end - begin if the bundle has weights
using StartRays = std::function<std::size_t(std::size_t begin, std::size_t end, const RayArrays<double>& rays)>;

struct TraceRaysOptions {
  Wavelength wavelength = {};
  bool slopes = true;
  std::span<const double> weights{};  ///< one per ray; empty for equal weights
  Arithmetic arithmetic = Arithmetic::reproducible;
  int threads = 1;
};

/// Traces `count` rays and keeps the rays that pass the lens and run towards the film. A plane in front of the last
/// surface is intersected with the rays extended backwards.
///
/// The result does not depend on the number of threads. sampled_area stays 0.
/// @throws Error if options.threads < 1
PETZVAL_API RayBundle trace_rays(const Lens& lens, double plane_z, std::size_t count, const TraceRaysOptions& options,
                                 const StartRays& start);

/// Appends the rays of another bundle in the same plane. Both bundles must have the same arrays.
PETZVAL_API void append(RayBundle& bundle, const RayBundle& more);

/// Intersection of a ray behind the lens with the film; nullopt if the ray is parallel to the film or recedes.
PETZVAL_API std::optional<Vec3<double>> meet_film(const Lens& lens, const Ray<double>& ray) noexcept;

}  // namespace petzval::pupil_detail
