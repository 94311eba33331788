// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/path_colours.hpp"
#include "renderer/picture_sums.hpp"

namespace renderer {

inline constexpr std::uint32_t no_pixel = ~std::uint32_t{0};
/// Pixels of the lanes of a path: a lens refracts each wavelength differently.
using LanePixels = std::array<std::uint32_t, 4>;

/// Contributions of paths to a picture.
class Splats {
 public:
  void add(const PathColours& colours, const LanePixels& pixels, const Lanes& value);
  const std::vector<Contribution>& all() const noexcept { return all_; }

 private:
  std::vector<Contribution> all_;
};

}  // namespace renderer
