// SPDX-License-Identifier: Apache-2.0
// The loops that follow rays through layers, which gather_loops.cpp defines for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"

namespace petzval::blur_detail {

/// Layers around a tile: a window of them, or a copy with repeated edges if rays leave them. Lanes read up to 66
/// numbers beyond the pixels that rays reach.
struct LayerWindow {
  int layers = 0;
  std::ptrdiff_t stride = 0;        ///< from row to row
  std::ptrdiff_t layer_stride = 0;  ///< from layer to layer
  /// Of the first layer at the tile's first pixel: inverse depth, below 0 where empty; as many colours as rays have in
  /// common; alpha.
  const float *depth = nullptr, *colour[3] = {}, *alpha = nullptr;

  /// From another pixel of the tile on.
  LayerWindow from(int row, int column) const noexcept {
    const std::ptrdiff_t first = row * stride + column;
    return {
        layers,       stride, layer_stride, depth + first, {colour[0] + first, colour[1] + first, colour[2] + first},
        alpha + first};
  }
};

/// Sums over the rays of the pixels of a tile, of weights and of weights times what was found.
struct TileSums {
  static constexpr int columns = 64, rows = 16, pixels = columns * rows;
  /// Position of the sums of a pixel. side: pixels side columns and rows apart stand side by side, as they do on lanes.
  static constexpr int place(int row, int column, int side) noexcept {
    return (row % side * (rows / side) + row / side) * columns + column % side * (columns / side) + column / side;
  }
  float colour[3][pixels], alpha[pixels];
  float total[pixels];    ///< of all rays
  float open[pixels];     ///< of those that ended in the void (alpha 1 less), where no surface is
  float missed[pixels];   ///< of those that met what the layers do not know
  float unknown[pixels];  ///< of the latter, of those for which not even a guess was found
};

/// What a ray of all pixels does in a step: it passes a pixel beside its own, while inverse depths are in a range.
struct Step {
  std::ptrdiff_t offset;
  float low, high;  ///< low >= 0
};

/// The rays that are the same for all pixels of a job: ray i has the steps first[i] to first[i + 1] - 1.
struct SameRays {
  std::size_t count = 0;
  const Step* steps = nullptr;
  const std::uint32_t* first = nullptr;
  const float* weights = nullptr;
  const std::ptrdiff_t* ends = nullptr;  ///< offsets of the pixels at the depth of the farthest surface
};

/// Rays that differ: lines at the tile's four corners (upper left, upper right, lower left, lower right), each
/// [Row][ray] as in RayTable. Loops read a register beyond the last ray.
struct DifferentRays {
  std::size_t count = 0, row_stride = 0;
  const float* corners[4] = {};
  float* scratch = nullptr;  ///< of coherent: 2 row_count row_stride numbers
  float from = 0, to = 0;    ///< inverse depths between which they are followed
  float most = 0, end = 0;   ///< of all surfaces, the nearest (above 0) and the farthest
  int side = 1;              ///< pixels take `count` rays of side x side sets in turn
};

/// A tile or, for `same`, the pixels of a tile that take one set of rays: every side-th column and row.
struct TileJob {
  LayerWindow window;
  int columns = 0, rows = 0;  ///< of the pixels
  int side = 1;               ///< of `same`: 1, 2 or 4
  int left = 0, top = 0;      ///< of the first pixel in the picture
  int first_sum = 0;          ///< TileSums::place() of the first pixel
  int colours = 3;            ///< in common, 3 or 1
  bool opaque = true;
  float gap = 0;  ///< surfaces of neighbouring pixels whose inverse depths differ by no more are joined
  TileSums* sums = nullptr;
};

/// Offsets of rays from their pixels, px.
struct Limits {
  float left, right, top, bottom;
};

struct GatherLoops {
  /// Each adds to the sums and returns how many steps its lanes made.
  std::uint64_t (*same)(const TileJob&, const SameRays&) noexcept;
  std::uint64_t (*coherent)(const TileJob&, const DifferentRays&) noexcept;
  std::uint64_t (*general)(const TileJob&, const DifferentRays&) noexcept;
  /// Between two inverse depths, of `count` rays at some corners, [Row][ray] with rows `stride` apart; a register more
  /// is read. Lines are straight: they reach farthest at the ends.
  Limits (*limits)(const float* const* corners, std::size_t corner_count, std::size_t stride, std::size_t count,
                   float w, float v) noexcept;
};

PETZVAL_WIDEST(GatherLoops, gather_loops)

}  // namespace petzval::blur_detail
