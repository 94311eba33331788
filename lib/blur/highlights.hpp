// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "layer_data.hpp"
#include "petzval/blur/gather.hpp"
#include "ray_table.hpp"

namespace petzval::inline v0::blur_detail {

/// Bright pixels that a few rays would show as patterns of dots: they leave the layers, and the light of each is spread
/// over the pixels that see it through the lens.
class Highlights {
 public:
  Highlights(const LayerData& layers, const LensRays& rays, const GatherOptions& options, int overscan);

  std::size_t count() const noexcept { return found_.size(); }
  /// How many are in a rectangle of the layers, widened to whole blocks.
  std::uint32_t count_in(const PixelRect& rect) const noexcept;
  /// Takes their light out of a copy of a rectangle: `planes` planes for each of `layers` layers, `plane_stride` apart,
  /// of rows of `columns` pixels.
  void cut(const PixelRect& rect, int columns, int layers, int planes, std::size_t plane_stride, float* copy) const;
  /// Adds it to the picture.
  void spread(int threads, Blurred& picture) const;

 private:
  struct Highlight {
    int column = 0, row = 0, layer = 0;  ///< of the layers
    float inverse_depth = 0, light[3] = {};
    float area = 0;  ///< of its blur, px
  };
  /// Neighbours of about one depth, which are seen through the same rays: positions in found_.
  using Group = std::vector<std::size_t>;
  struct Stamp;

  void find(float above);
  void count_blocks(const std::vector<Highlight>& of);
  void make_groups();
  /// rays_of_pixel: for each pixel that its blur covers.
  Stamp stamp_of(const Highlight& highlight, double rays_of_pixel, std::size_t channel) const;
  /// One for all of a group, or one for each.
  std::vector<Stamp> stamps_of(const Group& group, std::size_t channel) const;
  void add(const Stamp& stamp, const Highlight& highlight, std::size_t channel, Blurred& picture) const;
  float visible(const float* line, double x, double y, const Highlight& highlight) const;

  const LayerData& layers_;
  const RayData& rays_;
  float gap_, nearest_, farthest_;  ///< the latter: inverse depths of the nearest and the farthest surface
  int overscan_;
  std::vector<Highlight> found_;  ///< by rows
  std::vector<Group> groups_;
  std::vector<std::size_t> row_begin_;  ///< of the layers' rows among them, and their end
  std::vector<std::uint32_t> before_;   ///< how many are in blocks above and left
  int block_columns_ = 0;
};

}  // namespace petzval::inline v0::blur_detail
