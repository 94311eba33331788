// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/entrance_pupil_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "core/meet_plane.hpp"
#include "lens/between_wavelengths.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "pupil/surface_box.hpp"
#include "scene_loops.hpp"
#include "scene_nodes.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

constexpr double pi = std::numbers::pi;

double squared(double x) noexcept { return x * x; }

/// Solid angle of a ball seen from a distance; 4 pi inside the ball.
double cone(double radius, double distance) noexcept {
  if (!(distance > radius)) return 4 * pi;
  const double sine2 = squared(radius / distance);
  return 2 * pi * sine2 / (1 + std::sqrt(1 - sine2));  // 1 - cosine, without cancellation
}

/// Largest distance of rays from the point z on the axis.
double farthest_ray(const std::vector<Ray<double>>& rays, double z) noexcept {
  double farthest = 0;
  for (const Ray<double>& ray : rays) {
    farthest = std::max(farthest, glm::length(glm::cross(ray.origin - Vec3<double>{0, 0, z}, ray.direction)));
  }
  return farthest;
}

/// Position on the axis of the centre of the smallest ball that all rays meet.
double least_ball(std::span<const std::vector<Ray<double>>> rays, double first, double last) noexcept {
  const auto radius = [&](double z) {
    double largest = 0;
    for (const auto& own : rays) largest = std::max(largest, farthest_ray(own, z));
    return largest;
  };
  // The distance from a line is a convex function of the position on the axis, and so is the maximum over lines:
  // ternary search.
  for (int i = 0; i < 24; ++i) {
    const double a = first + (last - first) / 3, b = last - (last - first) / 3;
    if (radius(a) < radius(b)) {
      last = b;
    } else {
      first = a;
    }
  }
  return (first + last) / 2;
}

/// Expands the nodes of each wavelength to contain the pupils up to halfway to the adjacent wavelengths.
template <int angles>
void expand_to_neighbours(std::vector<SceneNodes<angles>>& tables, const lens_detail::CompiledWavelengths& compiled) {
  const std::vector<SceneNodes<angles>> own = tables;
  const auto expand = [&](SceneNodes<angles>& table, const SceneNodes<angles>& other) {
    if (table.polygons.empty() || other.polygons.empty()) return;
    constexpr auto& lattice = SceneNodes<angles>::lattice;
    for (std::size_t node = 0; node < lattice.size(); ++node) {
      const ChartPoint own_point = lattice.point(node);
      // The same field, limited to the last field of the other wavelength.
      const ChartPoint at = other.point(own_point[0], table.angles(own_point));
      expand_towards(table.polygons[node], interpolated(other.polygons, lattice.weights(at)));
    }
  };
  for (std::size_t r = 0; r + 1 < compiled.count(); ++r) {
    const std::size_t w = compiled.position(r), next = compiled.position(r + 1);
    expand(tables[w], own[next]);
    expand(tables[next], own[w]);
  }
}

}  // namespace

struct EntrancePupilTable::Data {
  Lens lens;
  Vec3<double> centre{0, 0, 0};
  double front_half = 0, steepest = 0;  // steepest: largest reciprocal distance of the table, 1/mm
  std::vector<double> balls;            // by wavelength: radius about the centre, mm; 0 if no ray passes
  bool cylinders = false, obscured = false;
  std::vector<double> nodes, widest;  // SceneGrid
  std::size_t primary = 0;
  lens_detail::CompiledWavelengths compiled;

  explicit Data(const Lens& l) : lens(l) {}

  bool in_front(const Vec3<double>& point) const noexcept {
    const auto near_enough = [](double x) { return std::abs(x) <= farthest_point; };
    if (!near_enough(point.x) || !near_enough(point.y) || !near_enough(point.z)) return false;
    const double r = std::hypot(point.x, point.y);
    // Points outside the rim of the front element may lie behind its vertex: their fields exceed 90 degrees.
    return r > front_half || point.z < sag(lens, 0, point.x, point.y);
  }

