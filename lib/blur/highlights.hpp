// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "gather_loops.hpp"
#include "layer_data.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "ray_table.hpp"

namespace petzval::blur_detail {

/// A bright pixel of the layers.
struct Highlight {
  int column = 0, row = 0, layer = 0;
  float inverse_depth = 0, light[3] = {};
  float rest[3] = {};  ///< light that stays in the pixel of the layer
  float area = 0;      ///< area of its blur, px^2
};

/// Counts highlights in rectangles.
class CountsIn {
 public:
  /// Rectangles are widened to full blocks of `block` x `block` pixels.
  /// @param columns, rows size of the layers
  void fill(int columns, int rows, int block, const std::vector<Highlight>& of);
  std::uint32_t operator()(const PixelRect& rect) const noexcept;

 private:
  int columns_ = 0, rows_ = 0, block_ = 1;
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> before_;  ///< number of highlights in the blocks above and to the left
};

/// Progress of a call of gather().
class GatherProgress {
 public:
  GatherProgress(const GatherOptions& options, std::size_t steps) : options_(options), steps_(steps) {}
  /// @throws Cancelled if GatherOptions::progress returns false
  void add(std::size_t steps) {
    done_ += steps;
    if (!options_.progress || std::this_thread::get_id() != caller_) return;
    if (!options_.progress(static_cast<double>(done_) / static_cast<double>(steps_))) throw Cancelled("gather");
  }

 private:
  const GatherOptions& options_;
  std::size_t steps_;
  std::atomic<std::size_t> done_ = 0;
  std::thread::id caller_ = std::this_thread::get_id();
};

/// Bright pixels that would appear as patterns of dots with few rays. Their light is removed from the layers and
/// distributed over the pixels whose rays meet it.
class Highlights {
 public:
  Highlights(const LayerData& layers, const LensRays& rays, const GatherOptions& options, int overscan);

  std::size_t count() const noexcept { return highlights_.size(); }
  /// Number of highlights in a rectangle of the layers, widened to full blocks.
  std::uint32_t count_in(const PixelRect& rect) const noexcept { return counts_(rect); }
  /// Removes the light of the highlights from a copy of a rectangle: `layers` layers of `planes` planes, `plane_stride`
  /// apart, with rows of `columns` pixels.
  void cut(const PixelRect& rect, int columns, int layers, int planes, std::size_t plane_stride, float* copy) const;
  /// Adjacent highlights of nearly equal depth, which the same rays meet: indices in found_.
  using Group = std::vector<std::size_t>;
  /// A group in a channel, and a rectangle around its light.
  struct Job {
    const Group* group;
    std::size_t channel;
    RasterArea bounds;
  };
  /// The jobs whose light may reach a region of the image.
  std::vector<Job> jobs_in(const RasterArea& region) const;
  /// Adds the light of jobs to the picture of a region, and a step for each job to the progress.
  void spread(const std::vector<Job>& jobs, const RasterArea& region, const GatherOptions& options,
              GatherProgress& progress, BlurredImage& picture) const;

 private:
  struct Stamp;
  struct SharedStamp;
  struct Splat;
  struct Lines;

  void find(const GatherOptions& options);
  /// The square cell of a row or column of the layers. Cells keep their positions in the picture if the overscan
  /// changes.
  int cell_of(int at, int size) const noexcept { return (at - overscan_ + (size << 16)) / size; }
  void make_groups();
  /// Adds lines that meet a highlight, up to a number of lines.
  void extend(Lines& lines, const Highlight& highlight, std::size_t count, const std::stop_token& stop) const;
  /// @param density number of rays for each pixel covered by the blur
  /// @param lines   the lines of the group so far
  Stamp stamp_of(const Highlight& highlight, double density, Lines& lines, const std::stop_token& stop) const;
  static void set_tents(std::vector<Splat>& splats, std::size_t rays, double area);
  static void contract(std::vector<Splat>& splats);
  const Highlight& brightest(const Group& group) const;
  /// A rectangle around the pixels whose rays meet the brightest highlight of a group.
  RasterArea around(const Group& group, std::size_t channel) const;
  /// The part of the picture over which a group is distributed; it has no columns if it lies outside the picture.
  RasterArea area_of(const Group& group, std::size_t channel) const;
  std::vector<SharedStamp> stamps_of(const Group& group, std::size_t channel, const std::stop_token& stop) const;
  void add(const Stamp& stamp, const Highlight& highlight, const Job& job, const RasterArea& region,
           BlurredImage& picture) const;
  /// Finds the fraction of each line that surfaces in front of the highlight transmit.
  /// @param through 1 for each line, and a register more
  void hide(const Highlight& highlight, const Lines& lines, std::size_t count, std::vector<float>& through) const;

  const LayerData& layers_;
  const RayData& rays_;
  float gap_, nearest_, farthest_;  ///< nearest_, farthest_: inverse depths of the nearest and the farthest surface
  int overscan_;
  std::vector<Highlight> highlights_;  ///< sorted by rows
  std::vector<Group> groups_;
  std::vector<std::size_t> row_begin_;  ///< indices in found_ at which the rows of the layers begin, and the end
  CountsIn counts_;
  std::vector<RayTable> shared_;  ///< for each channel if all pixels share their rays
};

}  // namespace petzval::blur_detail
