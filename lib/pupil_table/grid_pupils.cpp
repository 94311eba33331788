// SPDX-License-Identifier: Apache-2.0
#include "grid_pupils.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/low_discrepancy.hpp"

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::PupilGuess;
using pupil_detail::SearchOrder;

/// Finds the pupils of points in rows.
class PupilFinder {
 public:
  PupilFinder(const GridOfPoints& grid, std::size_t directions, const pupil_detail::PositionClearances& clearances)
      : guesses_(grid.guesses), row_(grid.row), directions_(directions), clearances_(clearances) {}

  std::vector<PupilRegion> operator()() {
    const auto order =
        row_ == 1 ? SearchOrder::rows(guesses_.size(), 1) : SearchOrder::grid(guesses_.size() / row_, row_);
    std::vector<PupilRegion> pupils = pupil_detail::find_regions(guesses_, order, directions_, false, clearances_);
    // If the chief ray is lost, other rays may pass: search near the pupils of neighbours, or everywhere if no
    // neighbour has a pupil.
    if (std::all_of(pupils.begin(), pupils.end(), [](const PupilRegion& p) { return p.empty(); })) {
      std::vector<std::uint32_t> ends;
      for (std::size_t i = 0; i < guesses_.size(); ++i) {
        if (i % row_ == 0 || i % row_ == row_ - 1) ends.push_back(static_cast<std::uint32_t>(i));
      }
      std::vector<Box> boxes;
      for (const std::uint32_t i : ends) {
        const PupilGuess& g = guesses_[i];
        const double half = (g.high - g.low) / 2;
        boxes.push_back({g.x, g.low + half, half, half});
      }
      look_again(pupils, ends, boxes, 64);
    }
    std::vector<bool> looked(guesses_.size(), false);
    for (bool found = true; found;) {
      std::vector<std::uint32_t> dark;
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < guesses_.size(); ++i) {
        if (looked[i] || !pupils[i].empty()) continue;
        const auto neighbour_box = lit_neighbour(pupils, i);
        if (!neighbour_box) continue;
        looked[i] = true;
        dark.push_back(static_cast<std::uint32_t>(i));
        boxes.push_back(*neighbour_box);
      }
      found = look_again(pupils, dark, boxes, 24);
    }
    return pupils;
  }

 private:
  struct Box {
    double x, y, half_x, half_y;
  };

  /// The search box: centred at the extrapolated pupil of a neighbour, and of the size of this pupil.
  std::optional<Box> lit_neighbour(const std::vector<PupilRegion>& pupils, std::size_t i) const {
    const std::size_t column = i % row_;
    const auto lit = [&](std::size_t at) { return at < pupils.size() && !pupils[at].empty(); };
    const auto neighbour_box = [&](std::size_t near, std::size_t far, bool has_far) {
      const PupilRegion& p = pupils[near];
      Vec2<double> middle = p.middle;
      if (has_far && lit(far)) middle = middle + (p.middle - pupils[far].middle);
      constexpr double box_scale = 1.6;
      return Box{middle.x, middle.y, box_scale * p.half_axes.x, box_scale * p.half_axes.y};
    };
    if (column > 0 && lit(i - 1)) return neighbour_box(i - 1, i - 2, column > 1);
    if (i >= row_ && lit(i - row_)) return neighbour_box(i - row_, i - 2 * row_, i >= 2 * row_);
    if (column + 1 < row_ && lit(i + 1)) return neighbour_box(i + 1, i + 2, column + 2 < row_);
    if (lit(i + row_)) return neighbour_box(i + row_, i + 2 * row_, true);
    return {};
  }

  /// Tests positions in the whole search boxes of some points, and finds the pupils of points for which a ray passes.
  bool look_again(std::vector<PupilRegion>& pupils, const std::vector<std::uint32_t>& which,
                  const std::vector<Box>& boxes, int side) {
    std::vector<std::uint32_t> points;
    std::vector<double> x, y;
    for (std::size_t j = 0; j < which.size(); ++j) {
      for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
          points.push_back(which[j]);
          x.push_back(boxes[j].x + boxes[j].half_x * ((2 * column + 1.0) / side - 1));
          y.push_back(boxes[j].y + boxes[j].half_y * ((2 * row + 1.0) / side - 1));
        }
      }
    }
    std::vector<double> values(x.size());
    if (!x.empty()) clearances_(x.size(), points.data(), x.data(), y.data(), values.data());
    std::vector<std::uint32_t> lit;
    std::vector<PupilGuess> guesses;
    for (std::size_t j = 0; j < which.size(); ++j) {
      const std::size_t begin = j * static_cast<std::size_t>(side * side), end = begin + side * side;
      double sum_x = 0, sum_y = 0;
      int count = 0;
      for (std::size_t i = begin; i < end; ++i) {
        if (values[i] >= 0) sum_x += x[i], sum_y += y[i], ++count;
      }
      if (count == 0) continue;
      // Take the passing position nearest to the mean of all passing positions.
      std::size_t best = end;
      const auto away = [&](std::size_t i) { return std::hypot(x[i] - sum_x / count, y[i] - sum_y / count); };
      for (std::size_t i = begin; i < end; ++i) {
        if (values[i] >= 0 && (best == end || away(i) < away(best))) best = i;
      }
      PupilGuess guess = guesses_[which[j]];
      guess.x = x[best], guess.y = y[best];
      guess.radius = std::max(boxes[j].half_x, boxes[j].half_y);
      guess.near = 2 * boxes[j].half_y;
      lit.push_back(which[j]);
      guesses.push_back(guess);
    }
    if (lit.empty()) return false;
    const pupil_detail::PositionClearances of_lit = [&](std::size_t count, const std::uint32_t* index, const double* px,
                                                        const double* py, double* found_clearances) {
      points.resize(count);
      for (std::size_t i = 0; i < count; ++i) points[i] = lit[index[i]];
      clearances_(count, points.data(), px, py, found_clearances);
    };
    const auto found =
        pupil_detail::find_regions(guesses, SearchOrder::rows(guesses.size(), 1), directions_, false, of_lit);
    for (std::size_t i = 0; i < lit.size(); ++i) pupils[lit[i]] = found[i];
    return true;
  }

  std::span<const PupilGuess> guesses_;
  std::size_t row_, directions_;
  const pupil_detail::PositionClearances& clearances_;
};

