// SPDX-License-Identifier: Apache-2.0
#include "pupil_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/low_discrepancy.hpp"

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::PositionClearances;
using pupil_detail::PupilGuess;
using pupil_detail::SearchOrder;

/// Makes the corners symmetric about x = 0 (i = 0) or y = 0 (i = 1); each pair of corners takes the position of its
/// outer corner.
void mirror(PupilPolygon& polygon, int i) noexcept {
  polygon.middle[i] = 0;
  const PupilPolygon own = polygon;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const std::size_t opposite = ((i == 0 ? 2 : 1) * (polygon_corners / 2) - k + polygon_corners) % polygon_corners;
    Vec2<double> mirrored = own.corners[opposite];
    mirrored[i] = -mirrored[i];
    if (glm::dot(mirrored, mirrored) > glm::dot(own.corners[k], own.corners[k])) polygon.corners[k] = mirrored;
  }
}

void mirror_at_axes(std::span<PupilPolygon> polygons, const PupilChart& chart) noexcept {
  for (std::size_t n = 0; n < polygons.size(); ++n) {
    const ChartPoint at = chart.nodes.point(n);
    if (!chart.quadrant || at[2] == 0) mirror(polygons[n], 0);
    if (chart.quadrant && at[1] == 0) mirror(polygons[n], 1);
  }
}

/// Finds the pupils of a grid of points near the pupils of neighbours. A lost pupil is searched near the pupils of all
/// neighbours, or in the whole plane if no pupil has been found.
class PupilFinder {
 public:
  /// @param row points per row
  PupilFinder(std::span<const PupilGuess> guesses, std::size_t row, std::size_t directions,
              const PositionClearances& clearances)
      : guesses_(guesses), row_(row), directions_(directions), clearances_(clearances) {}

  std::vector<PupilRegion> operator()() {
    std::vector<PupilRegion> pupils = pupil_detail::find_regions(
        guesses_, SearchOrder::grid(guesses_.size() / row_, row_), directions_, false, clearances_);
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
    const PositionClearances of_lit = [&](std::size_t count, const std::uint32_t* index, const double* px,
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
  const PositionClearances& clearances_;
};

/// The pupils of a layer of points.
std::vector<PupilRegion> pupils_at(const PupilChart& chart, PupilChart::Points points) {
  const auto guesses = chart.guesses(points);
  const auto clearances = chart.clearances(points);
  if (chart.quadrant) return PupilFinder(guesses, chart.points.row(), chart.directions, clearances)();
  std::optional<pupil_detail::ConnectedPupils> connected;
  if (chart.connected) connected = chart.connected(points);
  const auto order = SearchOrder::rows(points.size(), points.size());
  return pupil_detail::find_regions(guesses, order, chart.directions, true, clearances,
                                    connected ? &*connected : nullptr);
}

/// The pupil from which the polygon of a node is made.
struct ShownPupil {
  const PupilRegion* pupil = nullptr;  ///< null if no point of the adjacent cells is lit
  bool own = false;                    ///< true if this is the pupil of the node itself
};

/// Selects the pupil of the node itself, or else the largest pupil of the adjacent cells: the others end in these
/// cells, and slivers are not of the shape that the polygon must have.
ShownPupil shown_pupil(const PupilChart& chart, PupilChart::Points points, const std::vector<PupilRegion>& pupils,
                       std::size_t node) {
  const ChartPoint at = chart.nodes.point(node);
  // True if a point is at most so many steps of its rows and columns, and of its layers, away.
  const auto near = [&](std::size_t p, double steps, double layers) {
    const auto within = [&](std::size_t k, double most) {
      return std::abs(points[p][k] - at[k]) * static_cast<double>(chart.points.steps[k]) < most;
    };
    return within(2, steps) && within(1, steps) && within(0, layers);
  };
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    if (!pupils[p].empty() && near(p, 0.5, 0.5)) return {&pupils[p], true};
  }
  ShownPupil shown;
  double largest = 0;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    if (pupils[p].empty() || !near(p, 2.5, std::numeric_limits<double>::infinity())) continue;
    if (const double area = pupils[p].area(); area > largest) largest = area, shown.pupil = &pupils[p];
  }
  return shown;
}

