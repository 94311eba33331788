// SPDX-License-Identifier: Apache-2.0
#include "pupil_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pupil/pupil_region.hpp"
#include "pupil_grid.hpp"

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::Extent;
using Position = Point<double>;  // in the plane, relative to a middle

Position position_of(const Vec2<double>& p) noexcept { return {p[0], p[1]}; }

/// The outer edge of a region: a closed line around its middle, starting at +y. For each of its points, the ends of the
/// obscuration are given as fractions of the distance from the middle.
struct Edge {
  std::vector<Position> points;
  std::vector<double> obscured_from, obscured_to;
  double area = 0;  // inside the outer edge
};

/// Intersection of the extended chords before and after the chord from b to c: between b and c the boundary of a convex
/// region stays inside. Returns b if there is no such intersection.
Position apex(const Position& a, const Position& b, const Position& c, const Position& d) noexcept {
  const Position u = b - a, v = c - d, w = c - b;
  const double determinant = turn(u, v);
  const double size = std::sqrt((u.x * u.x + u.y * u.y) * (v.x * v.x + v.y * v.y));
  if (!(std::abs(determinant) > 1e-9 * size)) return b;
  const double s = turn(w, v) / determinant, t = turn(w, u) / determinant;
  constexpr double farthest = 4;  // chord lengths
  const bool between = s > 0 && s <= farthest && t > 0 && t <= farthest;
  return between ? b + s * u : b;
}

/// Intersection of the chord from a to b with the line from the middle towards +y.
Position crossing(const Position& a, const Position& b) noexcept {
  const double across = b.x - a.x, t = across > 0 ? std::clamp(-a.x / across, 0.0, 1.0) : 0;
  return a + t * (b - a);
}

Edge edge_of(const PupilRegion& region, PolygonFit fit) {
  const bool enclosing = fit == PolygonFit::enclosing;
  const std::size_t n = region.directions;
  const std::vector<Extent> found = pupil_detail::extents(region);
  std::vector<Extent> extents = found;
  std::vector<Position> p(n);
  for (std::size_t k = 0; k < n; ++k) {
    if (found[k].lit) p[k] = {found[k].rim.x - region.middle[0], found[k].rim.y - region.middle[1]};
  }
  // Between a direction with passing rays and an empty direction, the region may have a tip.
  for (std::size_t k = 0; enclosing && k < n; ++k) {
    if (found[k].lit) continue;
    for (const std::size_t adjacent : {(k + 1) % n, (k + n - 1) % n}) {
      if (found[adjacent].to > extents[k].to) extents[k] = found[adjacent];
    }
    p[k] = position_of(region.at(k, extents[k].to)) - position_of(region.middle);
  }
  Edge edge;
  for (auto* values : {&edge.obscured_from, &edge.obscured_to}) values->reserve(2 * n + 1);
  edge.points.reserve(2 * n + 1);
  const auto add = [&](const Position& point, std::size_t k) {
    const auto& [from, to, outer, rim, lit] = extents[k];
    edge.points.push_back(point);
    edge.obscured_from.push_back(outer > 0 ? from / outer : 0);
    edge.obscured_to.push_back(outer > 0 ? to / outer : 1);
  };
  // The first direction is half a step after +y.
  const Position &last = p[n - 1], &first = p[0];
  add(crossing(last, first), n - 1);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    add(p[k], k);
    edge.area += turn(p[k], p[next]) / 2;
    const Position tip = apex(p[(k + n - 1) % n], p[k], p[next], p[(k + 2) % n]);
    if (tip.x == p[k].x && tip.y == p[k].y) continue;
    // A smooth arc exceeds the chord by a third of the area of the triangle with the tip: tangents would meet at half
    // its height, and the arc fills two thirds of that triangle.
    edge.area += (turn(p[k], tip) + turn(tip, p[next]) - turn(p[k], p[next])) / 6;
    if (!(enclosing && turn(p[k], tip) > 0 && turn(tip, p[next]) > 0)) continue;
    if (next > 0) {
      add(tip, k);
    } else {
      edge.points.front() = tip;
    }
  }
  return edge;
}

/// Scale of the corners at which a sector just contains a position that it faces.
double scale_for(const Sector<double>& sector, const Position& q) noexcept {
  return turn(sector.a, sector.b) > 0 ? sector.relative_radius(q) : 1;
}

