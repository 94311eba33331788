// SPDX-License-Identifier: Apache-2.0
#include "starburst.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "area_raster.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval::ghosts_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A ray of the edge of the pupil at the film.
struct Corner {
  Vec2<double> cosines{0, 0};  ///< direction cosines along the axes of the film
  Vec2<double> at{0, 0};       ///< film point, mm
};
using Chain = std::vector<Corner>;

double turn(const Vec2<double>& a, const Vec2<double>& b) noexcept { return std::atan2(cross(a, b), glm::dot(a, b)); }

/// The pupil of a light in the space of directions at the film.
struct Outline {
  std::vector<Chain> chains;  ///< the last corner of a closed chain equals the first
  double area = 0;
};

FieldPoint field_of(const Lens& lens, const ScenePoint& light) {
  const Vec3<double>& at = light.position;
  const double pupil_z = light.at_infinity ? 0 : pupils(lens).entrance.z;
  return {std::atan2(std::hypot(at.x, at.y), pupil_z - at.z), light.at_infinity ? -infinity : at.z,
          std::atan2(at.x, at.y)};
}

Outline outline_of(const Lens& lens, const ScenePoint& light, Wavelength wavelength, const Film& film) {
  constexpr std::size_t directions = 360;
  const PupilBoundary pupil = pupil_boundary(lens, field_of(lens, light), wavelength, directions);
  const Vec3<double> normal = film.normal(), right = film.right(), up = film.up();
  // Two chains for each span of a direction: the outer ends and the inner ends.
  std::vector<std::vector<std::optional<Corner>>> ends;
  Outline result;
  std::size_t span = 0;
  for (std::size_t k = 0; k < pupil.spans.size(); ++k) {
    span = k > 0 && pupil.spans[k].direction == pupil.spans[k - 1].direction ? span + 1 : 0;
    for (const bool outer : {true, false}) {
      const RimPoint& rim = outer ? pupil.spans[k].to : pupil.spans[k].from;
      const auto [ray, fate, lost_at] =
          trace(lens, pupil.plane.ray(rim.x, rim.y), TraceOptions{.wavelength = wavelength, .apertures = false});
      if (fate != RayFate::transmitted) continue;
      const double t = glm::dot(film.position({}) - ray.origin, normal) / glm::dot(ray.direction, normal);
      const FilmPoint at = film.point(ray.origin + ray.direction * t);
      const std::size_t chain = 2 * span + (outer ? 0 : 1);
      if (ends.size() <= chain) ends.resize(chain + 2, std::vector<std::optional<Corner>>(directions));
      ends[chain][pupil.spans[k].direction] =
          Corner{{glm::dot(ray.direction, right), glm::dot(ray.direction, up)}, {at.x, at.y}};
    }
  }
  for (std::size_t c = 0; c < ends.size(); ++c) {
    const bool outer = c % 2 == 0;
    const auto dark =
        static_cast<std::size_t>(std::ranges::find_if(ends[c], [](const auto& end) { return !end; }) - ends[c].begin());
    Chain chain;
    const auto close = [&] {
      // All inner ends of a pupil without an obscuration are the same ray.
      const bool point = !outer && chain.size() > 1 && chain[0].cosines == chain[1].cosines;
      if (chain.size() > 2 && !point) result.chains.push_back(chain);
      chain.clear();
    };
    for (std::size_t k = 0; k <= directions; ++k) {
      const std::size_t at = (dark + k) % directions, next = (at + 1) % directions;
      if (!ends[c][at]) {
        close();
        continue;
      }
      chain.push_back(*ends[c][at]);
      if (outer && k < directions && ends[c][next] && ends[c + 1][at] && ends[c + 1][next]) {
        const Vec2<double> a = ends[c + 1][at]->cosines;
        result.area += std::abs(cross(ends[c][at]->cosines - a, ends[c][next]->cosines - a) +
                                cross(ends[c][next]->cosines - a, ends[c + 1][next]->cosines - a)) /
                       2;
      }
    }
    close();
  }
  return result;
}

/// Moves the corners that lie between two directions of the search to the intersection of the adjacent edges.
void sharpen(Chain& chain) {
  const std::size_t count = chain.size() - 1;
  const bool closed = chain.front().cosines == chain.back().cosines;
  const auto edge = [&](std::size_t i) { return chain[i % count + 1].cosines - chain[i % count].cosines; };
  // The turn from the edge before to the edge behind an edge; largest at the edge that cuts a corner.
  const auto both = [&](std::size_t i) {
    return closed || (i > 0 && i + 1 < count) ? turn(edge(i + count - 1), edge(i + 1)) : 0;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const double before = turn(edge(i + count - 1), edge(i)), all = both(i),
                 others = std::max(std::abs(both(i + count - 1)), std::abs(both(i + 1)));
    if (std::abs(all) < std::max(others, radians(5.0)) || before * (all - before) < 0) continue;
    const double along = cross(edge(i), edge(i + 1)) / cross(edge(i + count - 1), edge(i + 1));
    chain[i].cosines += edge(i + count - 1) * along;
    if (i == 0) chain.back() = chain.front();
    chain[i + 1] = chain[i];
    if (closed && i + 1 == count) chain.front() = chain.back();
    ++i;
  }
}

