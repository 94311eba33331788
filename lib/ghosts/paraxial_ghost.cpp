// SPDX-License-Identifier: Apache-2.0
#include "paraxial_ghost.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <numbers>
#include <vector>

#include "area_raster.hpp"
#include "lens/asphere_hit.hpp"
#include "lens/lens_view.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

namespace petzval::ghosts_detail {
namespace {

using Matrix = glm::dmat2;

/// A position that is linear in the position on the entrance plane.
struct Linear {
  Vec2<double> at{0, 0};
  Matrix by{0};

  Vec2<double> operator()(const Vec2<double>& p) const noexcept { return at + by * p; }
};

/// A ray at the plane of the front vertex.
struct State {
  Vec2<double> height{0, 0}, slope{0, 0};
};
State state_of(const Ray<double>& ray) noexcept {
  const Vec2<double> slope = Vec2<double>(ray.direction) / ray.direction.z;
  return {Vec2<double>(ray.origin) - slope * ray.origin.z, slope};
}

/// Heights and slopes at the film, and heights at the surfaces, of a ray that enters at a distance from the axis or
/// with a slope, divided by it.
struct Response {
  std::vector<Vec2<double>> heights;
  State at_film;
};
Response response(const Lens& along, Wavelength wavelength, const Vec2<double>& height, const Vec2<double>& slope,
                  double scale) {
  Response result;
  const Vec3<double> direction = glm::normalize(Vec3<double>(slope, 1));
  const auto traced = trace<double>(
      along, {{height.x, height.y, 0}, direction}, TraceOptions{.wavelength = wavelength, .apertures = false},
      [&](int, const Vec3<double>& point) { result.heights.push_back(Vec2<double>(point) / scale); });
  if (traced.fate != RayFate::transmitted) return {};
  const Ray<double>& ray = traced.ray;
  const Vec2<double> out = Vec2<double>(ray.direction) / ray.direction.z;
  result.at_film = {(Vec2<double>(ray.origin) + out * (along.film_z() - ray.origin.z)) / scale, out / scale};
  return result;
}

}  // namespace

Footprint paraxial_footprint(std::span<const lens_detail::Passage> path, const Lens& along, const Entrance& entrance,
                             const Surfaces& surfaces, Wavelength wavelength, const Film& film) {
  const std::size_t count = path.size();
  // Small rays about the axis; the light, which may be far from it.
  const double small = 1e-5 * along.surfaces()[0].semi_diameter;
  std::array<Response, 4> by;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2<double> unit(k % 2 == 0 ? small : 0, k % 2 == 0 ? 0 : small);
    by[k] = k < 2 ? response(along, wavelength, unit, {0, 0}, small) : response(along, wavelength, {0, 0}, unit, small);
    if (by[k].heights.size() != count) return {};
  }
  const Box& box = entrance.box();
  const Vec2<double> half = (box.high - box.low) / 2.0, middle = (box.low + box.high) / 2.0;
  const State centre = state_of(entrance.ray(middle)), right = state_of(entrance.ray(middle + Vec2<double>(half.x, 0))),
              up = state_of(entrance.ray(middle + Vec2<double>(0, half.y)));
  const auto linear = [&](const auto& of) {
    const auto seen = [&](const State& s) {
      return of(by[0]) * s.height.x + of(by[1]) * s.height.y + of(by[2]) * s.slope.x + of(by[3]) * s.slope.y;
    };
    const Vec2<double> at = seen(centre);
    const Matrix columns((seen(right) - at) / half.x, (seen(up) - at) / half.y);
    return Linear{at - columns * middle, columns};
  };
  std::vector<Linear> heights;
  std::vector<double> rims;
  for (std::size_t k = 0; k < count; ++k) {
    heights.push_back(linear([&](const Response& r) { return r.heights[k]; }));
    rims.push_back(along.surfaces()[k].semi_diameter);
  }
  const auto ratio = [&](std::size_t k, const Vec2<double>& p) { return glm::length(heights[k](p)) / rims[k]; };