PupilPolygon polygon_at_node(const PupilChart& chart, const ShownPupil& shown, PolygonFit fit) {
  PupilPolygon polygon = polygon_of(*shown.pupil, fit);
  const double area = polygon.area();
  if (chart.quadrant) polygon.obscured.fill(0), polygon.obscured_from.fill(0);
  if (fit == PolygonFit::enclosing) return polygon;
  const double scale = shown.own && area > 0 ? std::sqrt(area / polygon.area()) : 0;
  for (auto& corner : polygon.corners) corner *= scale;
  return polygon;
}

/// Tests positions just outside the interpolated polygons of points in all parts of a chart, and expands the polygons
/// if a ray passes there.
void expand_to_probes(std::span<PupilPolygon> polygons, const PupilChart& chart) {
  // Per round, two probes for each sector of each cell.
  std::size_t probes = 2 * polygon_corners;
  for (const std::size_t steps : chart.nodes.steps) probes *= std::max<std::size_t>(steps, 1);
  constexpr int rounds = 2;
  const core_detail::Kronecker<4> uniform;
  constexpr std::size_t batch_size = 1024;
  std::vector<ChartPoint> points;
  std::vector<double> x, y, values;
  std::vector<std::uint32_t> open, which(batch_size);
  std::iota(which.begin(), which.end(), 0u);
  struct Probe {
    ChartPoint point;
    PolygonWeights at;
    std::size_t sector;
    Point<double> middle{}, edge{};  // edge: relative to the middle
    double scale = 1;
  };
  std::vector<Probe> batch;
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::array<double, polygon_corners>> larger(polygons.size());
    for (auto& scale : larger) scale.fill(1);
    bool any = false;
    for (std::size_t begin = 0; begin < probes; begin += batch_size) {
      batch.clear(), open.clear();
      for (std::size_t p = begin; p < std::min(begin + batch_size, probes); ++p) {
        const auto [a, b, c, turn] = uniform(static_cast<std::size_t>(round) * probes + p);
        const double along = turn * polygon_corners;
        const std::size_t k = std::min(static_cast<std::size_t>(along), polygon_corners - 1);
        Probe probe{{a, b, c}, chart.nodes.weights({a, b, c}), k};
        const PolygonBetween polygon{polygons, probe.at};
        probe.middle = polygon.middle(), probe.edge = polygon.sector(k).at(1, along - static_cast<double>(k));
        open.push_back(static_cast<std::uint32_t>(batch.size()));
        batch.push_back(probe);
      }
      // Step outwards while probes still pass.
      for (const double relative : {1.00001, 1.002, 1.006, 1.015, 1.04, 1.1, 1.25, 1.6}) {
        if (open.empty()) break;
        points.clear(), x.clear(), y.clear();
        for (const std::uint32_t p : open) {
          const Point<double> position = batch[p].middle + relative * batch[p].edge;
          points.push_back(batch[p].point), x.push_back(position.x), y.push_back(position.y);
        }
        values.resize(open.size());
        chart.clearances(points)(open.size(), which.data(), x.data(), y.data(), values.data());
        std::size_t left = 0;
        for (std::size_t i = 0; i < open.size(); ++i) {
          if (!(values[i] >= 0)) continue;
          constexpr double overshoot_factor = 1.5, min_expansion = 0.002;
          batch[open[i]].scale = 1 + overshoot_factor * (relative - 1) + min_expansion;
          open[left++] = open[i];
        }
        open.resize(left);
      }
      for (const Probe& probe : batch) {
        if (probe.scale == 1) continue;
        any = true;
        for (std::size_t j = 0; j < probe.at.polygons.size(); ++j) {
          if (probe.at.weights[j] == 0) continue;
          for (const std::size_t corner : {probe.sector, (probe.sector + 1) % polygon_corners}) {
            double& scale = larger[probe.at.polygons[j]][corner];
            scale = std::max(scale, probe.scale);
          }
        }
      }
    }
    if (!any) return;
    for (std::size_t p = 0; p < polygons.size(); ++p) polygons[p].stretch(larger[p]);
  }
}

}  // namespace

ChartPoint Lattice::point(std::size_t index) const noexcept {
  const auto fraction = [](std::size_t i, std::size_t count) {
    return count > 0 ? static_cast<double>(i) / static_cast<double>(count) : 0.5;
  };
  return {fraction(index / layer(), steps[0]), fraction(index % layer() / row(), steps[1]),
          fraction(index % row(), steps[2])};
}

