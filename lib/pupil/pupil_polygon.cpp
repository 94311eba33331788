// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/pupil_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace petzval::inline v0::pupil_detail {
namespace {

using Point = std::array<double, 2>;

Point operator-(const Point& a, const Point& b) noexcept { return {a[0] - b[0], a[1] - b[1]}; }
Point operator*(const Point& a, double s) noexcept { return {a[0] * s, a[1] * s}; }

/// Twice the area that b adds to the star behind a: positive in the order of corners, from +y to +x.
double turn(const Point& a, const Point& b) noexcept { return b[0] * a[1] - a[0] * b[1]; }

/// The outer edge as a closed line about the middle, and the gap on the way to each of its points as fractions.
struct Rim {
  std::vector<Point> points;
  std::vector<double> gap_from, gap_to;
  double area = 0;  // that the outer edge goes around
};

/// Where the prolonged chords before and behind the one from b to c meet: between b and c, the edge of a convex region
/// stays within. Else b.
Point apex(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  const Point u = b - a, v = c - d, w = c - b;
  const double determinant = turn(u, v);
  const double size = std::hypot(u[0], u[1]) * std::hypot(v[0], v[1]);
  if (!(std::abs(determinant) > 1e-9 * size)) return b;
  const double s = turn(w, v) / determinant, t = turn(w, u) / determinant;
  constexpr double farthest = 4;  // chord lengths
  const bool between = s > 0 && s <= farthest && t > 0 && t <= farthest;
  return between ? Point{b[0] + s * u[0], b[1] + s * u[1]} : b;
}

Rim rim_of(const PupilEdges& edges, bool covering) {
  const std::size_t n = edges.to.size();
  std::vector<double> gap_from = edges.gap_from, gap_to = edges.gap_to, to = edges.to;
  // A tip that lies between a direction along which something passes and one along which nothing does.
  if (covering) {
    for (std::size_t k = 0; k < n; ++k) {
      if (edges.to[k] > 0) continue;
      for (const std::size_t beside : {(k + 1) % n, (k + n - 1) % n}) {
        if (!(edges.to[beside] > to[k])) continue;
        gap_from[k] = edges.gap_from[beside];
        gap_to[k] = edges.gap_to[beside];
        to[k] = edges.to[beside];
      }
    }
  }
  std::vector<Point> p(n);
  for (std::size_t k = 0; k < n; ++k) p[k] = edges.at(static_cast<double>(k), to[k]) - edges.middle;
  Rim rim;
  const auto add = [&](const Point& point, std::size_t k) {
    rim.points.push_back(point);
    rim.gap_from.push_back(to[k] > 0 ? gap_from[k] / to[k] : 0);
    rim.gap_to.push_back(to[k] > 0 ? gap_to[k] / to[k] : 1);
  };
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    add(p[k], k);
    rim.area += turn(p[k], p[next]) / 2;
    const Point tip = apex(p[(k + n - 1) % n], p[k], p[next], p[(k + 2) % n]);
    if (tip == p[k]) continue;
    // A smooth arc reaches over the chord by a third of the triangle (chords meet twice as far out as tangents do).
    rim.area += (turn(p[k], tip) + turn(tip, p[next]) - turn(p[k], p[next])) / 6;
    if (covering && turn(p[k], tip) > 0 && turn(tip, p[next]) > 0) add(tip, k);
  }
  return rim;
}

/// What a corner's and the next one's scale must be for the sector to contain a point of its cone.
double reach(const Point& corner, const Point& next, const Point& q) noexcept {
  const double whole = turn(corner, next);
  if (!(whole > 0)) return 1;
  return (turn(q, next) + turn(corner, q)) / whole;
}

/// What all of some directions have of a gap: squared fractions of the way to a sector's outer edge.
struct Gap {
  double from = 0, to = 1;

  /// Of a sector with these corners: the gap that lies between two points in its cone, a little narrower; by as much
  /// again as it is narrower than `expected`, which comes from neighbours. dark: from the middle on.
  void keep(const Point& corner, const Point& next, bool dark, const Point& begin, const Point& end,
            const Gap& expected) noexcept {
    constexpr double margin = 0.002;
    const auto squared = [&](const Point& p, double room) {
      const double r = std::max(reach(corner, next, p), 0.0) * room;
      return r * r;
    };
    const double first = dark ? 0 : squared(begin, 1 + margin), last = squared(end, 1 - margin);
    from = std::max(from, first + std::max(first - expected.from, 0.0));
    to = std::min(to, last - std::max(expected.to - last, 0.0));
  }
  bool open() const noexcept { return from < to; }
};

