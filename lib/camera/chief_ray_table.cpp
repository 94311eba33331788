// SPDX-License-Identifier: Apache-2.0
#include "chief_ray_table.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "core/meet_plane.hpp"
#include "make_model.hpp"
#include "trace/sequential.hpp"

namespace petzval::camera_detail {
namespace {

/// Radius of the table, in film radii. It exceeds 1 to distinguish points imaged outside the film from points without
/// an image.
constexpr double table_radius_ratio = 1.5;
constexpr int steps = 24;  // over the radius of the table

struct Heights {
  double film = 0, pupil = 0;
};

/// A meridian; heights are along y, or along x.
struct PlaneOfRays {
  bool along_x = false;

  template <class V>
  double of(const V& v) const noexcept {
    return along_x ? v.x : v.y;
  }
  std::array<double, 2> pair(double height) const noexcept {
    return along_x ? std::array{height, 0.0} : std::array{0.0, height};
  }
  TwoPlaneRay line(const Heights& h) const noexcept {
    const auto [x, y] = pair(h.film);
    const auto [pupil_x, pupil_y] = pair(h.pupil);
    return {x, y, pupil_x, pupil_y};
  }
  Vec3<double> vector(double height, double z) const noexcept {
    return along_x ? Vec3<double>{height, 0, z} : Vec3<double>{0, height, z};
  }
};

/// Film and pupil height of the exact ray that leaves the centre of the stop towards the film with a slope (a sine).
class FromStop {
 public:
  FromStop(const LensFacts& facts, const TwoPlanes& space, std::size_t wavelength, PlaneOfRays section)
      : lens_(facts.lens()),
        space_(space),
        wavelength_(wavelength),
        section_(section),
        stop_(facts.pupils(wavelength).stop) {}

  std::optional<Heights> operator()(double slope) const noexcept {
    if (!(slope < 1)) return {};
    const double sense = signed_index(lens_, stop_ + 1, wavelength_) > 0 ? 1 : -1;
    const Vec3<double> direction = section_.vector(slope, sense * std::sqrt(1 - slope * slope));
    const auto end = kernel::trace(
        kernel::view<double>(lens_), kernel::to_kernel(Vec3<double>{0, 0, lens_.surfaces()[stop_].vertex_z}),
        kernel::to_kernel(direction), {.wavelength = wavelength_, .apertures = false, .first = stop_ + 1});
    if (end.fate != RayFate::transmitted || end.direction.z == 0) return {};
    const Ray<double> ray{kernel::to_public(end.origin), kernel::to_public(end.direction)};
    const Heights h{section_.of(core_detail::meet_plane(ray, space_.film_z)),
                    section_.of(core_detail::meet_plane(ray, space_.pupil_z))};
    return h.film < 0 ? Heights{-h.film, -h.pupil} : h;
  }

