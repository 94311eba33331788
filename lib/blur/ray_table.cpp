// SPDX-License-Identifier: Apache-2.0
#include "ray_table.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::inline v0::blur_detail {
namespace {

/// The cell that holds a position along one side, and the part of the way through it.
struct Cell {
  std::size_t first = 0;
  float part = 0;
};

Cell cell_at(double position, int step, std::size_t nodes, int end) {
  const double p = std::clamp(position, 0.0, static_cast<double>(end));
  const std::size_t first = std::min(static_cast<std::size_t>(p / step), nodes - 2);
  const double begin = static_cast<double>(first) * step, length = std::min<double>(step, end - begin);
  return {first, static_cast<float>((p - begin) / length)};
}

std::size_t nodes_over(int length, int step) { return static_cast<std::size_t>((length + step - 1) / step) + 1; }

}  // namespace

double RayTable::column_of(std::size_t node) const noexcept {
  return std::min<double>(static_cast<double>(node) * step, columns);
}
double RayTable::row_of(std::size_t node) const noexcept {
  return std::min<double>(static_cast<double>(node) * step, rows);
}

void RayTable::at(std::size_t channel, double column, double row, float* found) const noexcept {
  const Cell x = cell_at(column, step, node_columns, columns), y = cell_at(row, step, node_rows, rows);
  const float *const a = node(channel, y.first, x.first), *const b = node(channel, y.first, x.first + 1),
                     *const c = node(channel, y.first + 1, x.first), *const d = node(channel, y.first + 1, x.first + 1);
  for (std::size_t i = 0; i < node_size(); ++i) {
    const float upper = a[i] + x.part * (b[i] - a[i]), lower = c[i] + x.part * (d[i] - c[i]);
    found[i] = upper + y.part * (lower - upper);
  }
}

void RayTable::ray_at(std::size_t channel, std::size_t ray, double column, double row, float* found) const noexcept {
  const Cell x = cell_at(column, step, node_columns, columns), y = cell_at(row, step, node_rows, rows);
  const float *const a = node(channel, y.first, x.first) + ray, *const b = node(channel, y.first, x.first + 1) + ray,
                     *const c = node(channel, y.first + 1, x.first) + ray,
                     *const d = node(channel, y.first + 1, x.first + 1) + ray;
  for (std::size_t r = 0; r < row_count; ++r) {
    const std::size_t i = r * rays;
    const float upper = a[i] + x.part * (b[i] - a[i]), lower = c[i] + x.part * (d[i] - c[i]);
    found[r] = upper + y.part * (lower - upper);
  }
}

RayTable ray_table(const LayerCamera& camera, std::span<const PupilPoint> points, std::size_t channels,
                   const LensRays::Source& source, int step, int threads) {
  constexpr double most = 1e15;  // far within floats, between which lines are interpolated
  RayTable table{.columns = camera.columns,
                 .rows = camera.rows,
                 .step = step,
                 .channels = channels,
                 .rays = points.size(),
                 .node_columns = nodes_over(camera.columns, step),
                 .node_rows = nodes_over(camera.rows, step),
                 .nodes = {}};
  const std::size_t nodes = table.node_columns * table.node_rows;
  table.nodes.resize(channels * nodes * table.node_size());
  parallel_for(channels * nodes, 8, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<LayerRay> rays(points.size());
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t channel = n / nodes, row = n % nodes / table.node_columns, column = n % table.node_columns;
      const Vec2<double> place{table.column_of(column), table.row_of(row)};
      source(static_cast<int>(channel), place, points, rays);
      float* const out = table.nodes.data() + n * table.node_size();
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const LayerRay& ray = rays[i];
        const double values[] = {ray.at.x - place.x, ray.at.y - place.y, ray.slope.x, ray.slope.y, ray.weight};
        for (std::size_t r = 0; r < row_count; ++r) {
          out[r * rays.size() + i] = static_cast<float>(values[r]);
          if (std::abs(values[r]) <= most && (r != weight || values[r] >= 0)) continue;
          throw Error("lens rays: ray " + std::to_string(i) + " of column " + to_text(place.x) + ", row " +
                      to_text(place.y) + (r == weight ? " has the weight " : " has the number ") + to_text(values[r]) +
                      ", wanted a finite one up to " + to_text(most) + ", and no negative weight");
        }
      }
    }
  });
  return table;
}

}  // namespace petzval::inline v0::blur_detail
