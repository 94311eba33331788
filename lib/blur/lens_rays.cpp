// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/lens_rays.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "check_sides.hpp"
#include "core/low_discrepancy.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "ray_table.hpp"

namespace petzval {
namespace {

using namespace blur_detail;

constexpr int widest_step = 256, narrowest_step = 16;  // limits of the step for large pictures
constexpr double same_px = 1e-3;                       // lines that differ by less count as equal

/// Largest error, over all positions, of a coarse table interpolated to the nodes of a fine table.
struct TableError {
  double px = 0;     ///< RMS over the lines of a position, at the depth where they are closest together
  double light = 0;  ///< error of the summed weights of a position, relative to the largest sum

  bool within_limits() const noexcept { return px <= 0.1 && light <= 6e-3; }
};

/// The inverse depth, from 0 to `nearest`, at which the lines of a node are closest together.
double sharpest(const float* node, std::size_t rays, double nearest) {
  const auto n = static_cast<double>(rays);
  double across = 0, steep = 0;  // covariance of positions and slopes, variance of slopes
  for (const auto& [at, slope] : {std::pair{at_x, slope_x}, std::pair{at_y, slope_y}}) {
    double a = 0, s = 0, as = 0, ss = 0;
    for (std::size_t i = 0; i < rays; ++i) {
      const double x = node[at * rays + i], y = node[slope * rays + i];
      a += x, s += y, as += x * y, ss += y * y;
    }
    across += as - a * s / n, steep += ss - s * s / n;
  }
  return steep > 0 ? std::clamp(-across / steep, 0.0, nearest) : 0;
}

TableError error_of(const RayTable& coarse, const RayTable& fine, double nearest) {
  std::vector<float> found(coarse.node_size());
  TableError error;
  double brightest = 0;
  for (std::size_t channel = 0; channel < fine.channels; ++channel) {
    for (std::size_t row = 0; row < fine.node_rows; ++row) {
      for (std::size_t column = 0; column < fine.node_columns; ++column) {
        coarse.at(channel, fine.column_of(column), fine.row_of(row), found.data());
        const float* const exact = fine.node(channel, row, column);
        const double focus = sharpest(exact, fine.rays, nearest);
        double light = 0, expected = 0, sum = 0;
        for (std::size_t i = 0; i < fine.rays; ++i) {
          const auto off = [&](Row r) {
            return static_cast<double>(found[r * fine.rays + i]) - exact[r * fine.rays + i];
          };
          light += found[weight * fine.rays + i], expected += exact[weight * fine.rays + i];
          if (exact[weight * fine.rays + i] == 0) continue;
          const double x = off(at_x) + focus * off(slope_x), y = off(at_y) + focus * off(slope_y);
          sum += x * x + y * y;
        }
        error.px = std::max(error.px, std::sqrt(sum / static_cast<double>(fine.rays)));
        error.light = std::max(error.light, std::abs(light - expected)), brightest = std::max(brightest, expected);
      }
    }
  }
  if (brightest > 0) error.light /= brightest;
  return error;
}

void check(const LayerCamera& camera, std::span<const PupilPoint> points, int channels,
           const LensRaysOptions& options) {
  const auto wrong = [](const std::string& what) { return Error("lens rays: " + what); };
  check_sides("lens rays: layer camera", camera.columns, camera.rows);
  if (!(camera.focal_px > 0 && std::isfinite(camera.focal_px))) {
    throw wrong("focal length of the layer camera = " + to_text(camera.focal_px) + " px; must be finite and above 0");
  }
  if (!std::isfinite(camera.axis.x) || !std::isfinite(camera.axis.y)) {
    throw wrong("axis of the layer camera = " + to_text(camera.axis.x) + ", " + to_text(camera.axis.y) +
                " px; must be finite");
  }
  if (channels != 1 && channels != 3) throw wrong(std::to_string(channels) + " channels; must be 1 or 3");
  if (options.set_count != 1 && options.set_count != 4 && options.set_count != 16) {
    throw wrong(std::to_string(options.set_count) + " sets; must be 1, 4 or 16");
  }
  if (points.empty() || points.size() % static_cast<std::size_t>(options.set_count) != 0) {
    throw wrong(std::to_string(points.size()) + " points; must be at least 1, and equally many for each of " +
                std::to_string(options.set_count) + " sets");
  }
  for (const PupilPoint& p : points) {
    if (p.u >= 0 && p.u <= 1 && p.v >= 0 && p.v <= 1) continue;
    throw wrong("a point of the pupil = " + to_text(p.u) + ", " + to_text(p.v) + "; must be two numbers from 0 to 1");
  }
  if (!(options.nearest_mm >= 0 && std::isfinite(options.nearest_mm))) {
    throw wrong("nearest depth = " + to_text(options.nearest_mm) + " mm; must be finite and at least 0 (0: default)");
  }
}

/// Largest differences between the rays of any node and of the first node, and the largest slope.
struct Spread {
  double differ_px = 0;  ///< lines at infinity and at the nearest depth, along columns or rows
  double light = 0;      ///< weights
  double steepest = 0;   ///< largest |slope|, px mm
  double farthest = 0;   ///< largest |position| relative to the pixel, px
};

Spread spread_of(const RayTable& t, double nearest) {
  const std::size_t n = t.rays;
  Spread spread;
  for (std::size_t channel = 0; channel < t.channels; ++channel) {
    for (std::size_t node = 0; node < t.node_columns * t.node_rows; ++node) {
      const float *const first = t.node(channel, 0, 0), *const here = first + node * t.node_size();
      for (std::size_t i = 0; i < n; ++i) {
        const auto off = [&](Row r) { return std::abs(static_cast<double>(here[r * n + i]) - first[r * n + i]); };
        for (const auto& [at, slope] : {std::pair{at_x, slope_x}, std::pair{at_y, slope_y}}) {
          spread.differ_px = std::max({spread.differ_px, off(at), off(at) + nearest * off(slope)});
          spread.steepest = std::max(spread.steepest, std::abs(static_cast<double>(here[slope * n + i])));
          spread.farthest = std::max(spread.farthest, std::abs(static_cast<double>(here[at * n + i])));
        }
        spread.light = std::max(spread.light, off(weight));
      }
    }
  }
  return spread;
}

/// Moves each ray within its pixel, equally at all nodes. Positions are rounded to pixels, so that rays stay in theirs.
void spread_over_pixels(RayTable& table) {
  constexpr double side = 0.998;
  const core_detail::Kronecker<2> positions;
  for (std::size_t begin = 0; begin < table.nodes.size(); begin += table.node_size()) {
    for (std::size_t i = 0; i < table.rays; ++i) {
      const auto at = positions(i);
      table.nodes[begin + at_x * table.rays + i] += static_cast<float>(side * (at[0] - 0.5));
      table.nodes[begin + at_y * table.rays + i] += static_cast<float>(side * (at[1] - 0.5));
    }
  }
}

/// Calls f(x, y, dx, dy) for the rays of all nodes at two inverse depths: raster position, and offset of the ray.
template <class F>
void each_offset(const RayTable& t, double least, double most, const F& f) {
  const std::size_t n = t.rays;
  for (std::size_t channel = 0; channel < t.channels; ++channel) {
    for (std::size_t row = 0; row < t.node_rows; ++row) {
      for (std::size_t column = 0; column < t.node_columns; ++column) {
        const double x = t.column_of(column), y = t.row_of(row);
        const float* const node = t.node(channel, row, column);
        for (std::size_t i = 0; i < n; ++i) {
          for (const double w : {least, most}) {
            f(x, y, node[at_x * n + i] + w * node[slope_x * n + i], node[at_y * n + i] + w * node[slope_y * n + i]);
          }
        }
      }
    }
  }
}

}  // namespace

Cancelled::~Cancelled() = default;  // anchors the type information in this library

LensRays::LensRays(const LayerCamera& camera, std::span<const PupilPoint> points, int channels, Source source,
                   const LensRaysOptions& options) {
  check(camera, points, channels, options);
  if (!source) throw Error("lens rays: the source is empty; must be a function");
  auto d = std::make_shared<Data>();
  d->camera = camera, d->camera.overscan = 0;
  d->points.assign(points.begin(), points.end());
  d->source = std::move(source), d->options = options, d->options.stop = {};
  if (options.nearest_mm == 0) d->options.nearest_mm = 24 * camera.focal_px / camera.rows;
  const double nearest = 1 / d->options.nearest_mm;

  const auto count = static_cast<std::size_t>(channels);
  const auto table = [&](int step, std::span<const PupilPoint> of) {
    return ray_table({0, 0, d->camera.columns, d->camera.rows}, of, count, d->source, step, options.threads,
                     options.stop);
  };
  // A few points suffice to find the step.
  const std::vector<PupilPoint> few = vogel_points(16);
  const std::span<const PupilPoint> tried = points.size() > few.size() ? few : points;
  // With a step above the side of the picture, no node would lie inside the picture for an error estimate. Pixels of
  // small pictures are large on the film, so that their steps are small.
  const auto power_of_two = [](int length) { return static_cast<int>(std::bit_floor(static_cast<unsigned>(length))); };
  const int last_step = std::clamp(power_of_two(std::max(camera.columns, camera.rows)) / 16, 2, narrowest_step);
  const int first_step = std::clamp(power_of_two(std::min(camera.columns, camera.rows)), last_step, widest_step);
  d->table = table(first_step, tried);
  for (int step = first_step / 2;; step /= 2) {
    RayTable fine = table(step, tried);
    const TableError error = error_of(d->table, fine, nearest);
    d->interpolation_error_px = error.px;
    if (error.within_limits() || d->table.step == last_step) break;
    d->table = std::move(fine);
  }
  if (tried.size() != points.size()) d->table = table(d->table.step, points);

  const Spread spread = spread_of(d->table, nearest);
  d->largest_slope = spread.steepest, d->farthest_px = spread.farthest;
  d->shift_invariant = spread.differ_px <= same_px && spread.light <= 1e-6;
  if (options.over_pixels) spread_over_pixels(d->table);
  data_ = std::move(d);
}

const LayerCamera& LensRays::camera() const noexcept { return data_->camera; }
int LensRays::channels() const noexcept { return static_cast<int>(data_->table.channels); }
int LensRays::set_count() const noexcept { return data_->options.set_count; }
std::size_t LensRays::count() const noexcept { return data_->rays_of_set(); }
bool LensRays::shift_invariant() const noexcept { return data_->shift_invariant; }
double LensRays::interpolation_error_px() const noexcept { return data_->interpolation_error_px; }
double LensRays::nearest_mm() const noexcept { return data_->options.nearest_mm; }
double LensRays::largest_slope() const noexcept { return data_->largest_slope; }

double LensRays::reach_px(double least_inverse_depth, double most_inverse_depth) const noexcept {
  const RasterArea& area = data_->table.area;
  double reach = 0;
  // Inside the area, a node's offset reaches beyond the area only by the part that exceeds its distance from the edge.
  each_offset(data_->table, least_inverse_depth, most_inverse_depth, [&](double x, double y, double dx, double dy) {
    reach = std::max({reach, -x - dx, x + dx - area.columns, -y - dy, y + dy - area.rows});
  });
  return reach;
}

double LensRays::offset_px(double least_inverse_depth, double most_inverse_depth) const noexcept {
  double offset = 0;
  each_offset(data_->table, least_inverse_depth, most_inverse_depth, [&](double, double, double dx, double dy) {
    offset = std::max({offset, std::abs(dx), std::abs(dy)});
  });
  return offset;
}

RayTable LensRays::Data::dense(const RasterArea& area, std::size_t channel, std::size_t first, std::size_t end,
                               const std::stop_token& stop) const {
  const core_detail::Kronecker<2> points_of;
  std::vector<PupilPoint> pupil_points;
  for (std::size_t i = first; i < end; ++i) pupil_points.push_back({points_of(i)[0], points_of(i)[1]});
  const auto of_channel = [&](int, const Vec2<double>& raster, std::span<const PupilPoint> points_of_area,
                              std::span<LayerRay> rays) {
    source(static_cast<int>(channel), raster, points_of_area, rays);
  };
  // For the width of a blur, three nodes along a side suffice.
  const int step = std::max(2 * table.step, (std::max(area.columns, area.rows) + 1) / 2);
  return ray_table(area, pupil_points, 1, of_channel, step, 1, stop);
}

void LensRays::at(int channel, int column, int row, std::span<LayerRay> rays) const {
  const RayTable& t = data_->table;
  std::vector<float> found(t.node_size());
  const Vec2<double> raster{column + 0.5, row + 0.5};
  t.at(static_cast<std::size_t>(channel), raster.x, raster.y, found.data());
  const std::size_t first = set_of(column, row, data_->side()) * count();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto number = [&](Row r) { return static_cast<double>(found[r * t.rays + first + i]); };
    rays[i] = {raster + Vec2<double>{number(at_x), number(at_y)}, {number(slope_x), number(slope_y)}, number(weight)};
  }
}

void LensRays::exact_rays_at(int channel, int column, int row, std::span<LayerRay> rays) const {
  const std::size_t first = set_of(column, row, data_->side()) * count();
  data_->source(channel, {column + 0.5, row + 0.5}, std::span(data_->points).subspan(first, rays.size()), rays);
}

}  // namespace petzval
