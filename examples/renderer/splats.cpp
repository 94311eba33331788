// SPDX-License-Identifier: Apache-2.0
#include "renderer/splats.hpp"

namespace renderer {

void Splats::add(const PathColours& colours, const LanePixels& pixels, const Lanes& value) {
  for (int lane = 0; lane < colours.lanes;) {
    const std::uint32_t pixel = pixels[static_cast<std::size_t>(lane)];
    Rgb rgb(0);
    // Adjacent lanes usually meet the same pixel.
    for (; lane < colours.lanes && pixels[static_cast<std::size_t>(lane)] == pixel; ++lane) {
      rgb += colours.to_rgb[lane] * value[lane];
    }
    if (pixel != no_pixel && rgb != Rgb(0)) all_.push_back({pixel, {rgb.r, rgb.g, rgb.b}});
  }
}

}  // namespace renderer
