// SPDX-License-Identifier: Apache-2.0
#include "entrance_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "grid_pupils.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Bounds of the places where rays cross the planes that they face.
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

/// The two angles of a bearing, in the quadrant.
Vec2<double> angles(const Bearing& bearing) noexcept {
  return {bearing.field * std::abs(bearing.azimuth.x), bearing.field * std::abs(bearing.azimuth.y)};
}

Bearing towards(const Vec2<double>& angles) noexcept {
  Bearing bearing({0, 0, -1});
  bearing.field = std::hypot(angles.x, angles.y);
  if (bearing.field > 0) bearing.azimuth = angles / bearing.field;
  return bearing;
}

/// Where to look for the pupils of the points of a grid over angles at a distance: about what the rays of these fields
/// take of their planes.
std::vector<pupil_detail::PupilGuess> guesses_from(const std::vector<Ray<double>>& rays, const Vec3<double>& centre,
                                                   double reciprocal, const Vec2<double>& widest, std::size_t columns) {
  std::vector<Bounds> bounds(columns * columns);
  const double last = static_cast<double>(columns - 1);
  for (const Ray<double>& ray : rays) {
    const Bearing bearing(centre, ray, reciprocal);
    const Vec2<double> place =
        bearing.in_quadrant(PupilPlane::facing(centre, bearing.field, bearing.azimuth, reciprocal).meet(ray));
    // Of the points of the cell and those around it.
    const Vec2<double> at = angles(bearing) / widest * last;
    const auto first = [](double x) { return static_cast<std::size_t>(std::max(x - 1, 0.0)); };
    for (std::size_t i = first(at.y); i < std::min(first(at.y) + 4, columns); ++i) {
      for (std::size_t j = first(at.x); j < std::min(first(at.x) + 4, columns); ++j) {
        bounds[i * columns + j].take(place);
      }
    }
  }
  Vec2<double> room{0, 0};
  for (const Bounds& b : bounds) {
    for (int i : {0, 1}) room[i] = std::max(room[i], (b.high[i] - b.low[i]) / 2);
  }
  std::vector<pupil_detail::PupilGuess> guesses;
  std::size_t known = 0;
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    if (bounds[p].any) known = p;
    const Bounds& b = bounds[p].any ? bounds[p] : bounds[known];
    const Vec2<double> middle = (b.low + b.high) / 2.0;
    const double half = std::max((b.high.y - b.low.y) / 2, 0.05 * room.y);
    guesses.push_back({middle.x, middle.y - 4 * room.y, middle.y + 4 * room.y, room.x, middle.y, 3 * half});
  }
  return guesses;
}

}  // namespace

void RayClearances::test(std::size_t count, double* clearances) {
  through_.resize(count);
  const auto at = [this](std::size_t k) { return components_[k].data(); };
  passing_(count, {at(0), at(1), at(2), at(3), at(4), at(5)}, wavelength_, through_.data());
  std::transform(through_.begin(), through_.end(), clearances, pupil_detail::clearance_of);
}

Bearing::Bearing(const Vec3<double>& unit) noexcept {
  const double across = std::hypot(unit.x, unit.y);
  field = std::atan2(across, -unit.z);
  if (across > 0) azimuth = {unit.x / across, unit.y / across};
}

Bearing::Bearing(const Vec3<double>& centre, const Ray<double>& ray, double reciprocal_radius) noexcept
    : Bearing([&] {
        const Vec3<double> from = ray.origin - centre;
        const double b = glm::dot(from, ray.direction), beside2 = glm::dot(from, from) - b * b;
        const double along =
            std::sqrt(std::max(1 - beside2 * (reciprocal_radius * reciprocal_radius), 0.0)) - b * reciprocal_radius;
        return from * reciprocal_radius + ray.direction * along;
      }()) {}

Vec2<double> Bearing::in_quadrant(const Vec2<double>& place) const noexcept {
  const double x = azimuth.y * place.x + azimuth.x * place.y, y = azimuth.y * place.y - azimuth.x * place.x;
  return {azimuth.x < 0 ? -x : x, azimuth.y < 0 ? -y : y};
}

