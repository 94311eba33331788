// SPDX-License-Identifier: Apache-2.0
#include "scene_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "grid_pupils.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Bounds of intersections of rays with facing planes.
struct Bounds {
  Vec2<double> low{0, 0}, high{0, 0};
  bool any = false;

  void take(const Vec2<double>& p) noexcept {
    for (int i : {0, 1}) {
      low[i] = any ? std::min(low[i], p[i]) : p[i];
      high[i] = any ? std::max(high[i], p[i]) : p[i];
    }
    any = true;
  }
};

Bearing towards(const Vec2<double>& angles) noexcept {
  const double field = std::hypot(angles.x, angles.y);
  const Vec2<double> azimuth = field > 0 ? angles / field : Vec2<double>{0, 1};
  return {field, std::sin(field), std::cos(field), azimuth.x, azimuth.y};
}

/// Intersection of a ray with the plane that faces a point, in the frame of the polygons.
Vec2<double> position_in_grid(const Vec3<double>& centre, const Bearing& bearing, double reciprocal,
                              const Ray<double>& ray) noexcept {
  const Vec2<double> met = plane_facing(centre, bearing, reciprocal).meet(ray);
  const Point<double> position = to_grid<3>(bearing, {met.x, met.y});
  return {position.x, position.y};
}

/// Search areas for the pupils of a grid over angles at one distance: bounds of the rays of these fields in the facing
/// planes.
std::vector<pupil_detail::PupilGuess> guesses_from(const std::vector<Ray<double>>& rays, const Vec3<double>& centre,
                                                   double reciprocal, const Vec2<double>& widest, std::size_t columns) {
  std::vector<Bounds> bounds(columns * columns);
  const double last = static_cast<double>(columns - 1);
  for (const Ray<double>& ray : rays) {
    const Bearing bearing = bearing_on_sphere(centre, ray, reciprocal);
    const Vec2<double> position = position_in_grid(centre, bearing, reciprocal, ray);
    // A ray is used for the nodes of its cell and of the adjacent cells.
    const Vec2<double> at = angles<3>(bearing) / widest * last;
    const auto first = [](double x) { return static_cast<std::size_t>(std::max(x - 1, 0.0)); };
    for (std::size_t i = first(at.y); i < std::min(first(at.y) + 4, columns); ++i) {
      for (std::size_t j = first(at.x); j < std::min(first(at.x) + 4, columns); ++j) {
        bounds[i * columns + j].take(position);
      }
    }
  }
  Vec2<double> half_extent{0, 0};
  for (const Bounds& b : bounds) {
    for (int i : {0, 1}) half_extent[i] = std::max(half_extent[i], (b.high[i] - b.low[i]) / 2);
  }
  std::vector<pupil_detail::PupilGuess> guesses;
  std::size_t known = 0;
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    if (bounds[p].any) known = p;
    const Bounds& b = bounds[p].any ? bounds[p] : bounds[known];
    const Vec2<double> middle = (b.low + b.high) / 2.0;
    const double half = std::max((b.high.y - b.low.y) / 2, 0.05 * half_extent.y);
    guesses.push_back(
        {middle.x, middle.y - 4 * half_extent.y, middle.y + 4 * half_extent.y, half_extent.x, middle.y, 3 * half});
  }
  return guesses;
}

}  // namespace