/// Mirror image of corner k at x = 0.
std::size_t across_x(std::size_t k) noexcept { return (polygon_corners - k) % polygon_corners; }
/// Mirror image of corner k at y = 0.
std::size_t across_y(std::size_t k) noexcept { return (polygon_corners / 2 + polygon_corners - k) % polygon_corners; }

}  // namespace

std::vector<PupilRegion> grid_pupils(const GridOfPoints& grid, std::size_t directions,
                                     const pupil_detail::PositionClearances& clearances) {
  return PupilFinder(grid, directions, clearances)();
}

std::vector<PupilPolygon> node_polygons(std::span<const PupilRegion> pupils, std::size_t columns, PolygonFit fit) {
  const std::size_t rows = pupils.size() / columns, nodes = columns / 2 + 1;
  std::vector<PupilPolygon> polygons((rows / 2 + 1) * nodes);
  std::vector<std::size_t> known, unknown;
  const auto node = [&](std::size_t i, std::size_t j) { return i * nodes + j; };
  for (std::size_t i = 0; i < rows; i += 2) {
    for (std::size_t j = 0; j < columns; j += 2) {
      // If the pupil of a node is empty, the node takes the pupil of a neighbouring point that has one.
      const PupilRegion* lit = nullptr;
      for (const auto& [up, right] :
           {std::pair{0, 0}, {0, -1}, {-1, 0}, {-1, -1}, {0, 1}, {1, 0}, {-1, 1}, {1, -1}, {1, 1}}) {
        const std::size_t row = i + static_cast<std::size_t>(up), column = j + static_cast<std::size_t>(right);
        if (row >= rows || column >= columns || pupils[row * columns + column].empty()) continue;
        lit = &pupils[row * columns + column];
        break;
      }
      (lit ? known : unknown).push_back(node(i / 2, j / 2));
      if (!lit) continue;
      PupilPolygon& polygon = polygons[node(i / 2, j / 2)];
      polygon = polygon_of(*lit, fit, CornerSteps::even_in_halves);
      const double area = polygon.area();
      polygon.obscured.fill(0), polygon.obscured_from.fill(0);
      if (fit == PolygonFit::enclosing) continue;
      const double scale = lit == &pupils[i * columns + j] && area > 0 ? std::sqrt(area / polygon.area()) : 0;
      for (auto& corner : polygon.corners) corner *= scale;
    }
  }
  // Nodes farther away take the polygon of the nearest node with a pupil.
  for (const std::size_t dark : unknown) {
    const auto away = [&](std::size_t k) {
      const auto step = [](std::size_t a, std::size_t b) { return a < b ? b - a : a - b; };
      const std::size_t i = step(k / nodes, dark / nodes), j = step(k % nodes, dark % nodes);
      return i * i + j * j;
    };
    const auto nearest =
        std::min_element(known.begin(), known.end(), [&](auto a, auto b) { return away(a) < away(b); });
    if (nearest == known.end()) break;
    polygons[dark] = polygons[*nearest];
    if (fit == PolygonFit::equal_area) polygons[dark].corners = {};
  }
  return polygons;
}

