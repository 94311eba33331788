// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "renderer/unit_tracer.hpp"

namespace renderer {

/// How much is traced. With a number of samples the picture is that of these, and a limit of time leaves the rest for
/// later. Without one it is as good as the time allows, in passes of one sample. Time ends with a whole pass: light
/// falls on all tiles, and a picture with more samples here than there has too little of it.
struct Effort {
  std::optional<std::uint32_t> samples;  ///< of each pixel
  std::optional<double> seconds;

  std::uint32_t passes() const noexcept;  ///< the largest number without a number of samples
  std::uint32_t first_sample(std::uint32_t pass) const noexcept;
  std::uint32_t samples_in(std::uint32_t pass) const noexcept;
};

/// What a call of render() did.
struct RenderReport {
  double seconds = 0;       ///< that it took
  double busy_seconds = 0;  ///< of all threads
  double lens_seconds = 0;  ///< of those: spent in the lens
  std::uint64_t paths = 0;
  bool finished = false;  ///< all passes of the tiles are there
};

/// Traces the passes that some tiles of a picture lack. save: called from time to time, and at the end, with nothing
/// half added. The picture does not depend on the number of threads, nor on how often it was cut off.
RenderReport render(const UnitTracer& tracer, PictureSums& sums, const std::vector<std::size_t>& tiles,
                    const Effort& effort, int threads, const std::function<void()>& save);

}  // namespace renderer
