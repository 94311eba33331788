// SPDX-License-Identifier: Apache-2.0
#include "scene_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "pupil/box.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval::pupil_table_detail {

/// A leaving ray as a ray of a scene point: the angles of SceneChart, and the position in the plane that faces the
/// point, in the frame of the polygons.
struct SeenRay {
  Vec2<double> angles, position;
};

namespace {

using pupil_detail::Box;

/// Direction from a centre to the point at which a ray leaves a sphere about the centre.
Bearing<double> bearing_on_sphere(const Vec3<double>& centre, const Ray<double>& ray,
                                  double reciprocal_radius) noexcept {
  const Vec3<double> from = ray.origin - centre;
  const double b = glm::dot(from, ray.direction), beside2 = glm::dot(from, from) - b * b;
  const double along =
      std::sqrt(std::max(1 - beside2 * (reciprocal_radius * reciprocal_radius), 0.0)) - b * reciprocal_radius;
  const Vec3<double> unit = from * reciprocal_radius + ray.direction * along;
  return bearing_of(unit.x, unit.y, unit.z);
}

Bearing<double> towards(const Vec2<double>& angles) noexcept {
  const double field = std::hypot(angles.x, angles.y);
  const Vec2<double> azimuth = field > 0 ? angles / field : Vec2<double>{0, 1};
  return {field, std::sin(field), std::cos(field), azimuth.y, azimuth.x};
}

PupilPlane plane_facing(const Vec3<double>& centre, const Bearing<double>& bearing,
                        double reciprocal_distance) noexcept {
  return PupilPlane::facing(centre, bearing.field, {bearing.sine, bearing.cosine}, reciprocal_distance);
}

template <int angles>
std::vector<SeenRay> seen_from(const Vec3<double>& centre, double reciprocal, const std::vector<Ray<double>>& rays) {
  std::vector<SeenRay> seen;
  seen.reserve(rays.size());
  for (const Ray<double>& ray : rays) {
    const Bearing<double> bearing = bearing_on_sphere(centre, ray, reciprocal);
    const Vec2<double> met = plane_facing(centre, bearing, reciprocal).meet(ray);
    const auto position = SceneChart<angles>::to_grid(bearing, Point<double>{met.x, met.y});
    const auto own = SceneChart<angles>::angles_of(bearing);
    seen.push_back({{own.front(), own.back()}, {position.x, position.y}});
  }
  return seen;
}

/// Search areas for the pupils of the points of one layer: bounds of the rays of these fields.
std::vector<pupil_detail::PupilGuess> guesses_from(const std::vector<SeenRay>& rays, const Vec2<double>& last,
                                                   const Lattice& points) {
  std::vector<Box> bounds(points.layer());
  for (const SeenRay& ray : rays) {
    // A ray is used for the points of its cell and of the adjacent cells.
    const auto first = [&](int i, std::size_t steps) {
      return static_cast<std::size_t>(std::max(ray.angles[i] / last[i] * static_cast<double>(steps) - 1, 0.0));
    };
    const std::size_t row = first(1, points.steps[1]), column = first(0, points.steps[2]);
    for (std::size_t i = row; i < std::min(row + 4, points.steps[1] + 1); ++i) {
      for (std::size_t j = column; j < std::min(column + 4, points.row()); ++j) {
        bounds[i * points.row() + j].take(ray.position);
      }
    }
  }
  Vec2<double> half_extent{0, 0};
  for (const Box& b : bounds) half_extent = glm::max(half_extent, b.half());
  const auto known = [](const Box& b) { return !b.empty(); };
  auto last_known = std::find_if(bounds.begin(), bounds.end(), known);
  std::vector<pupil_detail::PupilGuess> guesses;
  for (auto b = bounds.begin(); b != bounds.end() && last_known != bounds.end(); ++b) {
    if (!b->empty()) last_known = b;
    const Vec2<double> middle = last_known->middle();
    const double half = std::max(last_known->half().y, 0.05 * half_extent.y);
    guesses.push_back({points.steps[1] == 0 ? 0 : middle.x, middle.y - 4 * half_extent.y, middle.y + 4 * half_extent.y,
                       half_extent.x, middle.y, 3 * half});
  }
  return guesses;
}

/// True if a pupil is a ring about its middle.
bool is_ring(const PupilPolygon& polygon) noexcept {
  const auto& [middle, corners, from, width] = polygon;
  return *std::max_element(from.begin(), from.end()) == 0 && *std::min_element(width.begin(), width.end()) > 0;
}

}  // namespace

double widest_field(const Vec3<double>& centre, const std::vector<Ray<double>>& rays,
                    double reciprocal_radius) noexcept {
  double widest = 0;
  for (const Ray<double>& ray : rays) {
    widest = std::max(widest, bearing_on_sphere(centre, ray, reciprocal_radius).field);
  }
  return widest;
}