  /// Makes the nodes of all wavelengths.
  /// @param of_wavelength function; of_wavelength(w) makes the nodes of wavelength w
  template <int angles, class OfWavelength>
  void fill(std::size_t wavelengths, int threads, const OfWavelength& of_wavelength) {
    std::vector<SceneNodes<angles>> tables(wavelengths);
    parallel_for(wavelengths, 1, threads, [&](std::size_t w, std::size_t) {
      if (balls[w] > 0) tables[w] = of_wavelength(w);
    });
    if (compiled.count() == wavelengths) expand_to_neighbours(tables, compiled);
    for (SceneNodes<angles>& table : tables) {
      if (table.polygons.empty()) {
        table.widest.fill(0);
        table.polygons.resize(SceneNodes<angles>::lattice.size());
      }
      widest.insert(widest.end(), table.widest.begin(), table.widest.end());
      for (const PupilPolygon& p : table.polygons) {
        p.append_to(nodes);
        obscured = obscured || p.is_obscured();
      }
    }
  }

  template <int angles>
  SceneGrid<angles> grid() const noexcept {
    SceneGrid<angles> result;
    result.chart = {widest.data(), centre.z, steepest, front_half};
    result.nodes = nodes.data();
    result.wavelengths = static_cast<std::int32_t>(balls.size());
    result.obscured = obscured;
    return result;
  }
  /// Calls body(grid).
  template <class Body>
  auto with_grid(const Body& body) const {
    return cylinders ? body(grid<2>()) : body(grid<1>());
  }
  /// Calls body(grid, cell) with the cell of a point. Returns false if the grid has no polygon for the point.
  template <class Body>
  bool with_cell(const Vec3<double>& point, std::size_t wavelength, const Body& body) const noexcept {
    return with_grid([&](const auto& grid) {
      const auto cell =
          grid.chart.template find<double>(point.x, point.y, point.z, true, static_cast<std::int32_t>(wavelength));
      if (cell.known) body(grid, cell);
      return cell.known;
    });
  }

  /// Index of the pupils for a wavelength; balls.size() or more if the wavelength is not covered.
  std::size_t position(Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    return nm ? compiled.nearest(*nm) : at.index(primary);
  }
  /// True if a ray at a wavelength may reach the pupil from a point.
  bool sees(const Vec3<double>& point, std::size_t wavelength) const noexcept {
    return wavelength < balls.size() && balls[wavelength] > 0 && in_front(point);
  }
  /// True if the grid has pupils for points at a distance; otherwise samples fill the cone of the ball.
  bool covers(std::size_t wavelength, double distance) const noexcept {
    return widest[wavelength * (widest.size() / balls.size())] > 0 && steepest * distance >= 1;
  }
  /// Samples the cone of the ball, for points without a pupil in the grid.
  EntranceSample in_cone(const Vec3<double>& point, std::size_t wavelength, double u, double v) const noexcept {
    EntranceSample sample{.origin = centre};
    if (!sees(point, wavelength) || !std::isfinite(u) || !std::isfinite(v)) return sample;
    const Vec3<double> from_centre = point - centre;
    const double distance = glm::length(from_centre);
    if (covers(wavelength, distance)) return sample;
    const Vec3<double> unit = from_centre / distance;
    const double solid = cone(balls[wavelength], distance), less = std::clamp(v, 0.0, 1.0) * solid / (2 * pi);
    const double sine = std::sqrt(less * (2 - less)), angle = 2 * pi * u;
    const auto across =
        ray_to_lens(bearing_of(unit.x, unit.y, unit.z), 1.0, {sine * std::cos(angle), sine * std::sin(angle)});
    const Vec3<double> direction = unit * (less - 1) + Vec3<double>{across.x, across.y, across.z};
    const double far = std::max(distance * (1 - less), 0.0);
    return {point + direction * far, direction, far, 1 / solid};
  }
  /// A sample of the grid, or of the cone if the grid has none.
  /// @param number function; number(k) is number k of scene_sample()
  template <class Number>
  EntranceSample in_grid(const Number& number, const Vec3<double>& point, std::size_t wavelength, double u,
                         double v) const noexcept {
    if (!(number(7) > 0)) return in_cone(point, wavelength, u, v);
    return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6), number(7)};
  }
};