/// The sector in whose cone a point lies, looked for from one on.
std::size_t sector_of(const std::array<Point, polygon_corners>& corners, const Point& q, std::size_t from) noexcept {
  for (std::size_t i = 0; i < polygon_corners; ++i) {
    const std::size_t k = (from + i) % polygon_corners;
    const Point &a = corners[k], &b = corners[(k + 1) % polygon_corners];
    if (turn(a, q) >= 0 && turn(q, b) > 0 && turn(a, b) > 0) return k;
  }
  return polygon_corners;
}

/// Scales the corners; the gaps stay where they are.
void stretch(PupilPolygon& star, const std::array<double, polygon_corners>& scale) {
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const double larger = std::max(scale[k], scale[(k + 1) % polygon_corners]);
    const double smaller = std::min(scale[k], scale[(k + 1) % polygon_corners]);
    // Of a sector that is stretched more at one side, what was its gap at both.
    const double from = star.gap_from[k] / (smaller * smaller);
    const double to = (star.gap_from[k] + star.gap[k]) / (larger * larger);
    star.gap_from[k] = from < to ? from : 0;
    star.gap[k] = std::max(to - from, 0.0);
  }
  for (std::size_t k = 0; k < polygon_corners; ++k) star.corners[k] = star.corners[k] * scale[k];
}

}  // namespace

std::array<double, polygon_corners> PupilPolygon::areas() const noexcept {
  std::array<double, polygon_corners> result;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    result[k] = std::max(turn(corners[k], corners[(k + 1) % polygon_corners]) / 2 * (1 - gap[k]), 0.0);
  }
  return result;
}

PolygonSampler::PolygonSampler(const PupilPolygon& star) noexcept : star_(star), until_(star.areas()) {
  std::partial_sum(until_.begin(), until_.end(), until_.begin());
}

std::array<double, 2> PolygonSampler::operator()(double u, double v) const noexcept {
  const double share = std::clamp(u, 0.0, 1.0) * area();
  const auto end = std::lower_bound(until_.begin(), until_.end() - 1, share);
  const auto k = static_cast<std::size_t>(end - until_.begin());
  const double before = k > 0 ? until_[k - 1] : 0, part = until_[k] - before;
  const double along = part > 0 ? std::clamp((share - before) / part, 0.0, 1.0) : 0;
  const auto& [middle, corners, gap_from, gap] = star_;
  const Point &a = corners[k], &b = corners[(k + 1) % polygon_corners];
  const double within = (1 - gap[k]) * std::clamp(v, 0.0, 1.0);
  const double out = std::sqrt(within < gap_from[k] ? within : within + gap[k]);
  return {middle[0] + out * (a[0] + along * (b[0] - a[0])), middle[1] + out * (a[1] + along * (b[1] - a[1]))};
}

PupilPolygon polygon_of(const PupilEdges& edges, bool covering) {
  PupilPolygon star;
  star.middle = edges.middle;
  if (edges.empty()) return star;
  const Rim rim = rim_of(edges, covering);
  const std::size_t n = rim.points.size();
  const auto point = [&](std::size_t i) -> const Point& { return rim.points[i % n]; };

  // Corners at equal steps of the area.
  std::vector<double> until{0};
  for (std::size_t i = 0; i < n; ++i) until.push_back(until.back() + std::max(turn(point(i), point(i + 1)), 0.0));
  std::array<std::size_t, polygon_corners + 1> segment{};
  for (std::size_t k = 0, i = 0; k < polygon_corners; ++k) {
    const double wanted = until.back() * static_cast<double>(k) / polygon_corners;
    while (i + 1 < n && until[i + 1] <= wanted) ++i;
    segment[k] = i;
    const double step = until[i + 1] - until[i], t = step > 0 ? (wanted - until[i]) / step : 0;
    const Point &a = point(i), &b = point(i + 1);
    star.corners[k] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
  }
  segment[polygon_corners] = n - 1;

  std::array<double, polygon_corners> scale;
  scale.fill(1);
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    const std::size_t next = (k + 1) % polygon_corners;
    Gap gap;
    for (std::size_t i = segment[k]; i <= segment[k + 1] + 1; ++i) {
      if (i > segment[k] && i <= segment[k + 1]) {
        const double wanted = reach(star.corners[k], star.corners[next], point(i));
        scale[k] = std::max(scale[k], wanted);
        scale[next] = std::max(scale[next], wanted);
      }
      const double begin = rim.gap_from[i % n], end = rim.gap_to[i % n];
      gap.keep(star.corners[k], star.corners[next], begin == 0, point(i) * begin, point(i) * end, {1, 0});
    }
    if (!gap.open()) continue;
    star.gap_from[k] = gap.from;
    star.gap[k] = gap.to - gap.from;
  }
  if (covering) {
    stretch(star, scale);
    return star;
  }
  // The whole area right: the outer one by the corners, that of the gap by the sectors.
  double outer = 0, kept = 0, gaps = 0;
  for (std::size_t k = 0; k < polygon_corners; ++k)
    outer += turn(star.corners[k], star.corners[(k + 1) % polygon_corners]);
  const double larger = outer > 0 ? std::sqrt(2 * rim.area / outer) : 1;
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    star.corners[k] = star.corners[k] * larger;
  }
  const std::size_t directions = edges.to.size();
  for (std::size_t k = 0; k < directions; ++k) {
    const auto between = [&](const std::vector<double>& ends) {
      const auto at = [&](std::size_t i) { return edges.at(static_cast<double>(i), ends[i]) - edges.middle; };
      return turn(at(k), at((k + 1) % directions));
    };
    gaps += between(edges.gap_to) - between(edges.gap_from);
  }
  for (std::size_t k = 0; k < polygon_corners; ++k) {
    kept += star.gap[k] * turn(star.corners[k], star.corners[(k + 1) % polygon_corners]);
  }
  if (kept > 0) {
    for (double& gap : star.gap) gap = std::min(gap * gaps / kept, 1.0);
  }
  return star;
}