 private:
  const Lens& lens_;
  TwoPlanes space_;
  std::size_t wavelength_;
  PlaneOfRays section_;
  std::size_t stop_;
};

std::optional<Ray<double>> to_scene(const Lens& lens, const TwoPlanes& space, std::size_t wavelength,
                                    PlaneOfRays section, const Heights& h) noexcept {
  const auto end = unclipped(lens, space, wavelength, section.line(h));
  return end.transmitted() ? std::optional(end.ray) : std::nullopt;
}

std::optional<Ray<double>> to_scene(const RayModel& model, std::size_t wavelength, PlaneOfRays section,
                                    const Heights& h) noexcept {
  Ray<double> ray;
  const RayFate fate = model.to_scene(section.line(h), wavelength, ray);
  return fate == RayFate::transmitted ? std::optional(ray) : std::nullopt;
}

}  // namespace

TracedRay<double> unclipped(const Lens& lens, const TwoPlanes& space, Wavelength wavelength, const TwoPlaneRay& line) {
  const Vec3<double> along{line.pupil_x - line.film_x, line.pupil_y - line.film_y, space.depth()};
  const Ray<double> start{{line.pupil_x, line.pupil_y, space.pupil_z},
                          along * (towards_scene(lens, space) / glm::length(along))};
  return trace(lens, start, {.travel = Travel::to_scene, .wavelength = wavelength, .apertures = false});
}

ChiefRayTable::ChiefRayTable(const LensFacts& facts, const RayModel& model, double film_radius, std::size_t wavelength,
                             std::optional<double> middle) {
  const Lens& lens = facts.lens();
  const TwoPlanes space = model.pupils().space();
  const bool traced = !model.kind().is_first_order();
  // Adds a chief ray; false if the ray does not reach the scene.
  const auto add = [&](Meridian& nodes, PlaneOfRays section, const Heights& h, double ratio) {
    const auto ray = traced ? to_scene(lens, space, wavelength, section, h) : to_scene(model, wavelength, section, h);
    if (!ray) return false;
    nodes.push_back(
        {h.film, ratio, section.of(ray->origin), ray->origin.z, section.of(ray->direction), ray->direction.z});
    return true;
  };
  if (!traced) {
    const auto fill = [&](Meridian& nodes, PlaneOfRays section) {
      for (int i = 0; i <= steps; ++i) {
        const double film = film_radius * table_radius_ratio * i / steps,
                     near = std::clamp(film, 1e-3 * film_radius, film_radius);
        const auto [x, y] = section.pair(near);
        const auto of_pupil = model.pupils().middle({x, y}, wavelength);
        const double ratio = middle.value_or(of_pupil[section.along_x ? 0 : 1] / near);
        add(nodes, section, {film, ratio * film}, ratio);
      }
    };
    fill(y_, {});
    if (!lens.rotationally_symmetric()) fill(x_, {.along_x = true});
    return;
  }

  const auto fill = [&](Meridian& nodes, PlaneOfRays section) {
    const FromStop from_stop(facts, space, wavelength, section);
    constexpr double first_stop_radius = 1e-5;
    const auto first = from_stop(first_stop_radius);
    if (!first || !(first->film > 0)) return;
    add(nodes, section, {}, first->pupil / first->film);
    // Equal steps of slope; to first order these are equal steps on the film.
    const double step = std::min(film_radius * table_radius_ratio / (first->film / first_stop_radius), 1.0) / steps;
    const auto next = [&](double slope) {
      const auto h = from_stop(slope);
      return h && !nodes.empty() && h->film > nodes.back().film && add(nodes, section, *h, h->pupil / h->film);
    };
    for (int i = 1; i <= 4 * steps && !nodes.empty() && nodes.back().film < table_radius_ratio * film_radius; ++i) {
      if (next(step * i)) continue;
      // Bisect to the last ray that passes, at the edge of the image of a fisheye.
      double reached = step * (i - 1);
      for (double by = step / 2; by > 1e-4 * step; by /= 2) {
        if (next(reached + by)) reached += by;
      }
      break;
    }
  };
  fill(y_, {});
  if (!lens.rotationally_symmetric()) fill(x_, {.along_x = true});
}

double ChiefRayTable::ratio(const Meridian& nodes, double film) noexcept {
  if (nodes.size() < 4) return nodes.empty() ? 0 : nodes.front().ratio;
  const auto above =
      std::upper_bound(nodes.begin(), nodes.end(), film, [](double f, const Node& node) { return f < node.film; });
  const auto at = static_cast<std::size_t>(above - nodes.begin());
  const std::size_t first = std::clamp<std::size_t>(at, 2, nodes.size() - 2) - 2;
  // Lagrange's cubic in the square of the height, because the ratio is an even function.
  const double t = std::min(film, nodes.back().film) * std::min(film, nodes.back().film);
  double sum = 0;
  for (std::size_t i = first; i < first + 4; ++i) {
    double term = nodes[i].ratio;
    for (std::size_t j = first; j < first + 4; ++j) {
      const double ti = nodes[i].film * nodes[i].film, tj = nodes[j].film * nodes[j].film;
      if (j != i) term *= (t - tj) / (ti - tj);
    }
    sum += term;
  }
  return sum;
}

std::array<double, 2> ChiefRayTable::pupil_point(const FilmPoint& film) const noexcept {
  const double height = std::hypot(film.x, film.y);
  const double y = ratio(y_, height);
  return {film.x * (x_.empty() ? y : ratio(x_, height)), film.y * y};
}

std::optional<double> ChiefRayTable::find(const Meridian& nodes, double height, double z) noexcept {
  // Sine of the angle between the ray of a node, of positive or negative film height, and the line from the node to the
  // point.
  const auto passes_by = [&](const Node& node, double sign) -> std::optional<double> {
    const double h = height - sign * node.height, along = z - node.z;
    const double dh = sign * node.direction_height, dz = node.direction_z;
    if (!(h * dh + along * dz > 0)) return {};
    return (dh * along - dz * h) / std::hypot(h, along);
  };
  // Film height at which this sine is 0, between the nodes k - 1 and k: by a cubic through four nodes if the sines are
  // monotonic, else by the chord.
  const auto between = [&](std::size_t k, double sign, double before, double now) {
    if (nodes.size() >= 4) {
      const std::size_t first = std::clamp<std::size_t>(k, 2, nodes.size() - 2) - 2;
      std::array<double, 4> p{};
      bool monotonic = true;
      for (std::size_t i = 0; i < 4 && monotonic; ++i) {
        const auto by = passes_by(nodes[first + i], sign);
        if (by) p[i] = *by;
        monotonic = by && (i == 0 || (p[i] > p[i - 1]) == (now > before));
      }
      if (monotonic) {
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          double term = nodes[first + i].film;
          for (std::size_t j = 0; j < 4; ++j) {
            if (j != i) term *= p[j] / (p[j] - p[i]);
          }
          sum += term;
        }
        return sum;
      }
    }
    const double t = before / (before - now);
    return nodes[k - 1].film + t * (nodes[k].film - nodes[k - 1].film);
  };
  std::optional<double> last[2];
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    for (int side : {0, 1}) {
      const double sign = side ? -1 : 1;
      const auto now = passes_by(nodes[k], sign);
      const auto before = std::exchange(last[side], now);
      if (!now) continue;
      if (*now == 0) return sign * nodes[k].film;
      if (!before || (*before < 0) == (*now < 0)) continue;
      return sign * between(k, sign, *before, *now);
    }
  }
  return {};
}

std::optional<FilmPoint> ChiefRayTable::about(const Vec3<double>& point) const noexcept {
  if (!x_.empty()) {
    const auto x = find(x_, point.x, point.z), y = find(y_, point.y, point.z);
    if (!x || !y) return {};
    return FilmPoint{*x, *y};
  }
  const double height = std::hypot(point.x, point.y);
  const auto film = find(y_, height, point.z);
  if (!film) return {};
  if (!(height > 0)) return FilmPoint{};
  return FilmPoint{*film * point.x / height, *film * point.y / height};
}

}  // namespace petzval::camera_detail
