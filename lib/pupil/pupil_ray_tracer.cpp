// SPDX-License-Identifier: Apache-2.0
#include "pupil_ray_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "aim.hpp"
#include "box.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "surface_box.hpp"
#include "trace/clearances.hpp"

namespace petzval::pupil_detail {
namespace {

using Position = Vec2<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The box, in sines, of the surface through which rays enter, seen from the point of a plane.
Box visible_surface(const Lens& lens, const PupilPlane& plane, const AngleMap& angle_map) {
  const std::size_t entered = plane.travel() == Travel::to_film ? 0 : lens.surface_count() - 1;
  const double vertex_z = lens.surfaces()[entered].vertex_z;
  const double half = half_height(lens, entered, pupils(lens, lens.primary_wavelength()).entrance);
  constexpr int radii = 10, azimuths = 16;
  Box box;
  double facing = 0;
  const bool revolved = lens.surfaces()[entered].curved_in == Section::both;
  for (int i = 0; i <= radii; ++i) {
    const double r = half * i / radii, revolved_z = sag(lens, entered, 0, r);
    for (int k = 0; k < (i == 0 ? 1 : azimuths); ++k) {
      const double angle = 2 * std::numbers::pi * k / azimuths;
      const double x = r * std::sin(angle), y = r * std::cos(angle);
      const double z = revolved ? revolved_z : sag(lens, entered, x, y);
      if (std::isnan(z)) continue;
      const Vec3<double> position{x, y, vertex_z + z};
      const double before =
          glm::dot(plane.towards() - (position - plane.centre()) * plane.reciprocal_distance(), plane.normal());
      if (facing == 0) facing = before;
      // A surface that surrounds the point may be seen at any angle.
      const double all = 1 / angle_map.per_distance();
      if (!(before / facing > 0.01)) return {{-all, -all}, {all, all}};
      box.take(angle_map.of(plane.meet({position, plane.direction_at(position)})));
    }
  }
  const Position margin = (box.high - box.low) * 0.05;
  return {box.low - margin, box.high + margin};
}

/// Points at equal steps in a box of sines, row by row.
struct Grid {
  int side;
  Position low, cell;  // in sines
  std::vector<PassingPoint> positions;
  std::vector<double> x, y;

  Grid(const AngleMap& angle_map, const Box& box, int steps)
      : side(steps + 1), low(box.low), cell((box.high - box.low) / static_cast<double>(steps)) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const Position p =
            angle_map.position(box.low + Position{static_cast<double>(i), static_cast<double>(j)} * cell);
        positions.push_back({p, cell * angle_map.stretch(p)});
        x.push_back(p.x), y.push_back(p.y);
      }
    }
  }

  /// The connected component of the points with values >= 0 nearest to `near`, or the largest component if near is
  /// empty.
  std::vector<PassingPoint> connected(std::span<const double> values, const std::optional<Position>& near) const {
    std::vector<int> component(positions.size(), -1);
    std::vector<std::size_t> best, own;
    double least = infinity;
    for (std::size_t start = 0; start < positions.size(); ++start) {
      if (!(values[start] >= 0) || component[start] >= 0) continue;
      own.assign(1, start);
      component[start] = static_cast<int>(start);
      double distance = infinity;
      for (std::size_t next = 0; next < own.size(); ++next) {
        const int column = static_cast<int>(own[next]) % side, row = static_cast<int>(own[next]) / side;
        if (near) distance = std::min(distance, glm::length((*near - low) / cell - Position(column, row)));
        for (int j = std::max(row - 1, 0); j <= std::min(row + 1, side - 1); ++j) {
          for (int i = std::max(column - 1, 0); i <= std::min(column + 1, side - 1); ++i) {
            const auto at = static_cast<std::size_t>(j * side + i);
            if (values[at] >= 0 && component[at] < 0) component[at] = static_cast<int>(start), own.push_back(at);
          }
        }
      }
      if (near ? distance < least : own.size() > best.size()) least = distance, best = own;
    }
    std::vector<PassingPoint> result;
    for (const std::size_t at : best) result.push_back(positions[at]);
    return result;
  }
};