void expand_to_cover(std::span<PupilPolygon> stars, std::span<const InterpolationCheck> between) {
  // Edges between those looked at reach a little farther still.
  constexpr double beyond = 1.4, always = 2e-4;
  std::vector<std::array<double, polygon_corners>> scales(stars.size());
  std::vector<std::array<Gap, polygon_corners>> gaps(stars.size());
  for (auto& scale : scales) scale.fill(1 + always);
  for (std::size_t s = 0; s < stars.size(); ++s) {
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      gaps[s][k] = {stars[s].gap_from[k], stars[s].gap_from[k] + stars[s].gap[k]};
    }
  }
  for (const InterpolationCheck& field : between) {
    if (!field.edges || field.edges->empty()) continue;
    Point middle{0, 0};
    std::array<Point, polygon_corners> corners{};
    std::array<Gap, polygon_corners> expected;
    expected.fill({0, 0});
    for (std::size_t j = 0; j < field.stars.size(); ++j) {
      const PupilPolygon& star = stars[field.stars[j]];
      const double w = field.weights[j];
      middle = {middle[0] + w * star.middle[0], middle[1] + w * star.middle[1]};
      for (std::size_t k = 0; k < polygon_corners; ++k) {
        corners[k] = {corners[k][0] + w * star.corners[k][0], corners[k][1] + w * star.corners[k][1]};
        expected[k].from += w * star.gap_from[k];
        expected[k].to += w * (star.gap_from[k] + star.gap[k]);
      }
    }
    const Rim rim = rim_of(*field.edges, true);
    const Point offset = field.edges->middle - middle;
    std::size_t k = 0;
    for (std::size_t i = 0; i < rim.points.size(); ++i) {
      const auto at = [&](double part) -> Point {
        return {part * rim.points[i][0] + offset[0], part * rim.points[i][1] + offset[1]};
      };
      const Point q = at(1);
      const std::size_t found = sector_of(corners, q, k);
      if (found == polygon_corners) continue;
      k = found;
      const std::size_t next = (k + 1) % polygon_corners;
      const double r = reach(corners[k], corners[next], q);
      const double wanted = r > 1 ? 1 + beyond * (r - 1) + always : 1;
      for (std::size_t j = 0; j < field.stars.size(); ++j) {
        if (field.weights[j] == 0) continue;
        auto& scale = scales[field.stars[j]];
        scale[k] = std::max(scale[k], wanted);
        scale[next] = std::max(scale[next], wanted);
        gaps[field.stars[j]][k].keep(corners[k], corners[next], rim.gap_from[i] == 0, at(rim.gap_from[i]),
                                     at(rim.gap_to[i]), expected[k]);
      }
    }
  }
  for (std::size_t s = 0; s < stars.size(); ++s) {
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      const Gap& gap = gaps[s][k];
      stars[s].gap_from[k] = gap.open() ? gap.from : 0;
      stars[s].gap[k] = gap.open() ? gap.to - gap.from : 0;
    }
    stretch(stars[s], scales[s]);
  }
}

}  // namespace petzval::inline v0::pupil_detail