SceneNodes<3> nodes_with_cylinders(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                                   std::size_t wavelength, const ScenePassing& passing) {
  using L = SceneLayout<3>;
  constexpr std::size_t steps = L::fields, nodes = L::row, distances = L::distances + 1;
  SceneNodes<3> result;
  std::vector<PupilPolygon>& polygons = result.polygons;
  // The nodes, and points halfway between adjacent nodes.
  constexpr std::size_t rows = 2 * L::distances + 1, columns = 2 * steps + 1;
  const auto fraction = [](std::size_t i, std::size_t count) {
    return static_cast<double>(i) / static_cast<double>(count - 1);
  };

  // Largest field at each distance, with a margin because the rays are samples.
  constexpr double field_margin = 1.05, axis_field_rad = 1e-6;
  for (std::size_t i = 0; i < rows; ++i) {
    Vec2<double> reach{0, 0};
    for (const Ray<double>& ray : rays) {
      const Vec2<double> own = angles<3>(bearing_on_sphere(centre, ray, steepest * fraction(i, rows)));
      for (int k : {0, 1}) reach[k] = std::max(reach[k], field_margin * own[k] + axis_field_rad);
    }
    for (const std::size_t node : {i / 2, (i + 1) / 2}) {
      for (std::size_t k : {0, 1}) {
        double& widest = result.widest[2 * node + k];
        widest = std::max(widest, reach[static_cast<int>(k)]);
      }
    }
  }

  struct NodePlane {
    Bearing bearing;
    PupilPlane plane;
  };
  const auto node_plane_at = [&](double distance, double down, double across) {
    const Bearing bearing = towards(result.last(distance) * Vec2<double>{across, down});
    return NodePlane{bearing, plane_facing(centre, bearing, steepest * distance)};
  };
  RayClearances clearances_of(passing, wavelength);
  const auto test = [&](std::size_t count, const auto& node_plane, const double* x, const double* y,
                        double* clearances) {
    const auto ray_at = [&](std::size_t r) {
      const auto& [bearing, plane] = node_plane(r);
      const Point<double> p = from_grid<3>(bearing, {x[r], y[r]});
      return plane.ray(p.x, p.y);
    };
    clearances_of(count, ray_at, clearances);
  };

  constexpr std::size_t directions = 32;
  std::vector<PupilRegion> pupils;
  for (std::size_t i = 0; i < rows; i += 2) {
    std::vector<NodePlane> node_planes;
    for (std::size_t p = 0; p < columns * columns; ++p) {
      node_planes.push_back(
          node_plane_at(fraction(i, rows), fraction(p / columns, columns), fraction(p % columns, columns)));
    }
    const auto guesses =
        guesses_from(rays, centre, steepest * fraction(i, rows), result.last(fraction(i, rows)), columns);
    const pupil_detail::PositionClearances clearances = [&](std::size_t count, const std::uint32_t* which,
                                                            const double* x, const double* y, double* values) {
      test(
          count, [&](std::size_t r) -> const NodePlane& { return node_planes[which[r]]; }, x, y, values);
    };
    auto found = grid_pupils({guesses, columns}, directions, clearances);
    std::move(found.begin(), found.end(), std::back_inserter(pupils));
  }

  constexpr std::size_t plane = columns * columns;
  for (std::size_t i = 0; i < distances; ++i) {
    const auto own = node_polygons(std::span(pupils).subspan(i * plane, plane), columns, PolygonFit::enclosing);
    polygons.insert(polygons.end(), own.begin(), own.end());
  }
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    checks.push_back(
        {&pupils[p], SceneNodes<3>::weights_at(fraction(p / plane, distances), fraction(p % plane / columns, columns),
                                               fraction(p % columns, columns))});
  }
  expand_to_cover(polygons, checks);
  // In cells with some empty pupils, the other pupils are narrow and move fast: use the hull of the surrounding nodes.
  std::vector<bool> ending(polygons.size(), false);
  for (const auto& [pupil, at] : checks) {
    for (std::size_t j = 0; j < at.polygons.size(); ++j) {
      if (pupil->empty() && at.weights[j] != 0) ending[at.polygons[j]] = true;
    }
  }
  const std::vector<PupilPolygon> between_ends = polygons;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    if (!ending[k]) continue;
    std::vector<PupilPolygon> around;
    const std::size_t row = k / nodes % nodes, column = k % nodes, first = k - row * nodes - column;
    for (std::size_t i = row - std::min<std::size_t>(row, 1); i <= std::min(row + 1, steps); ++i) {
      for (std::size_t j = column - std::min<std::size_t>(column, 1); j <= std::min(column + 1, steps); ++j) {
        around.push_back(between_ends[first + i * nodes + j]);
      }
    }
    polygons[k] = hull(around);
  }
  constexpr std::size_t probes = 32768;
  expand_to_probes(
      polygons, probes, [](const std::array<double, 4>& at) { return SceneNodes<3>::weights_at(at[0], at[1], at[2]); },
      [&](std::span<const std::array<double, 4>> at, std::span<const std::uint32_t> which, const double* x,
          const double* y, double* clearances) {
        const auto node_plane = [&](std::size_t r) {
          return node_plane_at(at[which[r]][0], at[which[r]][1], at[which[r]][2]);
        };
        test(which.size(), node_plane, x, y, clearances);
      });

  // In the outermost fields pupils shrink, and their boundaries are more curved between the points that are checked:
  // expand polygons to the sampled rays. Outer rays are used at every distance, each inner ray at one distance.
  constexpr double ray_margin = 1.01, outer_ray_margin = 1.08, tested_field_fraction = 0.6, outer_field_fraction = 0.85;
  for (std::size_t r = 0; r < rays.size(); ++r) {
    for (std::size_t i = 0; i < rows; ++i) {
      const double distance = fraction(i, rows), reciprocal = steepest * distance;
      const Bearing bearing = bearing_on_sphere(centre, rays[r], reciprocal);
      const Vec2<double> at = angles<3>(bearing) / result.last(distance);
      const double out = std::hypot(at.x, at.y),
                   scale_margin = out < outer_field_fraction ? ray_margin : outer_ray_margin;
      if (i != r % rows && out < tested_field_fraction) continue;
      const Vec2<double> position = position_in_grid(centre, bearing, reciprocal, rays[r]);
      const PolygonWeights nodes_about = SceneNodes<3>::weights_at(distance, std::min(at.y, 1.0), std::min(at.x, 1.0));
      const double relative = interpolated(polygons, nodes_about).relative_radius(position.x, position.y);
      if (std::isinf(relative)) {  // a line outwards meets the edge of the pupil more than once
        polygons.clear();
        return result;
      }
      if (scale_margin * relative <= 1) continue;
      for (std::size_t j = 0; j < nodes_about.polygons.size(); ++j) {
        if (nodes_about.weights[j] != 0) polygons[nodes_about.polygons[j]].widen(scale_margin * relative);
      }
    }
  }
  return result;
}

}  // namespace petzval::pupil_table_detail
