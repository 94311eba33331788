// SPDX-License-Identifier: Apache-2.0
// Samples of the entrance pupils of scene points, compiled once for each instruction set.
#include "scene_loops.hpp"

#include <type_traits>

#include "core/lane_table.hpp"

namespace petzval::pupil_table_detail {
namespace {

using core_detail::load;
using core_detail::store;

template <int angles>
void sample(const SceneGrid<angles>& given, std::size_t count, const SceneSamples& from,
            double* const (&to)[8]) noexcept {
  using V = core_detail::Lanes<double>;
  const SceneGrid<angles> grid = given;  // a copy that no output can alias
  const auto all = [&](auto obscured) {
    for (std::size_t o = 0; o < count; o += V::width) {
      Index<V> wavelength;
      __builtin_memcpy(&wavelength, from.wavelength + o, sizeof wavelength);
      const Index<V> covered = wavelength >= 0;
      const auto at = [o](const double* numbers) { return load(numbers + o); };
      const auto result =
          scene_sample<obscured.value, V>(grid, at(from.x), at(from.y), at(from.z), at(from.u), at(from.v),
                                          kernel::Table<V>::number(covered & 1) > V(0), Index<V>(wavelength & covered));
      for (std::size_t k = 0; k < result.size(); ++k) store(to[k] + o, result[k]);
    }
  };
  if (grid.obscured) {
    all(std::true_type());
  } else {
    all(std::false_type());
  }
}

}  // namespace

const SceneLoops PETZVAL_LOOPS{{sample<1>, sample<2>}};

}  // namespace petzval::pupil_table_detail
