// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "undistorted_box.hpp"

namespace petzval {
namespace {

using OptionalPosition = std::optional<Vec2<double>>;
using PositionFunction = std::function<OptionalPosition(const Vec2<double>&)>;
using ErrorOf = std::function<double(const Vec2<double>&, const Vec2<double>&)>;

constexpr double widest_cell = 16;  // pixels
constexpr int least_cells = 80;     // along the longer side
constexpr int most_nodes = 6;       // per axis of a polynomial
constexpr float no_source = -1;

/// Lagrange weights of n nodes at 0, 1, 2, ...
std::array<double, most_nodes> weights(int n, double x) noexcept {
  std::array<double, most_nodes> result{};
  for (int i = 0; i < n; ++i) {
    result[i] = 1;
    for (int j = 0; j < n; ++j) {
      if (j != i) result[i] *= (x - j) / (i - j);
    }
  }
  return result;
}

/// Equally spaced nodes over a range of pixels, from edge to edge.
struct NodeAxis {
  double from = 0, step = 1;
  int nodes = most_nodes;

  NodeAxis(double first, int pixels, double cell)
      : from(first), nodes(std::max(most_nodes, static_cast<int>(std::ceil(pixels / cell)) + 1)) {
    step = static_cast<double>(pixels) / (nodes - 1);
  }
  double node(int i) const noexcept { return from + i * step; }
  /// Position in steps.
  double at(double x) const noexcept { return (x - from) / step; }
  int cell(double x) const noexcept { return std::clamp(static_cast<int>(at(x)), 0, nodes - 2); }
};

/// A function of the raster, interpolated in the cells in which interpolation is accurate.
class NodeGrid {
 public:
  /// @param error gives the error if one position is used instead of another; acceptable up to 1
  NodeGrid(const PositionFunction& position_of, const ErrorOf& error, const NodeAxis& x, const NodeAxis& y, int threads)
      : position_of_(position_of),
        x_(x),
        y_(y),
        positions_(static_cast<std::size_t>(x.nodes) * y.nodes),
        cells_(static_cast<std::size_t>(x.nodes - 1) * (y.nodes - 1)) {
    parallel_for(positions_.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const int column = static_cast<int>(i % x_.nodes), row = static_cast<int>(i / x_.nodes);
        positions_[i] = position_of_({x_.node(column), y_.node(row)});
      }
    });
    parallel_for(cells_.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const int column = static_cast<int>(i % (x_.nodes - 1)), row = static_cast<int>(i / (x_.nodes - 1));
        cells_[i] = cell_at(column, row, error);
      }
    });
  }

  OptionalPosition operator()(const Vec2<double>& at) const {
    const Cell& cell = cells_[static_cast<std::size_t>(y_.cell(at.y)) * (x_.nodes - 1) + x_.cell(at.x)];
    if (cell.kind == Cell::dark) return {};
    return cell.kind == Cell::smooth ? interpolated(cell, at) : position_of_(at);
  }

 private:
  struct Cell {
    enum Kind { dark, rough, smooth } kind = dark;
    int nodes = 0, left = 0, top = 0;  ///< smooth: nodes of the polynomials
  };

  Cell cell_at(int column, int row, const ErrorOf& error) const {
    if (known(column, row, 2) == 0) return {};
    if (known(column, row, 1) < 4) return {.kind = Cell::rough};
    const Vec2<double> middle{x_.node(column) + x_.step / 2, y_.node(row) + y_.step / 2};
    const OptionalPosition there = position_of_(middle);
    if (!there) return {.kind = Cell::rough};
    // Try polynomials of many nodes, then of few nodes. The cell is as close to the middle of the nodes as nodes
    // without values allow.
    for (const int nodes : {most_nodes, 4}) {
      const int before = nodes / 2 - 1;
      for (const int left : {column - before, column - before - 1, column - before + 1}) {
        for (const int top : {row - before, row - before - 1, row - before + 1}) {
          const Cell cell{Cell::smooth, nodes, left, top};
          if (all_known(cell) && error(interpolated(cell, middle), *there) <= 1) return cell;
        }
      }
    }
    return {.kind = Cell::rough};
  }
  bool inside(int column, int row) const noexcept {
    return column >= 0 && row >= 0 && column < x_.nodes && row < y_.nodes;
  }
  const OptionalPosition& position(int column, int row) const noexcept {
    return positions_[static_cast<std::size_t>(row) * x_.nodes + column];
  }
  /// Number of nodes with values: among the corners of a cell if reach = 1, also among those of the adjacent cells if
  /// reach = 2.
  int known(int column, int row, int reach) const noexcept {
    int count = 0;
    for (int j = row + 1 - reach; j <= row + reach; ++j) {
      for (int i = column + 1 - reach; i <= column + reach; ++i) count += inside(i, j) && position(i, j);
    }
    return count;
  }
  bool all_known(const Cell& cell) const noexcept {
    for (int j = cell.top; j < cell.top + cell.nodes; ++j) {
      for (int i = cell.left; i < cell.left + cell.nodes; ++i) {
        if (!inside(i, j) || !position(i, j)) return false;
      }
    }
    return true;
  }
  Vec2<double> interpolated(const Cell& cell, const Vec2<double>& at) const noexcept {
    const auto across = weights(cell.nodes, x_.at(at.x) - cell.left),
               down = weights(cell.nodes, y_.at(at.y) - cell.top);
    Vec2<double> sum{0, 0};
    for (int j = 0; j < cell.nodes; ++j) {
      for (int i = 0; i < cell.nodes; ++i) sum += across[i] * down[j] * *position(cell.left + i, cell.top + j);
    }
    return sum;
  }

  const PositionFunction& position_of_;
  NodeAxis x_, y_;
  std::vector<OptionalPosition> positions_;
  std::vector<Cell> cells_;
};