Vec2<double> Bearing::from_quadrant(const Vec2<double>& place) const noexcept {
  const double x = azimuth.x < 0 ? -place.x : place.x, y = azimuth.y < 0 ? -place.y : place.y;
  return {azimuth.y * x - azimuth.x * y, azimuth.x * x + azimuth.y * y};
}

EntranceGrid::EntranceGrid(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                           std::size_t wavelength, const ScenePassing& passing)
    : steepest_(steepest) {
  // The nodes and, at their distances, the points halfway between.
  constexpr std::size_t rows = 2 * distance_steps + 1, columns = 2 * steps + 1;
  const auto part = [](std::size_t i, std::size_t count) {
    return static_cast<double>(i) / static_cast<double>(count - 1);
  };

  // How far fields reach at each distance; the rays leave room between them.
  constexpr double between_rays = 1.05, on_axis = 1e-6;
  for (std::size_t i = 0; i < rows; ++i) {
    Vec2<double> reach{0, 0};
    for (const Ray<double>& ray : rays) {
      const Vec2<double> own = angles(Bearing(centre, ray, steepest * part(i, rows)));
      for (int k : {0, 1}) reach[k] = std::max(reach[k], between_rays * own[k] + on_axis);
    }
    for (const std::size_t node : {i / 2, (i + 1) / 2}) {
      for (int k : {0, 1}) widest_[node][k] = std::max(widest_[node][k], reach[k]);
    }
  }

  struct Place {
    Bearing bearing;
    PupilPlane plane;
  };
  const auto place_at = [&](double distance, double down, double across) {
    const Bearing bearing = towards(widest(distance) * Vec2<double>{across, down});
    return Place{bearing, PupilPlane::facing(centre, bearing.field, bearing.azimuth, steepest_ * distance)};
  };
  RayClearances clearances_of(passing, wavelength);
  const auto test = [&](std::size_t count, const auto& place, const double* x, const double* y, double* clearances) {
    const auto ray_at = [&](std::size_t r) {
      const auto& [bearing, plane] = place(r);
      const Vec2<double> p = bearing.from_quadrant({x[r], y[r]});
      return plane.ray(p.x, p.y);
    };
    clearances_of(count, ray_at, clearances);
  };

  constexpr std::size_t directions = 32;
  std::vector<PupilRegion> pupils;
  for (std::size_t i = 0; i < rows; i += 2) {
    std::vector<Place> places;
    for (std::size_t p = 0; p < columns * columns; ++p) {
      places.push_back(place_at(part(i, rows), part(p / columns, columns), part(p % columns, columns)));
    }
    const auto guesses = guesses_from(rays, centre, steepest * part(i, rows), widest(part(i, rows)), columns);
    const pupil_detail::PlaceClearances clearances = [&](std::size_t count, const std::uint32_t* which, const double* x,
                                                         const double* y, double* values) {
      test(
          count, [&](std::size_t r) -> const Place& { return places[which[r]]; }, x, y, values);
    };
    auto found = grid_pupils({guesses, columns}, directions, clearances);
    std::move(found.begin(), found.end(), std::back_inserter(pupils));
  }

  constexpr std::size_t plane = columns * columns;
  for (std::size_t i = 0; i < distances; ++i) {
    const auto own = node_polygons(std::span(pupils).subspan(i * plane, plane), columns, PolygonFit::enclosing);
    polygons_.insert(polygons_.end(), own.begin(), own.end());
  }
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    checks.push_back({&pupils[p], weights_at(part(p / plane, distances), part(p % plane / columns, columns),
                                             part(p % columns, columns))});
  }
  expand_to_cover(polygons_, checks);
  // Where the light ends within a cell its pupils are slivers that move fast: anywhere in those of the nodes around.
  std::vector<bool> ending(polygons_.size(), false);
  for (const auto& [pupil, at] : checks) {
    for (std::size_t j = 0; j < at.polygons.size(); ++j) {
      if (pupil->empty() && at.weights[j] != 0) ending[at.polygons[j]] = true;
    }
  }
  const std::vector<PupilPolygon> between_ends = polygons_;
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    if (!ending[k]) continue;
    std::vector<PupilPolygon> around;
    const std::size_t row = k / nodes % nodes, column = k % nodes, first = k - row * nodes - column;
    for (std::size_t i = row - std::min<std::size_t>(row, 1); i <= std::min(row + 1, steps); ++i) {
      for (std::size_t j = column - std::min<std::size_t>(column, 1); j <= std::min(column + 1, steps); ++j) {
        around.push_back(between_ends[first + i * nodes + j]);
      }
    }
    polygons_[k] = hull(around);
  }
  constexpr std::size_t probes = 32768;
  expand_to_probes(
      polygons_, probes, [](const std::array<double, 4>& at) { return weights_at(at[0], at[1], at[2]); },
      [&](std::span<const std::array<double, 4>> at, std::span<const std::uint32_t> which, const double* x,
          const double* y, double* clearances) {
        const auto place = [&](std::size_t r) { return place_at(at[which[r]][0], at[which[r]][1], at[which[r]][2]); };
        test(which.size(), place, x, y, clearances);
      });

  // Where pupils dwindle, in the last fields, their boundaries bend more than places between nodes show: the sampled
  // rays themselves do, at every distance; the others each at one.
  constexpr double about_rays = 1.01, about_last_rays = 1.08, outer_fields = 0.6, last_fields = 0.85;
  for (std::size_t r = 0; r < rays.size(); ++r) {
    for (std::size_t i = 0; i < rows; ++i) {
      const double distance = part(i, rows), reciprocal = steepest * distance;
      const Bearing bearing(centre, rays[r], reciprocal);
      const Vec2<double> at = angles(bearing) / widest(distance);
      const double out = std::hypot(at.x, at.y), room = out < last_fields ? about_rays : about_last_rays;
      if (i != r % rows && out < outer_fields) continue;
      const Vec2<double> place =
          bearing.in_quadrant(PupilPlane::facing(centre, bearing.field, bearing.azimuth, reciprocal).meet(rays[r]));
      const PolygonWeights nodes_about = weights_at(distance, std::min(at.y, 1.0), std::min(at.x, 1.0));
      const double way = interpolated(polygons_, nodes_about).way_to(place.x, place.y);
      if (std::isinf(way)) {  // a pupil that no polygon about a middle describes
        polygons_.clear();
        return;
      }
      if (room * way <= 1) continue;
      for (std::size_t j = 0; j < nodes_about.polygons.size(); ++j) {
        if (nodes_about.weights[j] != 0) polygons_[nodes_about.polygons[j]].widen(room * way);
      }
    }
  }
}