template <int angles>
SceneNodes<angles> scene_nodes(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                               std::size_t wavelength, const ScenePassing& passing) {
  using Chart = SceneChart<angles>;
  SceneNodes<angles> result;
  std::vector<PupilPolygon>& polygons = result.polygons;
  constexpr std::size_t distances = 2 * Chart::distances;
  std::vector<std::vector<SeenRay>> seen;  // at each distance of a node, and halfway
  for (std::size_t i = 0; i <= distances; ++i) {
    seen.push_back(seen_from<angles>(centre, steepest * static_cast<double>(i) / distances, rays));
  }
  // Last field at each distance, with a margin because the rays are samples.
  constexpr double field_margin = 1.05, axis_field_rad = 1e-6;
  for (std::int32_t k = 0; k < Chart::angles; ++k) {
    std::array<double, distances + 1> widest{};
    for (std::size_t i = 0; i <= distances; ++i) {
      for (const SeenRay& ray : seen[i]) widest[i] = std::max(widest[i], ray.angles[k]);
      widest[i] = std::min(field_margin * widest[i] + axis_field_rad, std::numbers::pi);
    }
    for (std::size_t i = 1; i <= distances; i += 2) {
      const double lacking = std::max(widest[i] - (widest[i - 1] + widest[i + 1]) / 2, 0.0);
      widest[i - 1] += lacking, widest[i + 1] += lacking;
    }
    for (std::int32_t i = 0; i <= Chart::distances; ++i) {
      result.widest[static_cast<std::size_t>(i * Chart::angles + k)] = widest[static_cast<std::size_t>(2 * i)];
    }
  }

  constexpr auto& nodes = SceneNodes<angles>::lattice;
  PupilChart chart{.nodes = nodes,
                   .points = {{(angles == 1 ? 2 : 1) * Chart::distances, 2 * nodes.steps[1], 2 * nodes.steps[2]}},
                   .quadrant = angles == 2};
  chart.guesses = [&](PupilChart::Points points) {
    const double distance = points.front()[0];
    return guesses_from(seen[static_cast<std::size_t>(std::lround(distance * distances))], result.last(distance),
                        chart.points);
  };
  chart.clearances = [&](PupilChart::Points points) -> pupil_detail::PositionClearances {
    std::vector<Bearing<double>> bearings;
    std::vector<PupilPlane> planes;
    for (const ChartPoint& point : points) {
      bearings.push_back(towards(result.angles(point)));
      planes.push_back(plane_facing(centre, bearings.back(), steepest * point[0]));
    }
    return [=, &passing, bearings = std::move(bearings), planes = std::move(planes),
            ray = std::array<std::vector<double>, 6>{},
            passes = std::vector<std::uint8_t>{}](std::size_t count, const std::uint32_t* which, const double* x,
                                                  const double* y, double* clearances) mutable {
      for (auto& component : ray) component.resize(count);
      passes.resize(count);
      for (std::size_t r = 0; r < count; ++r) {
        const Point<double> p = Chart::to_film(bearings[which[r]], Point<double>{x[r], y[r]});
        const auto [origin, direction] = planes[which[r]].ray(p.x, p.y);
        for (int i : {0, 1, 2}) ray[i][r] = origin[i], ray[3 + i][r] = direction[i];
      }
      passing(count, {ray[0].data(), ray[1].data(), ray[2].data(), ray[3].data(), ray[4].data(), ray[5].data()},
              wavelength, passes.data());
      std::transform(passes.begin(), passes.end(), clearances, pupil_detail::clearance_of);
    };
  };
  polygons = node_polygons(chart, PolygonFit::enclosing);

  // Exclude obscurations only if all pupils are rings. Other obscurations move, and polygons without them are correct
  // only at the points that are checked.
  if (!std::all_of(polygons.begin(), polygons.end(), is_ring)) {
    for (PupilPolygon& polygon : polygons) polygon.obscured.fill(0), polygon.obscured_from.fill(0);
  }
  // Expand to the sampled rays. In the outer fields pupils shrink so fast that rays pass beyond positions that are
  // blocked, where probes do not find them: without the margin there, 9 of 10^6 lines of the Petzval lens are missed.
  constexpr double ray_margin = 1.06, outer_field_fraction = 0.85;
  // Rays between the sampled rays may pass closer to the centre of the ring.
  constexpr double obscuration_scale = 0.8;
  for (std::size_t i = 0; i <= distances; ++i) {
    const double distance = static_cast<double>(i) / distances;
    for (const SeenRay& ray : seen[i]) {
      const ChartPoint point = result.point(distance, ray.angles);
      const PolygonWeights at = nodes.weights(point);
      const bool outer = std::hypot(point[2], angles == 1 ? 0 : point[1]) > outer_field_fraction;
      const double relative = PolygonBetween{polygons, at}.relative_radius(ray.position);
      if (std::isinf(relative)) {  // a line outwards meets the edge of the pupil more than once
        polygons.clear();
        return result;
      }
      for (std::size_t j = 0; j < at.polygons.size(); ++j) {
        if (at.weights[j] == 0) continue;
        PupilPolygon& polygon = polygons[at.polygons[j]];
        if (relative < 0) {
          for (double& width : polygon.obscured) width *= obscuration_scale;
        } else if ((outer ? ray_margin : 1) * relative > 1) {
          polygon.widen(ray_margin * relative);
        }
      }
    }
  }
  return result;
}

template SceneNodes<1> scene_nodes(const Vec3<double>&, double, const std::vector<Ray<double>>&, std::size_t,
                                   const ScenePassing&);
template SceneNodes<2> scene_nodes(const Vec3<double>&, double, const std::vector<Ray<double>>&, std::size_t,
                                   const ScenePassing&);

}  // namespace petzval::pupil_table_detail
