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
/// later call. Without `samples` passes of one sample follow each other until the time limit, which takes effect after
/// a complete pass, so that the noise is uniform.
///
/// With `noise` each tile gets samples until its relative noise (PictureSums::Noise) is reached, or `samples`. The
/// noise of 16 rounds is uncertain by 18 %; a tile is complete if its noise is below the request with a margin of that
/// size. Numbers of samples are decided between passes from all samples so far. Light paths reach all tiles: their
/// number grows for the whole picture, until they cause at most two thirds of the variance that is allowed in any tile.
struct Effort {
  std::optional<std::uint32_t> samples;  ///< samples per pixel
  std::optional<double> seconds;
  std::optional<double> noise{};  ///< needs `samples`, the upper limit
  double floor = 0.05;            ///< noise is relative to the mean luminance of the tile, or to this if larger

  /// The next samples of a tile: at most 16 samples of the round with the fewest samples among the incomplete rounds.
  /// The count is 0 if the tile is complete.
  SampleRange next(const PictureSums& sums, std::size_t tile) const noexcept;
  /// Number of calls of next() until the tile is complete; 0 without `samples` or with `noise`.
  std::size_t units_left(const PictureSums& sums, std::size_t tile) const noexcept;
  /// Sets the targets of the tiles for the next pass towards `noise`. Returns false if no tile needs more samples.
  bool plan(const UnitTracer& tracer, PictureSums& sums) const;
};

/// Results of a call of render().
struct RenderReport {
  double seconds = 0;       ///< elapsed time
  double busy_seconds = 0;  ///< time of all threads
  double lens_seconds = 0;  ///< part of busy_seconds spent in the lens
  std::uint64_t paths = 0;
  bool finished = false;     ///< true if no tile lacks samples, or the noise is reached
  bool interrupted = false;  ///< true if stop() ended the work
};

/// Traces the missing samples of some tiles of a picture. The picture depends neither on the number of threads nor on
/// interruptions.
///
/// @param save  called from time to time and at the end, always between complete units
/// @param stop  called before each unit; true ends the work, even within a pass
RenderReport render(
    const UnitTracer& tracer, PictureSums& sums, const std::vector<std::size_t>& tiles, const Effort& effort,
    int threads, const std::function<void()>& save, const std::function<bool()>& stop = [] { return false; });

}  // namespace renderer
