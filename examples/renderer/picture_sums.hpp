// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "petzval/image/image.hpp"
#include "renderer/fixed_sum.hpp"

namespace renderer {

/// What a path adds to a pixel.
struct Contribution {
  std::uint32_t pixel = 0;  ///< row * width + column
  std::array<float, 3> rgb{};
};

/// A rectangle of pixels.
struct PixelBlock {
  int x = 0, y = 0, width = 0, height = 0;
};

/// A mean and its standard error, which is not a number where there is nothing to compare.
struct Estimate {
  double mean = 0, standard_error = 0;
};

/// The sums of a picture: the same bits in whatever order, and in whatever parts, contributions are added.
///
/// A picture is traced in units: samples of the pixels of a tile of 16 x 16, fewer at the right and lower edges.
/// Contributions of a unit may fall on any pixel. The value of a pixel is the sum of all that fell on it over its own
/// samples. Samples belong to 16 rounds that do not depend on each other: their scatter gives standard errors. The
/// numbers of samples by round tell which samples a tile has, so that any picture can get more.
class PictureSums {
 public:
  static constexpr int tile_pixels = 16;
  static constexpr std::size_t rounds = 16;

  PictureSums(int width, int height);

  int width() const noexcept { return width_; }
  int height() const noexcept { return height_; }
  std::size_t tile_columns() const noexcept { return tile_columns_; }
  std::size_t tile_rows() const noexcept { return tile_rows_; }
  std::size_t tiles() const noexcept { return tiles_.size(); }
  PixelBlock block(std::size_t tile) const noexcept;
  /// Number of samples of each pixel of a tile: in all rounds, or in one round.
  std::uint64_t samples(std::size_t tile) const noexcept;
  std::uint32_t samples(std::size_t tile, std::size_t round) const noexcept { return tiles_[tile].samples[round]; }
  /// Contributions that were left out: not finite, or beyond 2^40.
  std::uint64_t rejected() const noexcept { return rejected_; }

  /// Adds a unit: so many samples of each pixel of a tile, of one round. Not by several threads at once.
  void add(std::size_t tile, std::size_t round, std::uint32_t samples, std::span<const Contribution> contributions);
  /// Adds the sums of another part of the picture. Throws petzval::Error for a tile that both have, or another size.
  void add(const PictureSums& part);

  /// Black where a tile has no samples.
  petzval::RgbImage picture() const;
  /// Of all pixels, in each channel; of the luminance of a tile. Both by the samples of the tiles that have some.
  std::array<Estimate, 3> mean() const;
  Estimate luminance(std::size_t tile) const;

  /// The same bits.
  friend bool operator==(const PictureSums&, const PictureSums&) = default;

 private:
  friend class Checkpoint;
  struct Tile {
    std::array<std::uint32_t, rounds> samples{};  ///< of each pixel
    std::array<FixedSum, rounds> luminance{};

    friend bool operator==(const Tile&, const Tile&) = default;
  };
  using Rgb3 = std::array<FixedSum, 3>;

  int width_, height_;
  std::size_t tile_columns_, tile_rows_;
  std::vector<Rgb3> pixels_;
  std::vector<Tile> tiles_;
  std::array<Rgb3, rounds> totals_{};
  std::uint64_t rejected_ = 0;
};

}  // namespace renderer
