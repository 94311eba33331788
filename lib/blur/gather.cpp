// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/lens_rays.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "core/text.hpp"
#include "gather_loops.hpp"
#include "gather_memory.hpp"
#include "gather_method.hpp"
#include "highlights.hpp"
#include "layer_data.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "ray_table.hpp"

namespace petzval {
namespace {

using namespace blur_detail;

constexpr std::size_t most_window = std::size_t{1} << 26;  // numbers in a copied window: 256 MiB

int floor_of(double x) { return static_cast<int>(std::floor(x)); }

/// A part of the picture whose rays are followed together.
struct Tile {
  int left = 0, top = 0, columns = 0, rows = 0;
};

/// One call of gather().
class Gathering {
 public:
  Gathering(const LayerSet& layers, const LensRays& rays, const GatherOptions& options, const GatherMethod& method,
            int overscan, const Highlights& highlights, const RasterArea& region, BlurredImage& picture)
      : layers_(LayerAccess::data(layers)),
        rays_(RayAccess::data(rays)),
        options_(options),
        method_(method),
        overscan_(overscan),
        highlights_(highlights),
        region_(region),
        picture_(picture),
        all_(layers_.depths()),
        farthest_(all_.empty() ? 0 : all_.least) {
    // The corners of a tile lie in one cell of the table, and its rays are interpolated between the corners.
    tile_columns_ = std::min(rays_.table.step, TileSums::columns);
    tile_rows_ = std::min(rays_.table.step, TileSums::rows);
    tiles_ = {region.left / tile_columns_, region.top / tile_rows_};
    tiles_.columns = (region.left + region.columns - 1) / tile_columns_ - tiles_.left + 1;
    tiles_.rows = (region.top + region.rows - 1) / tile_rows_ - tiles_.top + 1;
  }

  std::size_t tile_count() const noexcept {
    return static_cast<std::size_t>(tiles_.columns) * static_cast<std::size_t>(tiles_.rows);
  }

  void run(GatherProgress& progress) {
    progress_ = &progress;
    parallel_for(tile_count(), 4, options_.threads, [this](std::size_t begin, std::size_t end) {
      const BlurredImage::Memory::Loan loan(*picture_.memory);
      const RasterArea& image = rays_.table.area;
      for (std::size_t t = begin; t < end; ++t) {
        keep_on(options_.stop, "gather");
        const int left = (tiles_.left + static_cast<int>(t) % tiles_.columns) * tile_columns_,
                  top = (tiles_.top + static_cast<int>(t) / tiles_.columns) * tile_rows_;
        follow({left, top, std::min(tile_columns_, image.columns - left), std::min(tile_rows_, image.rows - top)},
               *loan);
        progress_->add(1);
      }
    });
    picture_.step_count = steps_;
    picture_.missed_count = missed_;
  }

 private:
  using Memory = BlurredImage::Memory::OfThread;

  void follow(const Tile& tile, Memory& memory) {
    for (std::size_t channel = 0; channel < rays_.table.channels; ++channel) follow(tile, channel, memory);
    compose(tile, memory);
  }

