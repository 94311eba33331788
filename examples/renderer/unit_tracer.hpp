// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/integrators.hpp"

namespace renderer {

/// Traces a picture in units: some samples of each pixel of a block. What a unit adds follows from the seed, its pixels
/// and its samples alone.
class UnitTracer {
 public:
  /// The scene, the lens and the colours must outlive it.
  UnitTracer(const Scene& scene, const LensCamera& lens, const PathColourSource& colours, Integrator integrator,
             std::uint64_t seed) noexcept
      : scene_(scene), lens_(lens), colours_(colours), integrator_(integrator), seed_(seed) {}

  /// Samples `first` to `first + count` of each pixel: one path for each, by the light tracer as many. lens_seconds:
  /// the time spent in the lens is added to it.
  void trace(const PixelBlock& block, std::uint32_t first, std::uint32_t count, Splats& splats,
             double& lens_seconds) const;

 private:
  const Scene& scene_;
  const LensCamera& lens_;
  const PathColourSource& colours_;
  Integrator integrator_;
  std::uint64_t seed_;
};

}  // namespace renderer