EntrancePupilTable::EntrancePupilTable(const Lens& lens, std::span<const std::vector<Ray<double>>> rays,
                                       const ScenePassing& passing, int threads) {
  auto data = std::make_shared<Data>(lens);
  data->primary = lens.primary_wavelength();
  data->compiled = lens_detail::CompiledWavelengths(lens.wavelengths_nm());
  const Pupil entrance = pupils(lens, lens.primary_wavelength()).entrance;
  const pupil_detail::SurfaceBox box = pupil_detail::surface_box(lens, 0, entrance);
  data->front_half = box.half;
  // Tables are correct for every centre; the centre of the pupil separates fields best. The centre must not lie in
  // front of the lens, among scene points, nor so far behind the lens that all points have nearly the same field.
  const double length = std::abs(lens.surfaces().back().vertex_z) + box.half;
  const double first = box.z_min, last = box.z_max + 4 * length;
  data->centre.z = std::clamp(entrance.z, first, last);
  if (!lens.rotationally_symmetric()) data->centre.z = least_ball(rays, first, last);
  const double along = std::max(data->centre.z - box.z_min, box.z_max - data->centre.z);
  double reach = std::hypot(box.half, along);  // contains the front surface; grid points lie farther out
  for (const auto& own : rays) {
    const double between_rays = lens.rotationally_symmetric() ? 1.15 : 1.2;
    data->balls.push_back(between_rays * farthest_ray(own, data->centre.z));
    reach = std::max(reach, data->balls.back());
  }
  // With cylinders, the pupils of near points move too fast for the small number of nodes.
  data->steepest = (lens.rotationally_symmetric() ? 0.8 : 0.25) / reach;
  // Exclude near points whose rays reach the film only through a small part of the pupil: their fields are far larger
  // than the fields of other points.
  for (const auto& own : rays) {
    constexpr double field_margin_rad = 1e-6;
    const double farthest = widest_field(data->centre, own, 0) + field_margin_rad;
    while (widest_field(data->centre, own, data->steepest) > 1.5 * farthest) data->steepest *= 0.7;
  }
  data->cylinders = !lens.rotationally_symmetric();
  data->with_grid([&](const auto& grid) {
    constexpr int angles = std::decay_t<decltype(grid.chart)>::angles;
    data->fill<angles>(rays.size(), threads, [&](std::size_t w) {
      return scene_nodes<angles>(data->centre, data->steepest, rays[w], w, passing);
    });
  });
  data_ = std::move(data);
}

EntrancePupilArrays EntrancePupilTable::arrays() const {
  const Data& data = *data_;
  const auto number = [](double x) { return static_cast<float>(x); };
  EntrancePupilArrays result{
      .dimensions = data.cylinders ? 3 : 2,
      .centre_z = number(data.centre.z),
      .steepest = number(data.steepest),
      .front_half = number(data.front_half),
      .balls = {data.balls.begin(), data.balls.end()},
      .widest = {data.widest.begin(), data.widest.end()},
      .nodes = {},
      .node_size = static_cast<std::size_t>(data.obscured ? NodeLayout::size : NodeLayout::obscured)};
  for (std::size_t begin = 0; begin < data.nodes.size(); begin += NodeLayout::size) {
    for (std::size_t k = 0; k < result.node_size; ++k) result.nodes.push_back(number(data.nodes[begin + k]));
  }
  return result;
}

bool EntrancePupilTable::in_front(const Vec3<double>& point) const noexcept { return data_->in_front(point); }

void EntrancePupilTable::sample(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
                                const RayWavelengths& wavelengths, const EntranceRays& rays) const noexcept {
  const auto put = [&rays](std::size_t k, const EntranceSample& s) {
    rays.x[k] = s.origin.x, rays.y[k] = s.origin.y, rays.z[k] = s.origin.z;
    rays.dx[k] = s.direction.x, rays.dy[k] = s.direction.y, rays.dz[k] = s.direction.z;
    rays.distance[k] = s.distance, rays.pdf[k] = s.pdf;
  };
  if (count == 1) {
    put(0, sample(*points, *u, *v, wavelengths.at(0)));
    return;
  }
  constexpr std::size_t block = 64, registers = 8;
  const Data& data = *data_;
  alignas(64) double x[block], y[block], z[block], own_u[block], own_v[block], found[8][block];
  alignas(64) std::int64_t known[block];
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    for (std::size_t i = 0; i < (n + registers - 1) / registers * registers; ++i) {
      const std::size_t k = begin + std::min(i, n - 1), position = data.position(wavelengths.at(k));
      known[i] = position < data.balls.size() ? static_cast<std::int64_t>(position) : -1;
      x[i] = points[k].x, y[i] = points[k].y, z[i] = points[k].z, own_u[i] = u[k], own_v[i] = v[k];
    }
    data.with_grid([&](const auto& grid) {
      std::get<SceneLoop<std::decay_t<decltype(grid.chart)>::angles>>(scene_loops().loops)(
          grid, n, {x, y, z, own_u, own_v, known},
          {found[0], found[1], found[2], found[3], found[4], found[5], found[6], found[7]});
    });
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = begin + i;
      put(k, data.in_grid([&](std::size_t j) { return found[j][i]; }, points[k], static_cast<std::size_t>(known[i]),
                          u[k], v[k]));
    }
  }
}

