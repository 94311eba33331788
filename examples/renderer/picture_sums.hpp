// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "petzval/image/image.hpp"
#include "renderer/fixed_sum.hpp"

namespace renderer {

/// The contribution of a path to a pixel.
struct Contribution {
  std::uint32_t pixel = 0;  ///< row * width + column
  std::array<float, 3> rgb{};
};

/// A rectangle of pixels.
struct PixelBlock {
  int x = 0, y = 0, width = 0, height = 0;
};

/// A mean and its standard error, NaN if fewer than two rounds have samples or the sum is 0.
struct Estimate {
  double mean = 0, standard_error = 0;
};

/// The sums of a picture. Their bits do not depend on the order or the grouping of contributions.
///
/// A picture is traced in units: samples of the pixels of a tile of 16 x 16 (smaller at the right and lower edges). A
/// unit may contribute to any pixel. The value of a pixel is the sum of its contributions divided by its own number of
/// samples. Samples belong to 16 independent rounds, whose scatter gives standard errors. The numbers of samples by
/// round identify the samples of a tile, so that samples can be added to any picture.
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
  /// Number of samples per pixel of a tile, in all rounds or in one round.
  std::uint64_t samples(std::size_t tile) const noexcept;
  std::uint32_t samples(std::size_t tile, std::size_t round) const noexcept { return tiles_[tile].samples[round]; }
  /// Number of rejected contributions: not finite, or beyond 2^40.
  std::uint64_t rejected() const noexcept { return rejected_; }

  /// Adds a unit: `samples` samples per pixel of a tile in one round. Not thread-safe.
  void add(std::size_t tile, std::size_t round, std::uint32_t samples, std::span<const Contribution> contributions);
  /// Adds the sums of another part. @throws petzval::Error if both parts have a tile, or the sizes differ
  void add(const PictureSums& part);

  /// The picture; tiles without samples are black.
  petzval::RgbImage picture() const;
  /// Mean of all pixels by channel, and of the luminance of a tile. Tiles without samples do not count.
  std::array<Estimate, 3> mean() const;
  Estimate luminance(std::size_t tile) const;

  /// Channels beside the colours by name, of the size of the picture: first_hits(). Empty until set.
  using Channels = std::map<std::string, std::vector<float>>;
  const Channels& guides() const noexcept { return guides_; }
  void set_guides(Channels guides) { guides_ = std::move(guides); }

  /// True if all bits are equal.
  friend bool operator==(const PictureSums&, const PictureSums&) = default;

 private:
  friend class Checkpoint;
  struct Tile {
    std::array<std::uint32_t, rounds> samples{};  ///< per pixel
    std::array<FixedSum, rounds> luminance{};

    friend bool operator==(const Tile&, const Tile&) = default;
  };
  using Rgb3 = std::array<FixedSum, 3>;

  void copy(const PixelBlock& block, const std::vector<float>& from, std::vector<float>& to) const;

  int width_, height_;
  std::size_t tile_columns_, tile_rows_;
  std::vector<Rgb3> pixels_;
  std::vector<Tile> tiles_;
  std::array<Rgb3, rounds> totals_{};
  std::uint64_t rejected_ = 0;
  Channels guides_;
};

}  // namespace renderer