/// An edge of the outline.
struct Edge {
  Vec2<double> along{1, 0};                  ///< unit vector
  double length = 0;                         ///< in direction cosines
  Vec2<double> at{0, 0};                     ///< film point of its ray, mm
  std::optional<double> before{}, behind{};  ///< half of the turn to the adjacent edges; nullopt: a corner
  double straight = 0;                       ///< length between two corners
};

std::vector<Edge> edges_of(const Chain& chain) {
  std::vector<Edge> result;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Vec2<double> d = chain[i].cosines - chain[i - 1].cosines;
    const double length = glm::length(d);
    if (length > 0) result.push_back({d / length, length, (chain[i].at + chain[i - 1].at) / 2.0});
  }
  const bool closed = chain.front().cosines == chain.back().cosines;
  const std::size_t count = result.size();
  std::size_t corner = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Edge &edge = result[i], &next = result[(i + 1) % count];
    const double angle = turn(edge.along, next.along);
    if (std::abs(angle) > radians(20.0) || (!closed && i + 1 == count)) {
      corner = i + 1;
    } else {
      edge.behind = angle / 2, next.before = -angle / 2;
    }
  }
  // From one corner to the next, beginning at a corner.
  std::size_t begin = 0;
  double length = 0;
  for (std::size_t k = 0; k < count; ++k) {
    length += result[(corner + k) % count].length;
    if (result[(corner + k) % count].behind && k + 1 < count) continue;
    for (; begin <= k; ++begin) result[(corner + begin) % count].straight = length;
    length = 0;
  }
  return result;
}

}  // namespace

Footprint starburst(const Lens& lens, const Entrance& entrance, const ScenePoint& light, const Surfaces& surfaces,
                    Wavelength wavelength, const Film& film, const Box& frame) {
  std::vector<lens_detail::Passage> through;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) through.push_back({i, false});
  const LightPath path(lens, through);
  const Box everywhere{{-infinity, -infinity}, {infinity, infinity}};
  constexpr std::size_t cells = 64;
  const double power =
      path.footprint(entrance, path.region(entrance, wavelength), cells, surfaces, wavelength, film, everywhere).energy;
  Footprint result;
  if (!(power > 0)) return result;

  Outline outline = outline_of(lens, light, wavelength, film);
  std::vector<Edge> edges;
  for (Chain& chain : outline.chains) {
    sharpen(chain);
    std::ranges::copy(edges_of(chain), std::back_inserter(edges));
  }
  double perimeter = 0;
  for (const Edge& edge : edges) perimeter += edge.length;
  if (!(outline.area > 0 && perimeter > 0)) return result;
  const double mm = surfaces.wavelength_nm() * 1e-6 / lens.index(lens.surface_count(), wavelength);
  const double per_length = power * mm / (4 * std::numbers::pi * std::numbers::pi * outline.area);
  // At this distance a sixth of the light is outside, for a round pupil at the first dark ring.
  const double core = 12 * per_length * perimeter / power;
  const double pixel_mm = std::min(film.width_mm / film.columns, film.height_mm / film.rows);
  for (const Edge& edge : edges) {
    const double before = edge.before.value_or(0), behind = edge.behind.value_or(0);
    // The normal away from the centre of curvature: its directions at both ends diverge.
    const double outwards = behind > before ? -1 : 1;
    const auto normal = [&](double angle) {
      return (Vec2<double>(-edge.along.y, edge.along.x) * std::cos(angle) - edge.along * std::sin(angle)) * outwards;
    };
    const Vec2<double> from = normal(before), to = normal(behind), wide = edge.along * (mm / edge.straight / 2);
    const double farthest = glm::length(glm::max(glm::abs(frame.low - edge.at), glm::abs(frame.high - edge.at)));
    for (double r = core, next = 0; r < farthest; r = next) {
      next = std::max(1.04 * r, r + pixel_mm / 2);
      for (const double side : {1.0, -1.0}) {
        Deposit deposit{.count = 4, .energy = per_length * edge.length * (1 / r - 1 / next)};
        deposit.corners = {edge.at + (from * r - wide) * side, edge.at + (from * next - wide) * side,
                           edge.at + (to * next + wide) * side, edge.at + (to * r + wide) * side};
        result.energy += deposit.energy;
        result.deposits.push_back(deposit);
      }
    }
  }
  return result;
}

}  // namespace petzval::ghosts_detail