  void follow(const Tile& tile, std::size_t channel, Memory& memory) {
    const std::size_t stride = rays_.table.rays;
    const float* corners[4];
    for (int c = 0; c < 4; ++c) {
      corners[c] = rays_.shift_invariant ? rays_.table.node(channel, 0, 0)
                                         : rays_.table.rows_at(channel, tile.left + (c % 2) * tile.columns,
                                                               tile.top + (c / 2) * tile.rows, memory.corners[c]);
    }
    const GatherLoops& loops = gather_loops(!rays_.shift_invariant, rays_.side());
    const auto reach_of = [&](float least, float most) {
      return loops.limits(corners, rays_.shift_invariant ? 1 : 4, stride, stride, least, most);
    };
    const auto rect_of = [&](const Limits& reach) {
      const int left = tile.left + overscan_, top = tile.top + overscan_;
      // One more pixel on each side, because positions are rounded.
      return PixelRect{left + floor_of(reach.left) - 1, top + floor_of(reach.top) - 1,
                       left + tile.columns + floor_of(reach.right) + 1, top + tile.rows + floor_of(reach.bottom) + 1};
    };
    DepthRange range = all_;
    Limits reach = range.empty() ? reach_of(0, 0) : reach_of(range.least, range.most);
    constexpr int iterations = 3;
    for (int i = 0; method_.limit_steps && i < iterations && !range.empty(); ++i) {
      const DepthRange narrower = layers_.n_buffer.below(rect_of(reach));
      const bool same = narrower.least == range.least && narrower.most == range.most;
      range = narrower;
      if (same || range.empty()) break;
      reach = reach_of(range.least, range.most);
    }
    const int count = range.empty() ? 1 : range.layers;
    if (range.empty()) range = {farthest_, farthest_, 1}, reach = reach_of(farthest_, farthest_);

    // A ray without a hit is followed to the farthest of all depths, to detect if it ends in the void.
    const PixelRect all_read = rect_of(range.least > farthest_ ? reach_of(farthest_, range.most) : reach);
    const TileJob job{.window = window(tile, all_read, count, channel, memory),
                      .columns = tile.columns,
                      .rows = tile.rows,
                      .left = tile.left,
                      .top = tile.top,
                      .colours = rays_.table.channels == 1 ? 3 : 1,
                      .opaque = layers_.opaque,
                      .gap = rays_.gap(),
                      .sums = &memory.sums[channel]};
    constexpr std::size_t margin = 4;  // steps begin before and end after the range
    TileRays rays{
        .count = rays_.rays_of_set(),
        .row_stride = stride,
        .corners = {corners[0], corners[1], corners[2], corners[3]},
        .from = range.most,
        .to = range.least,
        .most = std::max(all_.most, 1e-30f),
        .end = farthest_,
        .side = rays_.side(),
        .most_steps = margin + static_cast<std::size_t>(std::max(reach.right - reach.left, reach.bottom - reach.top))};
    if (memory.scratch.size() < rays.scratch_size()) memory.scratch.resize(rays.scratch_size());
    rays.scratch = memory.scratch.data();
    if (method_.by_blocks) set_tolerances(rays);
    steps_ += loops.follow(job, rays);
    if (layers_.held_out()) follow_coverage(loops, job, rays, channel, memory);
  }

  /// Follows the rays again, with coverage and the rounding errors of red and green as their colours.
  void follow_coverage(const GatherLoops& loops, TileJob job, const TileRays& rays, std::size_t channel,
                       Memory& memory) const {
    const std::ptrdiff_t plane = job.window.layer_stride / layers_.planes;
    TileSums &sums = memory.sums[channel], &more = memory.covered;
    job.window.colour[0] = job.window.alpha + plane, job.window.colour[1] = job.window.alpha + 2 * plane;
    job.window.channel = 0, job.sums = &more;
    loops.follow(job, rays);
    std::ranges::copy(more.colour[0], sums.alpha);
    const auto add = [&](int colour, int error) {
      for (int i = 0; i < TileSums::pixels; ++i) sums.colour[colour][i] += more.colour[error][i];
    };
    if (job.colours == 3) return add(0, 1), add(1, 2);
    if (channel == 2) return;
    job.window.channel = static_cast<int>(channel) + 1;
    loops.follow(job, rays);
    add(0, 0);
  }