/// Indices of local maxima among negative values on a grid with rows of length `row`. Near such a maximum a component
/// of a pupil may lie between grid points. Border points are left out.
std::vector<std::size_t> local_maxima(std::span<const double> values, std::size_t row) {
  std::vector<std::size_t> result;
  for (std::size_t i = row; i + row < values.size(); ++i) {
    const std::size_t column = i % row;
    if (!(values[i] < 0) || column + 1 == row || column == 0) continue;
    bool summit = true;
    for (const std::size_t at : {i - row, i, i + row}) {
      for (std::size_t n = at - 1; n <= at + 1; ++n) summit = summit && !(values[n] > values[i]);
    }
    if (summit) result.push_back(i);
  }
  return result;
}

}  // namespace

PupilRayTracer::PupilRayTracer(const Lens& lens, const PupilPlane& plane, std::size_t wavelength,
                               Coordinates coordinates)
    : lens_(lens), plane_(plane), angle_map_(plane), coordinates_(coordinates), wavelength_(wavelength) {}

RayArrays<double> PupilRayTracer::rays(std::span<const double> x, std::span<const double> y) {
  for (auto& values : rays_) values.resize(x.size());
  const RayArrays<double> rays{rays_[0].data(), rays_[1].data(), rays_[2].data(),
                               rays_[3].data(), rays_[4].data(), rays_[5].data()};
  if (coordinates_ == Coordinates::plane) {
    plane_.rays(x, y, rays);
    return rays;
  }
  for (auto& values : positions_) values.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Position p = angle_map_.position_at_angles({x[i], y[i]});
    positions_[0][i] = p.x, positions_[1][i] = p.y;
  }
  plane_.rays(positions_[0], positions_[1], rays);
  return rays;
}

std::span<const double> PupilRayTracer::clearances(std::span<const double> x, std::span<const double> y,
                                                   bool apertures) {
  values_.resize(x.size());
  // A block fits into the cache.
  constexpr std::size_t block = 1024;
  for (std::size_t begin = 0; begin < x.size(); begin += block) {
    const std::size_t count = std::min(block, x.size() - begin);
    trace_detail::clearances<double>(lens_, count, rays(x.subspan(begin, count), y.subspan(begin, count)),
                                     values_.data() + begin,
                                     {.travel = plane_.travel(),
                                      .wavelengths = {wavelength_},
                                      .apertures = apertures,
                                      .arithmetic = Arithmetic::reproducible});
  }
  return values_;
}

PupilRayTracer::Ends PupilRayTracer::ends(std::span<const double> x, std::span<const double> y) {
  const std::size_t count = x.size();
  fates_.resize(count);
  surfaces_.resize(count);
  const auto [ox, oy, oz, dx, dy, dz] = rays(x, y);
  trace<double>(lens_, count, {ox, oy, oz, dx, dy, dz}, {ox, oy, oz, dx, dy, dz}, fates_.data(), surfaces_.data(),
                {.travel = plane_.travel(), .wavelengths = {wavelength_}, .arithmetic = Arithmetic::reproducible});
  return {fates_, surfaces_};
}

double PupilRayTracer::reach() const {
  const Box box = visible_surface(lens_, plane_, angle_map_);
  double farthest = 0;
  for (const double x : {box.low.x, box.high.x, 0.0}) {
    for (const double y : {box.low.y, box.high.y, 0.0}) {
      const Position p = angle_map_.position({x, y});
      if (coordinates_ == Coordinates::angles) {
        const Position a = angle_map_.angles(p);
        farthest = std::max(farthest, std::isfinite(a.x) && std::isfinite(a.y) ? glm::length(a) : std::numbers::pi / 2);
        continue;
      }
      if (std::isfinite(p.x) && std::isfinite(p.y)) farthest = std::max({farthest, std::abs(p.x), std::abs(p.y)});
    }
  }
  return farthest;
}

