// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace petzval {

/// A deep image: a list of surface fragments for each pixel.
///
/// Pixel p has fragments[offsets[p]] to fragments[offsets[p + 1] - 1], in any order.
struct FragmentLists {
  /// One surface seen in a pixel.
  struct Fragment {
    float depth_mm = 0;                             ///< along the axis; infinity for the sky
    float red = 0, green = 0, blue = 0, alpha = 1;  ///< premultiplied by alpha
  };
  int columns = 0, rows = 0;
  std::vector<std::size_t> offsets;  ///< columns x rows + 1
  std::vector<Fragment> fragments;
};

}  // namespace petzval
