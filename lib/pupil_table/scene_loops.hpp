// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "core/widest.hpp"
#include "scene_grid.hpp"

namespace petzval::pupil_table_detail {

/// Scene points and their samples, padded to a multiple of 8. wavelength: indices, -1 if not covered.
struct SceneSamples {
  const double *x, *y, *z, *u, *v;
  const std::int64_t* wavelength;
};

/// scene_sample() of N points, or of more up to a multiple of 8.
template <int angles>
using SceneLoop = void (*)(const SceneGrid<angles>&, std::size_t, const SceneSamples&, double* const (&to)[8]) noexcept;

struct SceneLoops {
  std::tuple<SceneLoop<1>, SceneLoop<2>> loops;  ///< by grid
};
PETZVAL_WIDEST(SceneLoops, scene_loops)

}  // namespace petzval::pupil_table_detail