EntranceSample EntrancePupilTable::sample(const Vec3<double>& point, double u, double v,
                                          Wavelength wavelength) const noexcept {
  const Data& data = *data_;
  const std::size_t position = data.position(wavelength);
  const bool known = position < data.balls.size();
  return data.with_grid([&](const auto& grid) {
    const auto found = scene_sample<true, double>(grid, point.x, point.y, point.z, u, v, known,
                                                  known ? static_cast<std::int32_t>(position) : 0);
    return data.in_grid([&](std::size_t k) { return found[k]; }, point, position, u, v);
  });
}

void EntrancePupilTable::spread(const Vec3<double>& point, std::size_t count, const double* u, const double* v,
                                Wavelength wavelength, EntranceSample* samples) const noexcept {
  const Data& data = *data_;
  const std::size_t position = data.position(wavelength);
  std::fill_n(samples, count, EntranceSample{.origin = data.centre});
  if (!data.sees(point, position)) return;
  const bool known = data.with_cell(point, position, [&](const auto& grid, const auto& cell) {
    const PolygonSampler sampler(
        [&](std::size_t k) { return sector_of<true, double>(grid, cell, static_cast<std::int32_t>(k)); });
    const double whole = sampler.area();
    const Point<double> middle = middle_of<double>(grid, cell);
    for (std::size_t i = 0; i < count && whole > 0; ++i) {
      if (!std::isfinite(u[i]) || !std::isfinite(v[i])) continue;
      const Point<double> in_grid = middle + sampler(u[i], v[i]);
      const auto ray = ray_to_lens(cell.bearing, cell.distance, grid.chart.to_film(cell, in_grid));
      samples[i] = {data.centre + Vec3<double>{ray.x, ray.y, ray.z},
                    {ray.dx, ray.dy, ray.dz},
                    ray.distance,
                    ray.per_area / whole};
    }
  });
  if (known) return;
  for (std::size_t i = 0; i < count; ++i) samples[i] = data.in_cone(point, position, u[i], v[i]);
}

double EntrancePupilTable::pdf(const Vec3<double>& point, const Ray<double>& ray,
                               Wavelength wavelength) const noexcept {
  const Data& data = *data_;
  const std::size_t position = data.position(wavelength);
  if (!data.sees(point, position)) return 0;
  const Vec3<double> from_centre = point - data.centre;
  const double distance = glm::length(from_centre);
  const Vec3<double> unit = from_centre / distance;
  const double cosine = -glm::dot(ray.direction, unit);
  if (!data.covers(position, distance)) {
    const double solid = cone(data.balls[position], distance);
    constexpr double rounding = 1e-15;  // of the cosine
    return 1 - cosine <= solid / (2 * pi) * (1 + 1e-12) + rounding ? 1 / solid : 0;
  }
  if (!(cosine > 0)) return 0;
  double density = 0;
  data.with_cell(point, position, [&](const auto& grid, const auto& cell) {
    const Vec3<double> met = core_detail::meet_plane(ray, data.centre, unit) - data.centre;
    const auto& b = cell.bearing;
    const Point<double> at{b.cosine * met.x - b.sine * met.y,
                           b.field_cosine * (b.sine * met.x + b.cosine * met.y) + b.field_sine * met.z};
    const double area = locate<true, false, double>(grid, cell, at).area;
    density = area > 0 ? 1 / area : 0;
  });
  return squared(distance) * density / (cosine * squared(cosine));
}

}  // namespace petzval
