// SPDX-License-Identifier: Apache-2.0
#include "ray_table.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::blur_detail {
namespace {

/// The cell that contains a position along one side, and the position within the cell as a fraction.
struct Cell {
  std::size_t first = 0;
  float fraction = 0;
};

Cell cell_at(double position, int step, std::size_t nodes, int end) {
  const double p = std::clamp(position, 0.0, static_cast<double>(end));
  const std::size_t first = std::min(static_cast<std::size_t>(p / step), nodes - 2);
  const double begin = static_cast<double>(first) * step, length = std::min<double>(step, end - begin);
  return {first, static_cast<float>((p - begin) / length)};
}

/// For each node of a channel: true if a ray has a weight.
std::vector<char> lit_nodes(const RayTable& table, std::size_t channel) {
  std::vector<char> lit(table.node_columns * table.node_rows);
  for (std::size_t n = 0; n < lit.size(); ++n) {
    const float* const weights = table.node(channel, 0, n) + weight * table.rays;
    lit[n] = std::any_of(weights, weights + table.rays, [](float w) { return w > 0; });
  }
  return lit;
}

/// Gives a node without light the mean of the lines extrapolated from adjacent nodes with light: linearly from two
/// nodes in a row, or unchanged from a single node. Returns false, and changes nothing, if there are no such nodes.
bool lead_on(RayTable& table, std::size_t channel, const std::vector<char>& lit, int column, int row, bool two) {
  const int columns = static_cast<int>(table.node_columns), rows = static_cast<int>(table.node_rows);
  const auto is_lit = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < columns && y < rows && lit[static_cast<std::size_t>(y * columns + x)];
  };
  const auto node = [&](int x, int y) {
    return table.node(channel, static_cast<std::size_t>(y), static_cast<std::size_t>(x));
  };
  const auto distance_to = [&](int x, int y, int right, int down) {
    const auto at = [](int n) { return static_cast<std::size_t>(n); };
    return std::hypot(table.column_of(at(x + right)) - table.column_of(at(x)),
                      table.row_of(at(y + down)) - table.row_of(at(y)));
  };
  std::vector<double> sums(weight * table.rays);
  int found = 0;
  for (int d = 0; d < 9; ++d) {
    const int right = d % 3 - 1, down = d / 3 - 1, x = column + right, y = row + down;
    if (!is_lit(x, y) || (two && !is_lit(x + right, y + down))) continue;
    ++found;
    const float *const near = node(x, y), *const far = two ? node(x + right, y + down) : near;
    const double fraction = two ? distance_to(column, row, right, down) / distance_to(x, y, right, down) : 0;
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += near[i] + fraction * (static_cast<double>(near[i]) - far[i]);
  }
  if (found == 0) return false;
  float* const own = table.nodes.data() + (node(column, row) - table.nodes.data());
  for (std::size_t i = 0; i < sums.size(); ++i) own[i] = static_cast<float>(sums[i] / found);
  return true;
}

/// Between a node with light and a node without light, rays fade and do not move: arbitrary lines of the node without
/// light would displace the rays.
void lead_into_the_dark(RayTable& table) {
  for (std::size_t channel = 0; channel < table.channels; ++channel) {
    const std::vector<char> lit = lit_nodes(table, channel);
    for (std::size_t n = 0; n < lit.size(); ++n) {
      if (lit[n]) continue;
      const int column = static_cast<int>(n % table.node_columns), row = static_cast<int>(n / table.node_columns);
      if (!lead_on(table, channel, lit, column, row, true)) lead_on(table, channel, lit, column, row, false);
    }
  }
}

std::size_t nodes_over(int length, int step) { return static_cast<std::size_t>((length + step - 1) / step) + 1; }

}  // namespace

double RayTable::column_of(std::size_t node) const noexcept {
  return area.left + std::min<double>(static_cast<double>(node) * step, area.columns);
}
double RayTable::row_of(std::size_t node) const noexcept {
  return area.top + std::min<double>(static_cast<double>(node) * step, area.rows);
}