  // A point within all rims: steps to the middle of the rim that it exceeds most, which become shorter.
  Vec2<double> inside = middle;
  for (int step = 2; step < 100; ++step) {
    std::size_t most = 0;
    for (std::size_t k = 1; k < count; ++k) {
      if (ratio(k, inside) > ratio(most, inside)) most = k;
    }
    const double determinant = glm::determinant(heights[most].by);
    if (std::abs(determinant) < 1e-12) break;
    inside -= glm::inverse(heights[most].by) * heights[most](inside) * (1.0 / step);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (!(ratio(k, inside) < 1)) return {};
  }

  const kernel::LensView<double>& view = kernel::view<double>(along);
  const auto within_iris = [&](const Vec2<double>& p) {
    for (std::size_t k = 0; k < count; ++k) {
      if (path[k].surface != *surfaces.lens().stop()) continue;
      const Vec2<double> at = heights[k](p);
      if (!kernel::within(view.iris, at.x, at.y)) return false;
    }
    return true;
  };
  const bool blades = surfaces.lens().stop() && surfaces.lens().iris().blades > 0;
  if (blades && !within_iris(inside)) return {};
  constexpr std::size_t directions = 64;
  std::array<Vec2<double>, directions> corners;
  for (std::size_t d = 0; d < directions; ++d) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(d) / directions;
    const Vec2<double> way = Vec2<double>(std::cos(angle), std::sin(angle)) * glm::length(half) * 2.0;
    double length = 1;
    for (std::size_t k = 0; k < count; ++k) {
      if (!std::isfinite(rims[k])) continue;
      const Vec2<double> at = heights[k](inside), turned = heights[k].by * way;
      const double a = glm::dot(turned, turned), b = glm::dot(at, turned), c = glm::dot(at, at) - rims[k] * rims[k];
      if (a > 0) length = std::min(length, (std::sqrt(b * b - a * c) - b) / a);
    }
    if (blades && !within_iris(inside + way * length)) {
      double from = 0, to = length;
      for (int i = 0; i < 24; ++i) {
        const double at = (from + to) / 2;
        (within_iris(inside + way * at) ? from : to) = at;
      }
      length = from;
    }
    corners[d] = inside + way * length;
  }

  Vec2<double> mean{0, 0};
  for (const Vec2<double>& corner : corners) mean += corner / static_cast<double>(directions);
  const auto power_of = [&](const Ray<double>& ray) {
    return surfaces.power(path, kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction));
  };
  const auto power = power_of(entrance.ray(mean));
  const double transmittance = power ? *power : power_of({{0, 0, -1}, {0, 0, 1}}).value_or(0);
  const Linear at_film = linear([](const Response&r) { return r.at_film.height; }),
               out = linear([](const Response&r) { return r.at_film.slope; });
  const auto on_film = [&](const Vec2<double>& p) {
    const Vec3<double> normal = film.normal(), from(at_film(p), along.film_z()), d(out(p), 1);
    const FilmPoint at = film.point(from + d * (glm::dot(film.position({}) - from, normal) / glm::dot(d, normal)));
    return Vec2<double>(at.x, at.y);
  };
  Footprint result;
  result.cells = 1;
  const Vec2<double> image = on_film(mean);
  // Sectors of four sides about the middle.
  for (std::size_t d = 0; d < directions; d += 4) {
    Deposit deposit{.count = 6};
    double twice = 0;
    deposit.corners[0] = image;
    for (std::size_t k = 0; k <= 4; ++k) {
      const Vec2<double>&corner = corners[(d + k) % directions], &next = corners[(d + k + 1) % directions];
      if (k < 4) twice += cross(corner - mean, next - mean);
      deposit.corners[k + 1] = on_film(corner);
    }
    deposit.energy = transmittance * twice / 2 * entrance.flux(mean);
    result.energy += deposit.energy;
    result.deposits.push_back(deposit);
  }
  return result;
}

}  // namespace petzval::ghosts_detail
