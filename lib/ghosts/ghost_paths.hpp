// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "footprint.hpp"
#include "petzval/ghosts/ghosts.hpp"

namespace petzval::ghosts_detail {

/// The light and the pairs of surfaces of one lens.
struct GhostPaths {
  struct Pair {
    std::size_t first, second;  ///< as in GhostPair
  };

  /// @throws Error as ghost_pairs()
  GhostPaths(const Lens& lens, const ScenePoint& light, const GhostOptions& options);

  Entrance entrance;
  std::vector<Pair> pairs;
  double entering = 0;  ///< Ghosts::entering_mm2
  std::size_t left_out = 0;
  double left_out_energy = 0;
};

/// The path of a pair to the film.
LightPath path_of(const Lens& lens, const GhostPaths::Pair& pair);

}  // namespace petzval::ghosts_detail
