// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/path_colours.hpp"
#include "renderer/picture_sums.hpp"

namespace renderer {

inline constexpr std::uint32_t no_pixel = ~std::uint32_t{0};
/// Where the lanes of a path meet the film: a lens bends each wavelength in its own way.
using LanePixels = std::array<std::uint32_t, 4>;

/// What paths add to a picture.
class Splats {
 public:
  void add(const PathColours& colours, const LanePixels& pixels, const Lanes& value);
  const std::vector<Contribution>& all() const noexcept { return all_; }

 private:
  std::vector<Contribution> all_;
};

}  // namespace renderer