void mirror(PupilPolygon& polygon, bool x) noexcept {
  polygon.middle[x ? 0 : 1] = 0;
  const PupilPolygon own = polygon;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const Vec2<double>&here = own.corners[k], &there = own.corners[x ? across_x(k) : across_y(k)];
    const Vec2<double> mirrored{x ? -there.x : there.x, x ? there.y : -there.y};
    const double in = here.x * here.x + here.y * here.y, out = mirrored.x * mirrored.x + mirrored.y * mirrored.y;
    if (out > in) polygon.corners[k] = mirrored;
  }
}

PupilPolygon hull(const std::vector<PupilPolygon>& polygons) {
  std::vector<Point<double>> positions;
  for (const PupilPolygon& polygon : polygons) {
    if (!(polygon.area() > 0)) continue;
    for (const auto& corner : polygon.corners) {
      positions.push_back({polygon.middle.x + corner.x, polygon.middle.y + corner.y});
    }
  }
  if (positions.empty()) return {};
  // Convex hull, starting at the lowest x: upper side, then lower side.
  std::sort(positions.begin(), positions.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  std::vector<Point<double>> edge;
  const auto go = [&](auto begin, auto end) {
    const std::size_t first = edge.size();
    for (auto p = begin; p != end; ++p) {
      while (edge.size() > first + 1 && turn(edge.back() - edge[edge.size() - 2], *p - edge.back()) <= 0)
        edge.pop_back();
      edge.push_back(*p);
    }
    edge.pop_back();
  };
  go(positions.begin(), positions.end());
  go(positions.rbegin(), positions.rend());
  PupilRegion region{.directions = 128};
  const auto [left, right] = std::minmax_element(edge.begin(), edge.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [low, high] = std::minmax_element(edge.begin(), edge.end(), [](auto& a, auto& b) { return a.y < b.y; });
  region.middle = {(left->x + right->x) / 2, (low->y + high->y) / 2};
  region.half_axes = {(right->x - left->x) / 2, (high->y - low->y) / 2};
  const Point<double> middle{region.middle.x, region.middle.y};
  for (std::size_t k = 0; k < region.directions; ++k) {
    const Vec2<double> unit = region.unit(k) * region.half_axes;
    const Point<double> ray{unit.x, unit.y};
    for (std::size_t i = 0; i < edge.size(); ++i) {
      const Point<double> a = edge[i] - middle, b = edge[(i + 1) % edge.size()] - middle;
      if (!(turn(a, ray) >= 0 && turn(ray, b) > 0)) continue;
      const double radius = turn(a, b) / (turn(a, ray) + turn(ray, b));
      const Vec2<double> rim = region.at(k, radius);
      region.spans.push_back({k, 0, radius, {region.middle.x, region.middle.y}, {rim.x, rim.y}});
      break;
    }
  }
  PupilPolygon polygon = polygon_of(region, PolygonFit::enclosing, CornerSteps::even_in_halves);
  // Include the corners of the hull that lie between two directions.
  double relative = 1;
  for (const auto& p : edge) relative = std::max(relative, polygon.relative_radius(p.x, p.y));
  polygon.widen(relative);
  return polygon;
}

void expand_to_probes(std::span<PupilPolygon> polygons, std::size_t probes, const ProbeWeights& weights,
                      const ProbeClearances& clearances) {
  constexpr int rounds = 4;
  const core_detail::Kronecker<4> uniform;
  // In batches of 1024, to reuse buffers.
  constexpr std::size_t batch_size = 1024;
  std::vector<double> x, y, values;
  std::vector<std::uint32_t> open;
  std::vector<std::uint32_t> sectors(batch_size);
  std::vector<PolygonWeights> at(batch_size);
  std::vector<std::array<double, 4>> positions(batch_size);
  std::vector<Point<double>> middles(batch_size), edges(batch_size);  // edges: relative to the middle
  std::vector<double> scales(batch_size);
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::array<double, polygon_corners>> larger(polygons.size());
    for (auto& scale : larger) scale.fill(1);
    bool any = false;
    for (std::size_t begin = 0; begin < probes; begin += batch_size) {
      const std::size_t count = std::min(batch_size, probes - begin);
      for (std::size_t p = 0; p < count; ++p) {
        positions[p] = uniform(static_cast<std::size_t>(round) * probes + begin + p);
        at[p] = weights(positions[p]);
        const double along = positions[p][3] * polygon_corners;
        const std::size_t k = std::min(static_cast<std::size_t>(along), polygon_corners - 1);
        sectors[p] = static_cast<std::uint32_t>(k);
        middles[p] = edges[p] = {};
        for (std::size_t j = 0; j < at[p].polygons.size(); ++j) {
          if (at[p].weights[j] == 0) continue;
          const PupilPolygon& polygon = polygons[at[p].polygons[j]];
          middles[p] = middles[p] + at[p].weights[j] * Point<double>{polygon.middle.x, polygon.middle.y};
          edges[p] = edges[p] + at[p].weights[j] * polygon.sector(k).at(1, along - static_cast<double>(k));
        }
      }
      // Step outwards while probes still pass.
      std::fill(scales.begin(), scales.end(), 1);
      open.resize(count);
      std::iota(open.begin(), open.end(), 0u);
      for (const double relative : {1.00001, 1.002, 1.006, 1.015, 1.04, 1.1, 1.25, 1.6}) {
        if (open.empty()) break;
        x.clear(), y.clear();
        for (const std::uint32_t p : open) {
          x.push_back(middles[p].x + relative * edges[p].x);
          y.push_back(middles[p].y + relative * edges[p].y);
        }
        values.resize(open.size());
        clearances(positions, open, x.data(), y.data(), values.data());
        std::size_t left = 0;
        for (std::size_t i = 0; i < open.size(); ++i) {
          if (!(values[i] >= 0)) continue;
          constexpr double overshoot_factor = 1.5, min_expansion = 0.002;
          scales[open[i]] = 1 + overshoot_factor * (relative - 1) + min_expansion;
          open[left++] = open[i];
        }
        open.resize(left);
      }
      for (std::size_t p = 0; p < count; ++p) {
        if (scales[p] == 1) continue;
        any = true;
        for (std::size_t j = 0; j < at[p].polygons.size(); ++j) {
          if (at[p].weights[j] == 0) continue;
          for (const std::size_t corner : {std::size_t{sectors[p]}, (sectors[p] + 1) % polygon_corners}) {
            double& scale = larger[at[p].polygons[j]][corner];
            scale = std::max(scale, scales[p]);
          }
        }
      }
    }
    if (!any) return;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      for (std::size_t k = 0; k < polygon_corners; ++k) polygons[p].corners[k] *= larger[p][k];
    }
  }
}

}  // namespace petzval::pupil_table_detail