std::optional<Vec2<double>> PupilRayTracer::chief() const {
  const AimedRay ray = aim(lens_, plane_, {}, wavelength_);
  if (!ray || !ray.end.transmitted()) return {};
  const Position p = plane_.meet(ray.ray);
  return coordinates_ == Coordinates::angles ? angle_map_.angles(p) : p;
}

std::vector<PassingPoint> PupilRayTracer::passing_points() {
  std::vector<PassingPoint> result;
  if (coordinates_ == Coordinates::angles) {
    result = PupilRayTracer(lens_, plane_, wavelength_, Coordinates::plane).passing_points();
    for (auto& [at, spacing] : result) spacing *= angle_map_.angle_per_step(at), at = angle_map_.angles(at);
    return result;
  }
  const std::optional<Position> centre = chief();
  const std::optional<Position> near = centre ? std::optional(angle_map_.of(*centre)) : std::nullopt;
  const Box box = visible_surface(lens_, plane_, angle_map_);
  const Grid grid(angle_map_, box, 48);
  const auto values = clearances(grid.x, grid.y);
  result = grid.connected(values, near);
  constexpr std::size_t sufficient_points = 32;
  if (result.size() >= sufficient_points) return result;

  // A component may lie between grid points: search near the rays with the largest clearance. If apertures are ignored,
  // the clearance is continuous and has a maximum in each component. Aspheres are an exception: beyond their apertures
  // they may have any shape, and intersections there take long to find.
  const auto surfaces = lens_.surfaces();
  const bool aspheric =
      std::any_of(surfaces.begin(), surfaces.end(), [](const LensSurface& s) { return !s.aspheric.empty(); });
  std::vector<std::pair<double, PassingPoint>> highest;
  const auto take_summits = [&](const Grid& on, std::span<const double> heights) {
    const double lost = result.empty() ? -infinity : -1;  // not at a rim
    for (const std::size_t at : local_maxima(heights, static_cast<std::size_t>(on.side))) {
      if (heights[at] > lost) highest.push_back({heights[at], on.positions[at]});
    }
  };
  if (aspheric) {
    take_summits(grid, values);
  } else {
    const Grid finer(angle_map_, box, 96);
    const auto heights = clearances(finer.x, finer.y, false);
    if (auto positions = finer.connected(heights, near); positions.size() > result.size())
      result = std::move(positions);
    take_summits(finer, heights);
  }
  if (centre) {
    const double at[] = {centre->x, centre->y};
    const Position half = result.empty() ? (box.high - box.low) / 4.0 : result.front().spacing;
    if (clearances({at, 1}, {at + 1, 1})[0] >= 0) {
      result.push_back({*centre, half});
      return result;
    }
    highest.push_back({0, {*centre, half}});
  }
  std::stable_sort(highest.begin(), highest.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  const std::size_t most = aspheric ? 8 : 64;
  if (highest.size() > most) highest.resize(most);
  std::vector<double> x, y;
  for (const auto& [height, summit] : highest) {
    constexpr int half_side = 4;
    auto [middle, half] = summit;
    std::array<double, 2> before{-infinity, -infinity};  // values of the last two passes
    // 24 passes reach the smallest stops; fewer are enough if other rays pass.
    for (int pass = 0, passes = result.empty() ? 24 : 8; pass < passes; ++pass) {
      x.clear(), y.clear();
      for (int j = -half_side; j <= half_side; ++j) {
        for (int i = -half_side; i <= half_side; ++i) {
          x.push_back(middle.x + half.x * i / half_side), y.push_back(middle.y + half.y * j / half_side);
        }
      }
      const auto closer = clearances(x, y, aspheric);
      const auto best = static_cast<std::size_t>(std::max_element(closer.begin(), closer.end()) - closer.begin());
      middle = {x[best], y[best]};
      if (closer[best] >= 0) {
        result.push_back({middle, half / static_cast<double>(half_side)});
        break;
      }
      // Along a ridge of the clearance, the gain per pass roughly halves.
      if (!result.empty() && 4 * (closer[best] - before[0]) < -closer[best]) break;
      before = {before[1], closer[best]};
      half = half * (2.0 / half_side);
    }
  }
  return result;
}

}  // namespace petzval::pupil_detail