PolygonWeights Lattice::weights(const ChartPoint& at) const noexcept {
  const std::array<std::size_t, 3> stride{layer(), row(), 1};
  PolygonWeights result;
  result.weights.fill(1);
  for (std::size_t k = 0; k < 3; ++k) {
    const double position = at[k] * static_cast<double>(steps[k]);
    const std::size_t cell = std::min(static_cast<std::size_t>(position), std::max<std::size_t>(steps[k], 1) - 1);
    const double t = position - static_cast<double>(cell);
    for (std::size_t j = 0; j < result.weights.size(); ++j) {
      const bool next = (j >> (2 - k) & 1) != 0;
      result.polygons[j] += stride[k] * (next && steps[k] > 0 ? cell + 1 : cell);
      result.weights[j] *= next ? t : 1 - t;
    }
  }
  return result;
}

Point<double> PolygonBetween::middle() const noexcept {
  Point<double> sum;
  for (std::size_t j = 0; j < at.polygons.size(); ++j) {
    const Vec2<double> middle = at.weights[j] * polygons[at.polygons[j]].middle;
    sum = sum + Point<double>{middle.x, middle.y};
  }
  return sum;
}

Sector<double> PolygonBetween::sector(std::size_t k) const noexcept {
  Sector<double> sum{{}, {}, 0, 0};
  for (std::size_t j = 0; j < at.polygons.size(); ++j) {
    const double weight = at.weights[j];
    if (weight == 0) continue;
    const Sector<double> own = polygons[at.polygons[j]].sector(k);
    sum.a = sum.a + weight * own.a, sum.b = sum.b + weight * own.b;
    sum.obscured_from += weight * own.obscured_from, sum.obscured += weight * own.obscured;
  }
  return sum;
}

double PolygonBetween::relative_radius(const Vec2<double>& position) const noexcept {
  const Point<double> q = Point<double>{position.x, position.y} - middle();
  // Corners are nearly equally spaced in the direction.
  constexpr std::size_t tolerance = 6;
  const double turn = std::atan2(q.x, q.y) / (2 * std::numbers::pi);
  const auto first = static_cast<std::size_t>((turn + 1) * polygon_corners) - tolerance;
  const auto sectors = [this](std::size_t k) { return sector(k); };
  const std::size_t k = sector_facing(q, sectors, first);
  if (k == polygon_corners) return std::numeric_limits<double>::infinity();
  const Sector<double> facing = sector(k);
  const double relative = facing.relative_radius(q);
  return facing.obscures(relative * relative) ? -1 : relative;
}

std::vector<bool> lit_in_plane(std::span<const PupilGuess> guesses, const PositionClearances& clearances) {
  constexpr std::size_t directions = 32;
  std::vector<bool> lit;
  for (const PupilRegion& pupil : PupilFinder(guesses, 1, directions, clearances)()) lit.push_back(!pupil.empty());
  return lit;
}

std::vector<PupilPolygon> node_polygons(const PupilChart& chart, PolygonFit fit) {
  std::vector<ChartPoint> points;
  for (std::size_t p = 0; p < chart.points.size(); ++p) points.push_back(chart.points.point(p));
  std::vector<PupilRegion> pupils;
  const std::size_t layer = chart.points.layer();
  for (std::size_t begin = 0; begin < points.size(); begin += layer) {
    auto found = pupils_at(chart, PupilChart::Points(points).subspan(begin, layer));
    std::move(found.begin(), found.end(), std::back_inserter(pupils));
  }
  std::vector<PupilPolygon> polygons(chart.nodes.size());
  std::vector<bool> covered(pupils.size(), false);
  for (std::size_t n = 0; n < polygons.size(); ++n) {
    const ShownPupil shown = shown_pupil(chart, points, pupils, n);
    if (!shown.pupil) continue;
    polygons[n] = polygon_at_node(chart, shown, fit);
    if (shown.own) covered[static_cast<std::size_t>(shown.pupil - pupils.data())] = true;
  }
  mirror_at_axes(polygons, chart);
  if (fit == PolygonFit::equal_area) return polygons;
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    if (!covered[p]) checks.push_back({&pupils[p], chart.nodes.weights(points[p])});
  }
  expand_to_cover(polygons, checks);
  if (chart.probed) expand_to_probes(polygons, chart);
  mirror_at_axes(polygons, chart);
  return polygons;
}

}  // namespace petzval::pupil_table_detail
