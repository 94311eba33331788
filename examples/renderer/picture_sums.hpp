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
/// A picture is traced in units: samples of the pixels of a tile of 16 x 16 (smaller at the right and lower edges).
/// Film samples contribute to pixels of their tile; their sum is divided by the number of samples of the tile. Light
/// paths contribute to any pixel; their sum is divided by the number of light paths per pixel of the whole picture.
/// Tiles may therefore have different numbers of both. Samples belong to 16 independent rounds, whose scatter gives
/// standard errors. The numbers of samples by round identify the samples of a tile, so that samples can be added to
/// any picture.
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
  /// Film samples and light paths of a tile.
  enum class Of : std::uint8_t { film, light };
  static constexpr std::array both{Of::film, Of::light};
  /// Number of samples per pixel of a tile, in all rounds or in one round.
  std::uint64_t samples(std::size_t tile, Of of = Of::film) const noexcept;
  std::uint32_t samples(std::size_t tile, std::size_t round, Of of = Of::film) const noexcept {
    return part(tile, of).samples[round];
  }
  /// Number of light paths per pixel of the picture.
  double light_paths() const noexcept;
  /// Samples per pixel that a tile should get next; 0 until set. Kept in checkpoints, so that a resumed picture has the
  /// same samples.
  std::uint32_t target(std::size_t tile, Of of) const noexcept { return part(tile, of).target; }
  void set_target(std::size_t tile, Of of, std::uint32_t samples) noexcept { part(tile, of).target = samples; }
  /// Number of rejected contributions: not finite, or beyond 2^40.
  std::uint64_t rejected() const noexcept { return rejected_; }

  /// Adds a unit: `samples` film samples or light paths per pixel of a tile in one round. Not thread-safe.
  void add(std::size_t tile, std::size_t round, std::uint32_t samples, std::span<const Contribution> contributions,
           Of of = Of::film);
  /// Adds the sums of another part. @throws petzval::Error if both parts have a tile, or the sizes differ
  void add(const PictureSums& part);

  /// The picture; tiles without samples are black.
  petzval::RgbImage picture() const;
  /// Mean of all pixels by channel, and of the luminance of a tile. Tiles without samples do not count.
  std::array<Estimate, 3> mean() const;
  Estimate luminance(std::size_t tile) const;
  /// Noise of a tile: variance of the luminance of a pixel, mean over its pixels, from film samples and light paths,
  /// and the mean luminance. Pixels have independent samples: the variance of a pixel is the variance of the mean of
  /// the tile times its number of pixels. Variances are NaN if fewer than two rounds have samples.
  struct Noise {
    double film = 0, light = 0, mean = 0;
    /// Root mean square of the standard errors of the pixels, divided by the mean luminance or, if larger, by `floor`.
    double relative(double floor) const noexcept;
  };
  std::vector<Noise> noise() const;

  /// Channels beside the colours by name, of the size of the picture: first_hits(). Empty until set.
  using Channels = std::map<std::string, std::vector<float>>;
  const Channels& guides() const noexcept { return guides_; }
  void set_guides(Channels guides) { guides_ = std::move(guides); }

  /// True if all bits are equal.
  friend bool operator==(const PictureSums&, const PictureSums&) = default;

 private:
  friend class Checkpoint;
  using Rgb3 = std::array<FixedSum, 3>;
  struct Part {
    std::array<std::uint32_t, rounds> samples{};  ///< per pixel
    std::uint32_t target = 0;
    std::array<Rgb3, rounds> sums{};  ///< contributions to the tile

    friend bool operator==(const Part&, const Part&) = default;
  };
  using Tile = std::array<Part, 2>;
  /// The deviations of the rounds of a tile from its mean, as contributions to the error of the mean.
  struct Deviations {
    std::array<double, rounds> film{}, light{};
    double mean = 0;
    bool empty = true;  ///< true if all sums are 0
  };
  Deviations deviations(std::size_t tile, const std::array<double, 3>& weights,
                        const std::array<double, rounds>& light_paths) const;
  std::array<double, rounds> light_paths_by_round() const noexcept;
  Part& part(std::size_t tile, Of of) noexcept { return tiles_[tile][static_cast<std::size_t>(of)]; }
  const Part& part(std::size_t tile, Of of) const noexcept { return tiles_[tile][static_cast<std::size_t>(of)]; }
  double area(std::size_t tile) const noexcept;

  void copy(const PixelBlock& block, const std::vector<float>& from, std::vector<float>& to) const;

  int width_, height_;
  std::size_t tile_columns_, tile_rows_;
  std::array<std::vector<Rgb3>, 2> pixels_;  ///< sums of film samples and of light paths
  std::vector<Tile> tiles_;
  std::uint64_t rejected_ = 0;
  Channels guides_;
};

}  // namespace renderer
