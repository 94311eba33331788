// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "scene_grid.hpp"

namespace petzval::pupil_table_detail {

/// Samples N scene points; pdf = 0 for points outside the grid.
/// @param wavelength wavelength indices, -1 if not covered
template <int dimensions>
using SceneLoop = void (*)(const SceneGrid<dimensions>&, std::size_t, const double* x, const double* y, const double* z,
                           const double* u, const double* v, const std::int32_t* wavelength,
                           const EntranceRays&) noexcept;

struct SceneLoops {
  SceneLoop<2> of_revolution;
  SceneLoop<3> with_cylinders;

  template <int dimensions>
  SceneLoop<dimensions> of() const noexcept {
    if constexpr (dimensions == 2) {
      return of_revolution;
    } else {
      return with_cylinders;
    }
  }
};
PETZVAL_WIDEST(SceneLoops, scene_loops)

}  // namespace petzval::pupil_table_detail
