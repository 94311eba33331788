// SPDX-License-Identifier: Apache-2.0
// Loops that follow rays through layers. gather_loops.cpp defines them for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "ray_rows.hpp"

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
  float colour[3][pixels], alpha[pixels];
  float total[pixels];    ///< weight of all rays
  float open[pixels];     ///< weight of rays that end in the void, where alpha is 0
  float missed[pixels];   ///< weight of rays that meet parts of the scene that are not in the layers
  float unknown[pixels];  ///< weight of missed rays for which there is no guess
};

/// The rays of a tile: lines at its four corners (upper left, upper right, lower left, lower right), each [Row][ray] as
/// in RayTable. Loops read a register beyond the last ray.
struct TileRays {
  std::size_t count = 0, row_stride = 0;  ///< rays of a set, and of all sets
  const float* corners[4] = {};
  float from = 0, to = 0;   ///< inverse depths at which rays begin and end
  float most = 0, end = 0;  ///< inverse depths of the nearest (above 0) and the farthest surface
  int side = 1;             ///< ray sets alternate over blocks of side x side pixels: 1, 2 or 4
  /// The pixels of a block follow a line at its middle if their own lines differ from it by less than these distances
  /// (px) at these inverse depths.
  struct {
    float depth = 0, px = -1;
  } tolerances[3] = {};
  std::size_t most_steps = 0;  ///< no line has more steps between `from` and `to`
  float* scratch = nullptr;    ///< scratch_size() numbers

  static constexpr std::size_t widest = 16;  ///< lanes of the widest registers
  /// Length of the rows of coefficients in `scratch`.
  constexpr std::size_t padded() const noexcept { return row_stride + widest; }
  static constexpr std::size_t numbers_of_ray(std::size_t steps) noexcept { return 3 * steps + 8; }
  /// In `scratch`, after the coefficients of the lines: one number per ray.
  float* excess() const noexcept { return scratch + 4 * row_count * padded(); }
  constexpr std::size_t scratch_size() const noexcept {
    return (4 * row_count + 1) * padded() + (count + widest) * numbers_of_ray(most_steps);
  }
};

/// A tile of the picture.
struct TileJob {
  LayerWindow window;
  int columns = 0, rows = 0;  ///< number of pixels
  int left = 0, top = 0;      ///< position of the first pixel in the picture
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
  /// Follows the rays of all pixels of a tile and stores their sums, also for pixels in the same row beyond the tile.
  /// Returns the number of steps of all lanes.
  std::uint64_t (*follow)(const TileJob&, const TileRays&) noexcept;
  /// Offsets of `count` rays at some corners between two inverse depths. Corners are [Row][ray] with rows `stride`
  /// apart; one more register is read. Lines are straight, so the extremes lie at the ends.
  Limits (*limits)(const float* const* corners, std::size_t corner_count, std::size_t stride, std::size_t count,
                   float w, float v) noexcept;
  /// The fraction of each ray that surfaces in front of a highlight transmit; up to a register more is written.
  /// @param window the layers at the pixel of the highlight
  /// @param rays   lines at corners[0], relative to the pixel of the highlight; they end at the inverse depth `to`
  /// @param gap    as in TileJob
  /// @param pixels first and last pixels of the layers, relative to the pixel of the highlight
  void (*transmit)(const LayerWindow& window, const TileRays& rays, float gap, const Limits& pixels,
                   float* fractions) noexcept;
};

PETZVAL_WIDEST(GatherLoops, gather_loops)

/// The loops for rays whose lines differ over the picture, in sets that alternate over blocks of side x side pixels.
/// The pixels of a register follow one line, so 16 lanes leave it more often than 8. With 16 sets fewer lines are made.
inline const GatherLoops& gather_loops(bool lines_differ, [[maybe_unused]] int side) noexcept {
#if defined(__x86_64__)
  if (lines_differ && side < 4 && instruction_sets().back() == InstructionSet::avx512) return gather_loops_avx2;
#endif
  return gather_loops();
}

}  // namespace petzval::blur_detail
