// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/first_hits.hpp"
#include "renderer/integrators.hpp"

namespace renderer {

/// Samples of a pixel: `count` samples of a round (see PictureSums::rounds), starting at `first`.
///
/// The samples of a round are a low-discrepancy sequence over film and pupil, uniform for any number of samples. Rounds
/// are independent.
struct SampleRange {
  std::uint32_t round = 0, first = 0, count = 0;
  bool film = true, light = true;  ///< the ends of the paths that contribute

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Traces a picture in units: some samples of each pixel of a block. The contributions of a unit depend only on the
/// seed, its pixels and its samples.
class UnitTracer {
 public:
  /// The scene, the lens and the colours must outlive the tracer.
  UnitTracer(const Scene& scene, const LensCamera& lens, const PathColourSource& colours, Integrator integrator,
             std::uint64_t seed) noexcept
      : scene_(scene), lens_(lens), colours_(colours), integrator_(integrator), seed_(seed) {}

  /// Traces one path for each sample of each pixel of a block; the light tracer starts as many paths at the lamps.
  ///
  /// @param film          contributions of film samples, all to pixels of the block's tile
  /// @param light         contributions of light paths, to any pixel
  /// @param lens_seconds  sum to which the time spent in the lens is added (s)
  void trace(const PixelBlock& block, const SampleRange& samples, Splats& film, Splats& light,
             double& lens_seconds) const;
  /// The ends at which the paths of the integrator begin.
  bool from_film() const noexcept { return integrator_ != Integrator::light; }
  bool from_light() const noexcept { return integrator_ != Integrator::path; }

  /// Adds the weighted sums of the first hits of one sample of each pixel of a block, row by row.
  void add_first_hits(const PixelBlock& block, std::uint32_t round, std::uint32_t sample,
                      std::span<FirstHit> sums) const;

 private:
  struct Drawn {
    std::vector<std::uint32_t> pixels;
    std::vector<Random> random;
    std::vector<PathColours> colours;
  };
  Drawn draw(const PixelBlock& block, std::uint32_t round, std::uint32_t sample) const;
  LensCamera::Batch batch_of(const Drawn& drawn, std::uint32_t round, std::uint32_t sample) const;
  void trace_once(const PixelBlock& block, const SampleRange& samples, std::uint32_t sample, Splats& film_splats,
                  Splats& light_splats, double& lens_seconds) const;

  const Scene& scene_;
  const LensCamera& lens_;
  const PathColourSource& colours_;
  Integrator integrator_;
  std::uint64_t seed_;
};

}  // namespace renderer