/// The obscuration common to all directions of a sector, as an interval of squared radial fractions.
struct Obscured {
  double from = 0, to = 1;

  /// Intersects with the obscuration between two points that the sector faces, narrowed by a margin. If this
  /// obscuration is smaller than `expected`, the obscuration of the neighbours, it is narrowed by the difference once
  /// more.
  /// @param dark true if the obscuration starts at the middle
  void keep(const Sector<double>& sector, bool dark, const Position& begin, const Position& end,
            const Obscured& expected) noexcept {
    if (!(from < to)) return;  // already empty
    constexpr double margin = 0.002;
    const auto squared = [&](const Position& p, double factor) {
      const double relative = std::max(scale_for(sector, p), 0.0) * factor;
      return relative * relative;
    };
    const double first = dark ? 0 : squared(begin, 1 + margin), last = squared(end, 1 - margin);
    from = std::max(from, first + std::max(first - expected.from, 0.0));
    to = std::min(to, last - std::max(expected.to - last, 0.0));
  }
};

/// Obscuration of a sector, as an interval.
Obscured obscured_in(const Sector<double>& sector) noexcept {
  return {sector.obscured_from, sector.obscured_from + sector.obscured};
}

/// New scales of corners and new obscurations of a polygon.
struct Expansion {
  std::array<double, polygon_corners> scale;
  std::array<Obscured, polygon_corners> obscured{};

  explicit Expansion(double least) noexcept { scale.fill(least); }
  Expansion(double least, const PupilPolygon& polygon) noexcept : Expansion(least) {
    for (std::size_t k = 0; k < polygon_corners; ++k) obscured[k] = obscured_in(polygon.sector(k));
  }
  /// Scales both corners of a sector by at least `target`.
  void scale_to(std::size_t sector, double target) noexcept {
    for (const std::size_t k : {sector, (sector + 1) % polygon_corners}) scale[k] = std::max(scale[k], target);
  }
  /// Scales the corners and keeps the obscurations in place.
  void apply(PupilPolygon& polygon) const noexcept {
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      const double next = scale[(k + 1) % polygon_corners];
      const double larger = std::max(scale[k], next), smaller = std::min(scale[k], next);
      // If the corners scale differently, keep the interval obscured at both.
      const auto [begin, end] = obscured[k];
      const double from = begin / (smaller * smaller), to = end / (larger * larger);
      polygon.obscured_from[k] = from < to ? from : 0;
      polygon.obscured[k] = std::max(to - from, 0.0);
      polygon.corners[k] *= scale[k];
    }
  }
};

/// Makes outer and obscured areas equal to the areas of the region: the outer area by scaling the corners, the obscured
/// area by the widths in the sectors.
void match_area(PupilPolygon& polygon, const PupilRegion& region, double outer_area) {
  double outer = 0, obscured = 0;
  for (std::size_t k = 0; k < polygon_corners; ++k) outer += turn(polygon.sector(k).a, polygon.sector(k).b);
  const double larger = outer > 0 ? std::sqrt(2 * outer_area / outer) : 1;
  for (auto& corner : polygon.corners) corner = {corner[0] * larger, corner[1] * larger};
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const Sector<double> s = polygon.sector(k);
    obscured += s.obscured * turn(s.a, s.b);
  }
  if (!(obscured > 0)) return;
  const std::vector<Extent> extents = pupil_detail::extents(region);
  const auto inside = [&](double Extent::*radius) {
    double sum = 0;
    const auto at = [&](std::size_t k) {
      return position_of(region.at(k, extents[k].*radius)) - position_of(region.middle);
    };
    for (std::size_t k = 0; k < extents.size(); ++k) sum += turn(at(k), at((k + 1) % extents.size()));
    return sum;
  };
  const double target = inside(&Extent::obscured_to) - inside(&Extent::obscured_from);
  for (double& width : polygon.obscured) width = std::min(width * target / obscured, 1.0);
}

}  // namespace

PupilPolygon PupilPolygon::of(const double* node) noexcept {
  PupilPolygon result;
  const auto pair = [node](std::size_t at) { return Vec2<double>{node[at], node[at + 1]}; };
  result.middle = pair(NodeLayout::middle);
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    result.corners[k] = pair(NodeLayout::corners + 2 * k);
    const Vec2<double> interval = pair(NodeLayout::obscured + 2 * k);
    result.obscured_from[k] = interval.x, result.obscured[k] = interval.y;
  }
  return result;
}

