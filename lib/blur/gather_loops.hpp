// SPDX-License-Identifier: Apache-2.0
// Loops that follow rays through layers. gather_loops.cpp defines them for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"

namespace petzval::blur_detail {

/// Layers around a tile: a view of the layers, or a copy with repeated edge pixels if rays leave the layers. Lanes read
/// up to 66 numbers beyond the pixels that rays reach.
struct LayerWindow {
  int layers = 0;
  std::ptrdiff_t stride = 0;        ///< from row to row
  std::ptrdiff_t layer_stride = 0;  ///< from layer to layer
  /// The first layer at the tile's first pixel: inverse depth (negative if empty), the planes of PackedColour, and
  /// alpha, unless all surfaces have alpha 1.
  const float *depth = nullptr, *colour[2] = {}, *alpha = nullptr;
  int channel = 0;  ///< colour of rays with one colour

  /// The window that begins at another pixel of the tile.
  LayerWindow from(int row, int column) const noexcept {
    const std::ptrdiff_t first = row * stride + column;
    return {layers,
            stride,
            layer_stride,
            depth + first,
            {colour[0] + first, colour[1] + first},
            alpha ? alpha + first : nullptr,
            channel};
  }
};

/// Sums over the rays of each pixel of a tile: weights, and weights times the colour or alpha of the ray.
struct TileSums {
  static constexpr int columns = 64, rows = 16, pixels = columns * rows;
  /// Index of the sums of a pixel.
  /// @param side pixels `side` columns and rows apart get adjacent indices, for SIMD lanes
  static constexpr int index(int row, int column, int side) noexcept {
    return (row % side * (rows / side) + row / side) * columns + column % side * (columns / side) + column / side;
  }
  float colour[3][pixels], alpha[pixels];
  float total[pixels];    ///< weight of all rays
  float open[pixels];     ///< weight of rays that end in the void, where alpha is 0
  float missed[pixels];   ///< weight of rays that meet parts of the scene that are not in the layers
  float unknown[pixels];  ///< weight of missed rays for which there is no guess
};

/// A step of a ray that is common to all pixels: at an offset from its own pixel, the ray passes a pixel in a range of
/// inverse depths.
struct Step {
  std::ptrdiff_t offset;
  float low, high;  ///< low >= 0
};

/// Rays that are equal for all pixels of a job. Ray i has the steps first[i] to first[i + 1] - 1.
struct SameRays {
  std::size_t count = 0;
  const Step* steps = nullptr;
  const std::uint32_t* first = nullptr;
  const float* weights = nullptr;
  const std::ptrdiff_t* ends = nullptr;  ///< offsets of the pixels at the depth of the farthest surface
};

/// Rays that differ between pixels: lines at the four corners of the tile (upper left, upper right, lower left, lower
/// right), each [Row][ray] as in RayTable. Loops read a register beyond the last ray.
struct DifferentRays {
  std::size_t count = 0, row_stride = 0;
  const float* corners[4] = {};
  float* scratch = nullptr;  ///< for `coherent`: 2 row_count row_stride numbers
  float from = 0, to = 0;    ///< inverse depths at which rays begin and end
  float most = 0, end = 0;   ///< inverse depths of the nearest (above 0) and the farthest surface
  int side = 1;              ///< ray sets alternate over blocks of side x side pixels
};

/// A tile or, for `same`, the pixels of a tile that share one set of rays: every side-th column and row.
struct TileJob {
  LayerWindow window;
  int columns = 0, rows = 0;  ///< number of pixels
  int side = 1;               ///< for `same`: 1, 2 or 4
  int left = 0, top = 0;      ///< position of the first pixel in the picture
  int first_sum = 0;          ///< TileSums::index() of the first pixel
  int colours = 3;            ///< colours per ray, 3 or 1
  bool opaque = true;
  float gap = 0;  ///< surfaces of adjacent pixels are joined up to this difference of inverse depths
  TileSums* sums = nullptr;
};

/// Range of the offsets of rays from their pixels, px.
struct Limits {
  float left, right, top, bottom;
};

struct GatherLoops {
  /// Each returns the number of steps of all lanes. `same` and `coherent` store sums, also for pixels in the same row
  /// beyond the tile; `general` adds to sums.
  std::uint64_t (*same)(const TileJob&, const SameRays&) noexcept;
  std::uint64_t (*coherent)(const TileJob&, const DifferentRays&) noexcept;
  std::uint64_t (*general)(const TileJob&, const DifferentRays&) noexcept;
  /// Offsets of `count` rays at some corners between two inverse depths. Corners are [Row][ray] with rows `stride`
  /// apart; one more register is read. Lines are straight, so the extremes lie at the ends.
  Limits (*limits)(const float* const* corners, std::size_t corner_count, std::size_t stride, std::size_t count,
                   float w, float v) noexcept;
  /// The fraction of each ray that surfaces in front of a highlight transmit; up to a register more is written.
  /// @param window the layers at the pixel of the highlight
  /// @param rays   lines at corners[0], relative to the pixel of the highlight; they end at the inverse depth `to`
  /// @param gap    as in TileJob
  /// @param pixels first and last pixels of the layers, relative to the pixel of the highlight
  void (*transmit)(const LayerWindow& window, const DifferentRays& rays, float gap, const Limits& pixels,
                   float* fractions) noexcept;
};

PETZVAL_WIDEST(GatherLoops, gather_loops)

}  // namespace petzval::blur_detail