void RayTable::at(std::size_t channel, double column, double row, float* found) const noexcept {
  const Cell x = cell_at(column - area.left, step, node_columns, area.columns),
             y = cell_at(row - area.top, step, node_rows, area.rows);
  const float *const a = node(channel, y.first, x.first), *const b = node(channel, y.first, x.first + 1),
                     *const c = node(channel, y.first + 1, x.first), *const d = node(channel, y.first + 1, x.first + 1);
  for (std::size_t i = 0; i < node_size(); ++i) {
    const float upper = a[i] + x.fraction * (b[i] - a[i]), lower = c[i] + x.fraction * (d[i] - c[i]);
    found[i] = upper + y.fraction * (lower - upper);
  }
}

const float* RayTable::rows_at(std::size_t channel, double column, double row, std::vector<float>& scratch) const {
  constexpr std::size_t beyond = 64;
  const Cell x = cell_at(column - area.left, step, node_columns, area.columns),
             y = cell_at(row - area.top, step, node_rows, area.rows);
  const auto whole = [](float fraction) { return fraction == 0 || fraction == 1; };
  if (whole(x.fraction) && whole(y.fraction)) {
    const float* const at =
        node(channel, y.first + static_cast<std::size_t>(y.fraction), x.first + static_cast<std::size_t>(x.fraction));
    if (at + node_size() + beyond <= nodes.data() + nodes.size()) return at;
  }
  scratch.resize(node_size() + beyond);
  this->at(channel, column, row, scratch.data());
  return scratch.data();
}

void RayTable::ray_at(std::size_t channel, std::size_t ray, double column, double row, float* found) const noexcept {
  const Cell x = cell_at(column - area.left, step, node_columns, area.columns),
             y = cell_at(row - area.top, step, node_rows, area.rows);
  const float *const a = node(channel, y.first, x.first) + ray, *const b = node(channel, y.first, x.first + 1) + ray,
                     *const c = node(channel, y.first + 1, x.first) + ray,
                     *const d = node(channel, y.first + 1, x.first + 1) + ray;
  for (std::size_t r = 0; r < row_count; ++r) {
    const std::size_t i = r * rays;
    const float upper = a[i] + x.fraction * (b[i] - a[i]), lower = c[i] + x.fraction * (d[i] - c[i]);
    found[r] = upper + y.fraction * (lower - upper);
  }
}

void keep_on(const std::stop_token& stop, const char* where) {
  if (stop.stop_requested()) throw Cancelled(where);
}

RayTable ray_table(const RasterArea& area, std::span<const PupilPoint> points, std::size_t channels,
                   const LensRays::Source& source, int step, int threads, const std::stop_token& stop) {
  constexpr double max_coordinate = 1e15;  // interpolation in float must not overflow
  RayTable table{.area = area,
                 .step = step,
                 .channels = channels,
                 .rays = points.size(),
                 .node_columns = nodes_over(area.columns, step),
                 .node_rows = nodes_over(area.rows, step),
                 .nodes = {}};
  const std::size_t nodes = table.node_columns * table.node_rows;
  table.nodes.resize(channels * nodes * table.node_size());
  parallel_for(channels * nodes, 8, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<LayerRay> rays(points.size());
    for (std::size_t n = begin; n < end; ++n) {
      keep_on(stop, "lens rays");
      const std::size_t channel = n / nodes, row = n % nodes / table.node_columns, column = n % table.node_columns;
      const Vec2<double> raster{table.column_of(column), table.row_of(row)};
      source(static_cast<int>(channel), raster, points, rays);
      float* const out = table.nodes.data() + n * table.node_size();
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const LayerRay& ray = rays[i];
        const double values[] = {ray.position.x - raster.x, ray.position.y - raster.y, ray.slope.x, ray.slope.y,
                                 ray.weight};
        for (std::size_t r = 0; r < row_count; ++r) {
          out[r * rays.size() + i] = static_cast<float>(values[r]);
          if (std::abs(values[r]) <= max_coordinate && (r != weight || values[r] >= 0)) continue;
          throw Error("lens rays: ray " + std::to_string(i) + " of column " + to_text(raster.x) + ", row " +
                      to_text(raster.y) + (r == weight ? ": weight = " : ": number = ") + to_text(values[r]) +
                      "; must be finite, at most " + to_text(max_coordinate) +
                      " in absolute value, and not negative if a weight");
        }
      }
    }
  });
  lead_into_the_dark(table);
  return table;
}

}  // namespace petzval::blur_detail