/// The map for the pixels of a film and a margin.
/// @param raster converts an interpolated value to its raster position
StMap map_of(const PositionFunction& position_of, const PositionFunction& raster, const Film& film, int margin_x,
             int margin_y, int threads) {
  StMap map{.width = film.columns + 2 * margin_x,
            .height = film.rows + 2 * margin_y,
            .margin_x = margin_x,
            .margin_y = margin_y};
  const auto pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  map.s.assign(pixels, no_source), map.t.assign(pixels, no_source);
  const double cell = std::min(widest_cell, static_cast<double>(std::max(map.width, map.height)) / least_cells);
  // Tolerance: 0.0005 pixels in the middle of the picture, twice as much in its corners, and more outside.
  const Vec2<double> size{film.columns, film.rows};
  const auto error = [&](const Vec2<double>& a, const Vec2<double>& b) {
    const OptionalPosition at = raster(a), expected = raster(b);
    if (!at || !expected) return HUGE_VAL;
    const double away = 2 * glm::distance(*expected, size / 2.0) / glm::length(size);
    return glm::distance(*at, *expected) / (5e-4 * (1 + away * away));
  };
  const NodeGrid grid(position_of, error, NodeAxis(-margin_x, map.width, cell), NodeAxis(-margin_y, map.height, cell),
                      threads);
  parallel_for(static_cast<std::size_t>(map.height), 8, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      for (int column = 0; column < map.width; ++column) {
        const auto found = grid({column + 0.5 - margin_x, static_cast<double>(row) + 0.5 - margin_y});
        const auto position = found ? raster(*found) : found;
        if (!position) continue;
        const std::size_t i = row * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(column);
        map.s[i] = static_cast<float>(position->x / film.columns);
        map.t[i] = static_cast<float>(1 - position->y / film.rows);
      }
    }
  });
  return map;
}

struct Margin {
  int x = 0, y = 0;
};

Margin margin_of(const LensDistortion& distortion, std::optional<double> overscan) {
  const Film& film = distortion.camera().film();
  const std::string where = distortion.camera().lens().name() + ": ST maps: ";
  const auto either_side = [](double excess) { return static_cast<int>(std::ceil(excess - 1e-6)); };
  if (overscan) {
    const double margin = (*overscan - 1) / 2;
    if (!(margin >= 0 && *overscan <= 10)) {
      throw Error(where + "overscan = " + to_text(*overscan) + "; must be 1 to 10");
    }
    return {either_side(margin * film.columns), either_side(margin * film.rows)};
  }
  const auto box = undistorted_box(distortion);
  if (!box) throw Error(where + "no light reaches the film");
  const auto outside = [&](double least, double most, int pixels) {
    return either_side(std::clamp(std::max(-least, most - pixels), 0.0, pixels / 2.0));
  };
  return {outside(box->least.x, box->largest.x, film.columns), outside(box->least.y, box->largest.y, film.rows)};
}

}  // namespace

bool StMap::has_source(int column, int row) const noexcept {
  if (column < 0 || column >= width || row < 0 || row >= height) return false;
  const std::size_t i =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  if (i >= std::min(s.size(), t.size())) return false;
  return s[i] != no_source || t[i] != no_source;
}

StMaps st_maps(const LensDistortion& distortion, std::optional<double> overscan, int threads) {
  const Film& film = distortion.camera().film();
  const auto [margin_x, margin_y] = margin_of(distortion, overscan);
  const Vec2<double> centre = distortion.centre(), focal_length = distortion.focal_length_px();
  // For a wide field, the pinhole image is not a polynomial of the lens image; the sines of its directions are bounded.
  const auto sines = [&](const Vec2<double>& at) -> OptionalPosition {
    const auto position = distortion.undistorted(at);
    if (!position) return {};
    const Vec2<double> tangent = (*position - centre) / focal_length;
    return tangent / std::sqrt(1 + glm::dot(tangent, tangent));
  };
  const auto from_sines = [&](const Vec2<double>& sine) -> OptionalPosition {
    const double cosine2 = 1 - glm::dot(sine, sine);
    if (!(cosine2 > 0)) return {};
    return centre + focal_length * sine / std::sqrt(cosine2);
  };
  return {map_of([&](const Vec2<double>& at) { return distortion.distorted(at); },
                 [](const Vec2<double>& at) { return OptionalPosition(at); }, film, margin_x, margin_y, threads),
          map_of(sines, from_sines, film, 0, 0, threads)};
}

}  // namespace petzval
