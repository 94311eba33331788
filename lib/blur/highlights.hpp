// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "layer_data.hpp"
#include "petzval/blur/gather.hpp"
#include "ray_table.hpp"

namespace petzval::blur_detail {

/// A bright pixel of the layers.
struct Highlight {
  int column = 0, row = 0, layer = 0;
  float inverse_depth = 0, light[3] = {};
  float area = 0;  ///< of its blur, px
};

/// Counts highlights in rectangles.
class CountsIn {
 public:
  /// columns, rows: of the layers. Rectangles are widened to whole blocks of `block` pixels.
  void fill(int columns, int rows, int block, const std::vector<Highlight>& of);
  std::uint32_t operator()(const PixelRect& rect) const noexcept;

 private:
  int columns_ = 0, rows_ = 0, block_ = 1;
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> before_;  ///< in the blocks above and left
};

/// Bright pixels that a few rays would show as patterns of dots: they leave the layers, and the light of each is spread
/// over the pixels that see it through the lens.
class Highlights {
 public:
  Highlights(const LayerData& layers, const LensRays& rays, const GatherOptions& options, int overscan);

  std::size_t count() const noexcept { return found_.size(); }
  /// How many are in a rectangle of the layers, widened to whole blocks.
  std::uint32_t count_in(const PixelRect& rect) const noexcept { return found_in_(rect); }
  /// Takes their light out of a copy of a rectangle: `planes` planes for each of `layers` layers, `plane_stride` apart,
  /// of rows of `columns` pixels.
  void cut(const PixelRect& rect, int columns, int layers, int planes, std::size_t plane_stride, float* copy) const;
  /// Adds it to the picture.
  void spread(int threads, Blurred& picture) const;

 private:
  /// Neighbours of about one depth, which are seen through the same rays: positions in found_.
  using Group = std::vector<std::size_t>;
  struct Stamp;
  struct Alike;

  void find(float above);
  void make_groups();
  /// rays_of_pixel: for each pixel that its blur covers.
  Stamp stamp_of(const Highlight& highlight, double rays_of_pixel, const RayTable& rays) const;
  const Highlight& brightest(const Group& group) const;
  /// The part of the picture that a group is spread over; without columns if that is beside the picture.
  RasterArea area_of(const Group& group, std::size_t channel) const;
  /// Stamps for all members of a group.
  std::vector<Alike> stamps_of(const Group& group, std::size_t channel) const;
  void add(const Stamp& stamp, const Highlight& highlight, std::size_t channel, Blurred& picture) const;
  float visible(const float* line, double x, double y, const Highlight& highlight) const;

  const LayerData& layers_;
  const RayData& rays_;
  float gap_, nearest_, farthest_;  ///< the latter: inverse depths of the nearest and the farthest surface
  int overscan_;
  std::vector<Highlight> found_;  ///< by rows
  std::vector<Group> groups_;
  std::vector<std::size_t> row_begin_;  ///< of the layers' rows among them, and their end
  CountsIn found_in_;
  std::vector<RayTable> shared_;  ///< of each channel, of rays that all pixels share
};

}  // namespace petzval::blur_detail