void PupilPolygon::append_to(std::vector<double>& nodes) const {
  const auto put = [&nodes](double x, double y) { nodes.push_back(x), nodes.push_back(y); };
  put(middle.x, middle.y);
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const Vec2<double>& corner = corners[k % polygon_corners];
    put(corner.x, corner.y);
  }
  for (std::size_t k = 0; k < polygon_corners; ++k) put(obscured_from[k], obscured[k]);
}

bool PupilPolygon::is_obscured() const noexcept {
  return std::any_of(obscured.begin(), obscured.end(), [](double width) { return width > 0; });
}

double PupilPolygon::area() const noexcept {
  return PolygonSampler([this](std::size_t k) { return sector(k); }).area();
}

void PupilPolygon::widen(double by) noexcept {
  for (auto& corner : corners) corner = {by * corner[0], by * corner[1]};
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const double to = (obscured_from[k] + obscured[k]) / (by * by * by * by);
    obscured[k] = std::max(to - obscured_from[k], 0.0);
  }
}

void PupilPolygon::stretch(const std::array<double, polygon_corners>& scale) noexcept {
  Expansion expansion(1, *this);
  expansion.scale = scale;
  expansion.apply(*this);
}

PupilPolygon polygon_of(const PupilRegion& region, PolygonFit fit) {
  PupilPolygon polygon;
  polygon.middle = region.middle;
  if (region.empty()) return polygon;
  const Edge edge = edge_of(region, fit);
  const std::size_t n = edge.points.size();
  const auto point = [&](std::size_t i) -> const Position& { return edge.points[i % n]; };

  // Corners at equal steps of lit area, because all sectors get equal numbers of samples. Polygons with equal halves
  // have no obscurations.
  std::vector<double> until{0};
  const auto lit_fraction = [&](std::size_t i) {
    const double from = edge.obscured_from[i % n], to = edge.obscured_to[i % n];
    return to > from ? 1 - (to * to - from * from) : 1.0;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double lit = (lit_fraction(i) + lit_fraction(i + 1)) / 2;
    until.push_back(until.back() + lit * std::max(turn(point(i), point(i + 1)), 0.0));
  }
  double right = until.back() / 2;  // area of the half at +x
  for (std::size_t i = 0; i < n; ++i) {
    const Position &a = point(i), &b = point(i + 1);
    if (!(a.x >= 0 && b.x < 0)) continue;
    right = until[i] + a.x / (a.x - b.x) * (until[i + 1] - until[i]);
    break;
  }
  const auto area_before = [&](std::size_t k) {
    constexpr std::size_t half = polygon_corners / 2;
    const double fraction = static_cast<double>(k % half) / half;
    return k < half ? fraction * right : right + fraction * (until.back() - right);
  };
  std::array<std::size_t, polygon_corners + 1> segment{};
  for (std::size_t k = 0, i = 0; k < polygon_corners; ++k) {
    const double target = area_before(k);
    while (i + 1 < n && until[i + 1] <= target) ++i;
    segment[k] = i;
    const double step = until[i + 1] - until[i], t = step > 0 ? (target - until[i]) / step : 0;
    const Position corner = point(i) + t * (point(i + 1) - point(i));
    polygon.corners[k] = {corner.x, corner.y};
  }
  segment[polygon_corners] = n - 1;

  Expansion expansion(1);
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const Sector<double> sector = polygon.sector(k);
    for (std::size_t i = segment[k]; i <= segment[k + 1] + 1; ++i) {
      if (fit == PolygonFit::enclosing && i > segment[k] && i <= segment[k + 1]) {
        expansion.scale_to(k, scale_for(sector, point(i)));
      }
      const double begin = edge.obscured_from[i % n], end = edge.obscured_to[i % n];
      expansion.obscured[k].keep(sector, begin == 0, begin * point(i), end * point(i), {1, 0});
    }
  }
  expansion.apply(polygon);
  if (fit == PolygonFit::equal_area) {
    match_area(polygon, region, edge.area);
    // A disconnected pupil does not fit one outline with one obscuration: keep its area rather than its shape.
    const double lit = region.area(), area = polygon.area();
    if (constexpr double rounding = 1.01; area > rounding * lit) {
      for (auto& corner : polygon.corners) corner *= std::sqrt(lit / area);
    }
  }
  return polygon;
}

