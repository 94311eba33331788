// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "renderer/unit_tracer.hpp"

namespace renderer {

/// The amount of work. With `samples` the picture gets the missing samples, and the time limit leaves the rest for a
/// later call. Without `samples` passes of one sample follow each other until the time limit. The time limit ends after
/// a complete pass: light tracing adds light to all tiles, so tiles with unequal numbers of samples would be biased.
struct Effort {
  std::optional<std::uint32_t> samples;  ///< of each pixel
  std::optional<double> seconds;

  /// The next samples of a tile: at most 16 samples of the round with the fewest samples among the incomplete rounds.
  /// The count is 0 if the tile is complete.
  SampleRange next(const PictureSums& sums, std::size_t tile) const noexcept;
  /// Number of calls of next() until the tile is complete; 0 without `samples`.
  std::size_t units_left(const PictureSums& sums, std::size_t tile) const noexcept;
};

/// What a call of render() did.
struct RenderReport {
  double seconds = 0;       ///< that it took
  double busy_seconds = 0;  ///< of all threads
  double lens_seconds = 0;  ///< of those: spent in the lens
  std::uint64_t paths = 0;
  bool finished = false;     ///< true if no tile lacks samples
  bool interrupted = false;  ///< true if stop() ended the work
};

/// Traces the samples that some tiles of a picture lack. save: called from time to time, and at the end, with nothing
/// half added. stop: asked before each unit; true ends the work, within a pass. The picture does not depend on the
/// number of threads, nor on how often it was cut off.
RenderReport render(
    const UnitTracer& tracer, PictureSums& sums, const std::vector<std::size_t>& tiles, const Effort& effort,
    int threads, const std::function<void()>& save, const std::function<bool()>& stop = [] { return false; });

}  // namespace renderer