Vec2<double> EntranceGrid::widest(double distance) const noexcept {
  const double row = distance * distance_steps;
  const auto i = std::min(static_cast<std::size_t>(row), distance_steps - 1);
  return widest_[i] + (row - static_cast<double>(i)) * (widest_[i + 1] - widest_[i]);
}

PolygonWeights EntranceGrid::weights_at(double distance, double down, double across) noexcept {
  const auto cell = [](double part, std::size_t count) {
    const double at = part * static_cast<double>(count);
    const auto i = std::min(static_cast<std::size_t>(at), count - 1);
    return std::pair(i, at - static_cast<double>(i));
  };
  const auto [i, d] = cell(distance, distance_steps);
  const auto [j, s] = cell(down, steps);
  const auto [k, t] = cell(across, steps);
  PolygonWeights result;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t far = corner / 4, up = corner / 2 % 2, right = corner % 2;
    result.polygons[corner] = ((i + far) * nodes + j + up) * nodes + k + right;
    result.weights[corner] = (far ? d : 1 - d) * (up ? s : 1 - s) * (right ? t : 1 - t);
  }
  return result;
}

std::optional<PolygonWeights> EntranceGrid::weights(const Bearing& bearing, double reciprocal_distance) const noexcept {
  const double distance = std::min(reciprocal_distance / steepest_, 1.0);
  const Vec2<double> at = angles(bearing) / widest(distance);
  if (!(at.x <= 1 && at.y <= 1)) return {};
  return weights_at(distance, at.y, at.x);
}

PupilPolygon EntranceGrid::polygon(const Bearing& bearing, double reciprocal_distance) const noexcept {
  const auto at = weights(bearing, reciprocal_distance);
  return at ? interpolated(polygons_, *at) : PupilPolygon{};
}

}  // namespace petzval::pupil_table_detail