PupilPolygon interpolated(std::span<const PupilPolygon> polygons, const PolygonWeights& at) noexcept {
  PupilPolygon result;
  for (std::size_t j = 0; j < at.polygons.size(); ++j) {
    const double w = at.weights[j];
    if (w == 0) continue;
    const PupilPolygon& polygon = polygons[at.polygons[j]];
    for (int i : {0, 1}) result.middle[i] += w * polygon.middle[i];
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      for (int i : {0, 1}) result.corners[k][i] += w * polygon.corners[k][i];
      result.obscured_from[k] += w * polygon.obscured_from[k];
      result.obscured[k] += w * polygon.obscured[k];
    }
  }
  return result;
}

void expand_to_cover(std::span<PupilPolygon> polygons, std::span<const InterpolationCheck> checks) {
  // Margin for boundaries between the tested points, and a constant margin.
  constexpr double overshoot_factor = 1.4, min_expansion = 2e-4;
  std::vector<Expansion> expansions;
  for (const PupilPolygon& polygon : polygons) expansions.emplace_back(1 + min_expansion, polygon);
  for (const auto& [region, at] : checks) {
    if (!region || region->empty()) continue;
    const PupilPolygon polygon = interpolated(polygons, at);
    const auto sectors = [&](std::size_t k) { return polygon.sector(k); };
    const Edge edge = edge_of(*region, PolygonFit::enclosing);
    const Position offset = position_of(region->middle) - position_of(polygon.middle);
    std::size_t k = 0;
    for (std::size_t i = 0; i < edge.points.size(); ++i) {
      const auto along = [&](double fraction) { return fraction * edge.points[i] + offset; };
      const Position q = along(1);
      const std::size_t facing = sector_facing(q, sectors, k);
      if (facing == polygon_corners) continue;
      k = facing;
      const Sector<double> sector = polygon.sector(k);
      const double relative = sector.relative_radius(q),
                   target = relative > 1 ? 1 + overshoot_factor * (relative - 1) + min_expansion : 1;
      for (std::size_t j = 0; j < at.polygons.size(); ++j) {
        if (at.weights[j] == 0) continue;
        Expansion& expansion = expansions[at.polygons[j]];
        expansion.scale_to(k, target);
        expansion.obscured[k].keep(sector, edge.obscured_from[i] == 0, along(edge.obscured_from[i]),
                                   along(edge.obscured_to[i]), obscured_in(sector));
      }
    }
  }
  for (std::size_t p = 0; p < polygons.size(); ++p) expansions[p].apply(polygons[p]);
}

void expand_towards(PupilPolygon& polygon, const PupilPolygon& other) noexcept {
  if (!(polygon.area() > 0)) {
    if (other.area() > 0) polygon = other;
    return;
  }
  constexpr double middle = 0.6;  // fraction of the distance, with a margin for nonlinear motion
  const PupilPolygon both[2] = {polygon, other};
  const PupilPolygon between = interpolated(both, {{0, 1, 0, 0}, {1 - middle, middle, 0, 0}});
  const Position offset = position_of(between.middle) - position_of(polygon.middle);
  const auto sectors = [&](std::size_t k) { return polygon.sector(k); };
  Expansion expansion(1, polygon);
  const bool ring = polygon.is_obscured();
  std::size_t facing = 0;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const Sector<double> edge = between.sector(k);
    for (const double along : {0.0, 0.5}) {
      const Position corner = edge.at(1, along), q = corner + offset;
      const std::size_t found = sector_facing(q, sectors, facing);
      if (found == polygon_corners) continue;
      facing = found;
      const Sector<double> sector = polygon.sector(facing);
      expansion.scale_to(facing, scale_for(sector, q));
      if (!ring) continue;
      const auto [from, to] = obscured_in(edge);
      for (const std::size_t j : {facing, (facing + polygon_corners - 1) % polygon_corners}) {
        expansion.obscured[j].keep(polygon.sector(j), from == 0, std::sqrt(from) * corner + offset,
                                   std::sqrt(to) * corner + offset, obscured_in(sector));
      }
    }
  }
  expansion.apply(polygon);
}

}  // namespace petzval::pupil_table_detail
