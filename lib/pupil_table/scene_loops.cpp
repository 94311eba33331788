// SPDX-License-Identifier: Apache-2.0
// Samples of the entrance pupils of scene points, compiled once for each instruction set.
#include "scene_loops.hpp"

#include <type_traits>

namespace petzval::pupil_table_detail {
namespace {

template <int dimensions>
void sample(const SceneGrid<dimensions>& grid, std::size_t count, const double* x, const double* y, const double* z,
            const double* u, const double* v, const std::int32_t* wavelength, const EntranceRays& rays) noexcept {
  std::size_t begin = 0;
  const auto blocks = [&](auto block, auto obscured) {
    constexpr std::size_t size = decltype(block)::value;
    for (; begin + size <= count; begin += size) {
      sample_scene_block<size, decltype(obscured)::value>(grid, x + begin, y + begin, z + begin, u + begin, v + begin,
                                                          wavelength + begin, rays.from(begin));
    }
  };
  const auto all = [&](auto obscured) {
    blocks(std::integral_constant<std::size_t, 32>(), obscured);
    blocks(std::integral_constant<std::size_t, 8>(), obscured);  // fills the widest registers
    blocks(std::integral_constant<std::size_t, 1>(), obscured);
  };
  if (grid.obscured) {
    all(std::true_type());
  } else {
    all(std::false_type());
  }
}

}  // namespace

const SceneLoops PETZVAL_LOOPS{sample<2>, sample<3>};

}  // namespace petzval::pupil_table_detail