  /// In focus, lines may differ by less than the rounding to pixels; in a blur, also by a small part of its radius.
  static void set_tolerances(TileRays& rays) {
    constexpr float in_focus_px = 0.15f, of_radius = 0.03f;
    const auto radius = [&](float w) {
      const Limits at = gather_loops().limits(rays.corners, 1, rays.row_stride, rays.row_stride, w, w);
      return 0.25f * (at.right - at.left + at.bottom - at.top);
    };
    const float from = radius(rays.from), to = radius(rays.to),
                sharpest = rays.from + (rays.to - rays.from) * from / std::max(from + to, 1e-30f);
    rays.tolerances[0] = {rays.from, in_focus_px + of_radius * from};
    rays.tolerances[1] = {sharpest, in_focus_px + of_radius * radius(sharpest)};
    rays.tolerances[2] = {rays.to, in_focus_px + of_radius * to};
  }

  /// The layers at a tile whose rays stay within a rectangle.
  LayerWindow window(const Tile& tile, const PixelRect& rect, int count, std::size_t channel, Memory& memory) {
    const auto& d = layers_;
    LayerWindow w{.layers = count,
                  .stride = d.columns,
                  .layer_stride = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(d.planes) * d.plane_stride()),
                  .channel = static_cast<int>(channel)};
    const bool inside = rect.left >= 0 && rect.top >= 0 && rect.right < d.columns && rect.bottom < d.rows;
    if (inside && highlights_.count_in(rect) == 0) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(tile.top + overscan_) * d.columns + tile.left + overscan_;
      w.depth = d.plane(0, 0) + at, w.alpha = d.planes > 3 ? d.plane(0, 3) + at : nullptr;
      for (int p = 0; p < 2; ++p) w.colour[p] = d.plane(0, 1 + p) + at;
      return w;
    }
    // A copy with repeated edge pixels and without highlights.
    constexpr std::size_t slack = LayerData::slack;
    const std::size_t columns = static_cast<std::size_t>(rect.right - rect.left + 1),
                      rows = static_cast<std::size_t>(rect.bottom - rect.top + 1), plane = columns * rows + slack;
    const std::size_t planes = static_cast<std::size_t>(d.planes * count);
    if (planes * plane > most_window) {
      throw Error("gather: the rays of a few pixels reach over " + std::to_string(columns) + " x " +
                  std::to_string(rows) + " px of " + std::to_string(count) +
                  " layers, beyond their edges; the layers must reach as far (PeelPlan::camera), or surfaces must be "
                  "farther away");
    }
    if (memory.window.size() < 2 * slack + planes * plane) memory.window.resize(2 * slack + planes * plane);
    for (std::size_t p = 0; p < planes; ++p) {
      const float* const from = d.plane(static_cast<int>(p) / d.planes, static_cast<int>(p) % d.planes);
      float* to = memory.window.data() + slack + p * plane;
      for (int row = rect.top; row <= rect.bottom; ++row) {
        const float* const line = from + static_cast<std::ptrdiff_t>(std::clamp(row, 0, d.rows - 1)) * d.columns;
        const int before = std::min(std::max(0, -rect.left), static_cast<int>(columns)),
                  after = std::min(std::max(0, rect.right - (d.columns - 1)), static_cast<int>(columns));
        to = std::fill_n(to, before, line[0]);
        const int within = static_cast<int>(columns) - before - after;
        if (within > 0) to = std::copy_n(line + std::max(rect.left, 0), within, to);
        to = std::fill_n(to, after, line[d.columns - 1]);
      }
    }
    highlights_.cut(rect, static_cast<int>(columns), count, d.planes, plane, memory.window.data() + slack);
    const std::ptrdiff_t at =
        static_cast<std::ptrdiff_t>(tile.top + overscan_ - rect.top) * static_cast<std::ptrdiff_t>(columns) +
        tile.left + overscan_ - rect.left;
    const auto first = [&](int p) { return memory.window.data() + slack + static_cast<std::size_t>(p) * plane + at; };
    w.stride = static_cast<std::ptrdiff_t>(columns),
    w.layer_stride = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(d.planes) * plane);
    w.depth = first(0), w.alpha = d.planes > 3 ? first(3) : nullptr;
    for (int p = 0; p < 2; ++p) w.colour[p] = first(1 + p);
    return w;
  }

  void compose(const Tile& tile, const Memory& memory) {
    const std::size_t channels = rays_.table.channels;
    const float per_ray = 1 / static_cast<float>(rays_.rays_of_set());
    double missed = 0;
    const RasterArea part = common({tile.left, tile.top, tile.columns, tile.rows}, region_);
    for (int row = part.top; row < part.top + part.rows; ++row) {
      int at = (row - tile.top) * TileSums::columns + part.left - tile.left;
      const int end = at + part.columns;
      // In most rows all rays meet surfaces.
      bool all_met = layers_.opaque && !layers_.held_out();
      for (std::size_t c = 0; c < channels && all_met; ++c) {
        const TileSums& sums = memory.sums[c];
        for (int i = at; i < end; ++i) all_met &= (sums.open[i] == 0) & (sums.missed[i] == 0) & (sums.total[i] > 0);
      }
      const auto colour = [&](std::size_t c) {
        return channels == 1 ? memory.sums[0].colour[c] : memory.sums[c].colour[0];
      };
      const float *const red = colour(0), *const green = colour(1), *const blue = colour(2);
      const std::ptrdiff_t pixel =
          static_cast<std::ptrdiff_t>(row - region_.top) * picture_.columns + part.left - region_.left;
      float *rgba = picture_.rgba.data() + 4 * pixel, *unseen = picture_.missed.data() + pixel;
      for (int column = part.left; at < end; ++at, ++column, rgba += 4, ++unseen) {
        rgba[0] = red[at] * per_ray, rgba[1] = green[at] * per_ray, rgba[2] = blue[at] * per_ray, rgba[3] = 1;
        *unseen = all_met ? 0 : compose(memory, at, column, row, rgba);
        missed += static_cast<double>(*unseen);
      }
    }
    // Counted for each channel.
    missed_ += static_cast<std::uint64_t>(std::llround(missed * static_cast<double>(channels * rays_.rays_of_set())));
  }

  /// Completes a pixel whose rays may have missed surfaces. Returns the fraction of missed rays.
  float compose(const Memory& memory, int at, int column, int row, float* rgba) const {
    float alpha = 0, unseen = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const TileSums& sums = memory.sums[rays_.table.channels == 1 ? 0 : c];
      const float total = sums.total[at], known = total - sums.unknown[at];
      if (total > 0) unseen += sums.missed[at] / total;  // total is 0 in corners that the lens does not illuminate
      // If no ray is known, the first layer is the best guess.
      if (known > 1e-6f * total) {
        rgba[c] *= total / known;
        alpha +=
            layers_.opaque && !layers_.held_out() ? std::max(1 - sums.open[at] / known, 0.0f) : sums.alpha[at] / known;
      } else {
        const auto below = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(row + overscan_) * layers_.columns +
                                                    column + overscan_);
        const bool any = layers_.count > 0 && layers_.plane(0, 0)[below] >= 0;
        const float per_ray = 1 / static_cast<float>(rays_.rays_of_set());
        rgba[c] = any ? layers_.colour(0, below)[c] * total * per_ray : 0.0f;
        alpha += any ? layers_.coverage(0, below) : 0.0f;
      }
    }
    rgba[3] = alpha / 3;
    return unseen / 3;
  }

  const LayerData& layers_;
  const RayData& rays_;
  const GatherOptions& options_;
  GatherMethod method_;
  int overscan_, tile_columns_ = 0, tile_rows_ = 0;
  const Highlights& highlights_;
  RasterArea region_, tiles_;  ///< pixels of the picture, and the tiles with such pixels (in tiles)
  BlurredImage& picture_;
  GatherProgress* progress_ = nullptr;
  DepthRange all_;
  float farthest_;  ///< inverse depth at which rays end
  std::atomic<std::uint64_t> steps_ = 0, missed_ = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void blur_detail::gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                         const GatherMethod& method, BlurredImage& picture) {
  const auto wrong = [](const std::string& what) { return Error("gather: " + what); };
  const LayerCamera& camera = rays.camera();
  const int beyond = layers.columns() - camera.columns;
  if (beyond < 0 || beyond % 2 != 0 || layers.rows() - camera.rows != beyond) {
    throw wrong("layers: columns x rows = " + std::to_string(layers.columns()) + " x " + std::to_string(layers.rows()) +
                "; must be the picture's " + std::to_string(camera.columns) + " x " + std::to_string(camera.rows) +
                " plus the same overscan on all sides");
  }
  if (!(options.highlights_above >= 0)) {
    throw wrong("highlights_above = " + to_text(options.highlights_above) + "; must be at least 0 (0: off)");
  }
  const DepthRange depths = LayerAccess::data(layers).depths();
  const RayData& data = RayAccess::data(rays);
  const double bound = data.farthest_px + static_cast<double>(std::max(depths.most, 0.0f)) * data.largest_slope + 1;
  const double reach = depths.empty() || bound <= most_reach_px ? 0 : rays.reach_px(depths.least, depths.most);
  if (!(reach <= most_reach_px)) {
    throw wrong("rays reach " + to_text(reach, 6) + " px beyond the picture; must be at most " +
                to_text(most_reach_px) + ": the nearest surface is " +
                to_text(1 / static_cast<double>(depths.most), 6) + " mm away");
  }
  const RasterArea image{0, 0, camera.columns, camera.rows},
      region = options.left == 0 && options.top == 0 && options.columns == 0 && options.rows == 0
                   ? image
                   : RasterArea{options.left, options.top, options.columns, options.rows};
  if (region.left < 0 || region.top < 0 || region.columns < 1 || region.rows < 1 ||
      region.columns > image.columns - region.left || region.rows > image.rows - region.top) {
    throw wrong("region: columns x rows = " + std::to_string(region.columns) + " x " + std::to_string(region.rows) +
                " from column " + std::to_string(region.left) + ", row " + std::to_string(region.top) +
                "; must be within the picture's " + std::to_string(image.columns) + " x " + std::to_string(image.rows));
  }

  try {
    const auto pixels = static_cast<std::size_t>(region.columns) * static_cast<std::size_t>(region.rows);
    picture.columns = region.columns, picture.rows = region.rows;
    picture.rgba.resize(4 * pixels), picture.missed.resize(pixels);
    picture.ray_count = pixels * rays.count() * static_cast<std::size_t>(rays.channels());
    picture.missed_count = picture.step_count = picture.highlight_count = 0;
    if (!picture.memory) picture.memory = std::make_shared<BlurredImage::Memory>();

    auto start = std::chrono::steady_clock::now();
    const auto highlights = picture.memory->highlights(layers, rays, options, beyond / 2);
    const auto jobs = highlights->jobs_in(region);
    Gathering gathering(layers, rays, options, method, beyond / 2, *highlights, region, picture);
    GatherProgress progress(options, gathering.tile_count() + jobs.size());
    progress.add(0);
    const double finding = seconds_since(start);
    start = std::chrono::steady_clock::now();
    gathering.run(progress);
    picture.gather_seconds = seconds_since(start);
    start = std::chrono::steady_clock::now();
    highlights->spread(jobs, region, options, progress, picture);
    picture.highlight_count = highlights->count();
    picture.highlight_seconds = finding + seconds_since(start);
  } catch (...) {
    picture.columns = picture.rows = 0, picture.rgba.clear(), picture.missed.clear();
    throw;
  }
}

BlurredImage blur_detail::gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                                 const GatherMethod& method) {
  BlurredImage picture;
  gather(layers, rays, options, method, picture);
  return picture;
}

void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options, BlurredImage& picture) {
  blur_detail::gather(layers, rays, options, {}, picture);
}

BlurredImage gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options) {
  return blur_detail::gather(layers, rays, options, {});
}

}  // namespace petzval
