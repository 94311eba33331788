// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "petzval/blur/lens_rays.hpp"
#include "ray_rows.hpp"

namespace petzval::blur_detail {

/// Largest overscan of layers that is accepted, px.
inline constexpr double most_reach_px = 16384;

/// A rectangle of raster positions.
struct RasterArea {
  int left = 0, top = 0, columns = 0, rows = 0;
};

inline RasterArea grown(const RasterArea& a, int by) noexcept {
  return {a.left - by, a.top - by, a.columns + 2 * by, a.rows + 2 * by};
}
/// The common part of two rectangles; without columns and rows if they are disjoint.
inline RasterArea common(const RasterArea& a, const RasterArea& b) noexcept {
  const int left = std::max(a.left, b.left), top = std::max(a.top, b.top),
            right = std::min(a.left + a.columns, b.left + b.columns), bottom = std::min(a.top + a.rows, b.top + b.rows);
  return left < right && top < bottom ? RasterArea{left, top, right - left, bottom - top} : RasterArea{};
}

/// Rays at nodes over an area: every `step` pixels from its upper left corner, and at its right and lower edges.
struct RayTable {
  RasterArea area;
  int step = 0;                        ///< px
  std::size_t channels = 0, rays = 0;  ///< rays: per node and channel
  std::size_t node_columns = 0, node_rows = 0;
  std::vector<float> nodes;  ///< [channel][node row][node column][Row][ray]

  std::size_t node_size() const noexcept { return row_count * rays; }
  const float* node(std::size_t channel, std::size_t row, std::size_t column) const noexcept {
    return nodes.data() + ((channel * node_rows + row) * node_columns + column) * node_size();
  }
  double column_of(std::size_t node) const noexcept;  ///< raster position
  double row_of(std::size_t node) const noexcept;
  /// The rows at a position in the area, interpolated between the nodes around it: node_size() numbers.
  void at(std::size_t channel, double column, double row, float* found) const noexcept;
  /// The rows at a position: of a node there, or interpolated to `scratch`. Readable up to 64 numbers beyond.
  const float* rows_at(std::size_t channel, double column, double row, std::vector<float>& scratch) const;
  /// The rows of one ray at a position: row_count numbers.
  void ray_at(std::size_t channel, std::size_t ray, double column, double row, float* found) const noexcept;
};

/// @throws Cancelled if a stop is requested
void keep_on(const std::stop_token& stop, const char* where);

/// The rays of a source at all nodes. Throws Error if a number is not finite or above 1e15, or a weight is negative.
RayTable ray_table(const RasterArea& area, std::span<const PupilPoint> points, std::size_t channels,
                   const LensRays::Source& source, int step, int threads, const std::stop_token& stop = {});

}  // namespace petzval::blur_detail

namespace petzval {

struct LensRays::Data {
  LayerCamera camera;
  std::vector<PupilPoint> points;
  Source source;
  LensRaysOptions options;
  blur_detail::RayTable table;
  double interpolation_error_px = 0, largest_slope = 0;
  double farthest_px = 0;  ///< largest distance of a ray at infinity from its pixel, along columns or rows
  bool shift_invariant = false;

  /// Rays of a channel over an area of the picture, for lights that would appear as dots with few rays. The pupil
  /// points are the points `first` to `end` - 1 of a sequence in which every run of points covers the pupil uniformly.
  blur_detail::RayTable dense(const blur_detail::RasterArea& area, std::size_t channel, std::size_t first,
                              std::size_t end, const std::stop_token& stop) const;

  std::size_t set_count() const noexcept { return static_cast<std::size_t>(options.set_count); }
  /// Side of the square blocks in which the sets alternate, px.
  int side() const noexcept { return options.set_count == 16 ? 4 : options.set_count == 4 ? 2 : 1; }
  std::size_t rays_of_set() const noexcept { return points.size() / set_count(); }
  /// Largest difference of inverse depths between adjacent pixels for which surfaces between them may be missing in the
  /// layers: the bias of peeling.
  float gap() const noexcept { return largest_slope > 0 ? static_cast<float>(std::min(1 / largest_slope, 1e20)) : 0; }
};

class RayAccess {
 public:
  using Data = LensRays::Data;
  static const LensRays::Data& data(const LensRays& rays) noexcept { return *rays.data_; }
};

namespace blur_detail {
using RayData = RayAccess::Data;
}

}  // namespace petzval
