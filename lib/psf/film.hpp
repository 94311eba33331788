// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "core/meet_plane.hpp"
#include "core/scalar.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0::psf_detail {

/// Rays of a part of a bundle as a structure of arrays: few enough to stay in the first cache on their way from the
/// pupil to the film, and enough blocks of the trace.
struct RayBlock {
  static constexpr std::size_t size = 512;
  std::array<double, size> x, y, z, dx, dy, dz;
  std::array<RayFate, size> fates;

  RayArrays<double> arrays() noexcept { return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}; }
  RayArrays<const double> arrays() const noexcept {
    return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()};
  }
};

/// The film plane as rays that left the lens see it. They meet it unless they run away from it or along it; a film in
/// front of the last surface is met in the rays' continuation backwards.
class Film {
 public:
  explicit Film(const Lens& lens) : z_(lens.film_z()), sense_(lens.light_direction(lens.surface_count())) {}

  std::optional<std::array<double, 2>> meet(const Ray<double>& ray) const noexcept {
    const Vec3<double> hit = core_detail::meet_plane(ray, z_);
    if (!counts(hit.x, hit.y, ray.direction.z)) return {};
    return std::array{hit.x, hit.y};
  }

  /// Where the transmitted ones of `count` rays meet the film, side by side in their order; returns how many do.
  /// x, y: room for all, apart from the rays.
  std::size_t meet(std::size_t count, const RayBlock& rays, double* x, double* y) const noexcept {
    std::array<double, RayBlock::size> all_x, all_y;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> hit = core_detail::meet_plane(core_detail::ray_at(rays.arrays(), i), z_);
      all_x[i] = hit.x, all_y[i] = hit.y;
    }
    // A place is written for every ray and kept for those that arrive: few are lost, but none can foretell which.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      x[kept] = all_x[i], y[kept] = all_y[i];
      kept += kernel::all_of(rays.fates[i] == RayFate::transmitted, counts(all_x[i], all_y[i], rays.dz[i]));
    }
    return kept;
  }

 private:
  bool counts(double x, double y, double dz) const noexcept {
    return kernel::all_of(dz * sense_ > 0, kernel::finite(x), kernel::finite(y));
  }

  double z_, sense_;
};

}  // namespace petzval::inline v0::psf_detail
