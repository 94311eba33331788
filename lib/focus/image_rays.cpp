// SPDX-License-Identifier: Apache-2.0
#include "focus/image_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "core/low_discrepancy.hpp"
#include "core/meet_plane.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "pupil/trace_rays.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "signed_diameter.hpp"

namespace petzval {
namespace {

/// The point from which rays are sent for a scene point; nullopt if its coordinates are invalid.
std::optional<Vec3<double>> seen_at(const ScenePoint& scene_point) noexcept {
  const auto& [p, at_infinity] = scene_point;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double farthest = 1e50;  // mm; rays from this distance are parallel to the last bit
  if (p.z == -infinity && !at_infinity && std::isfinite(p.x) && std::isfinite(p.y)) {
    return Vec3<double>{0, 0, -farthest};
  }
  const double distance = std::hypot(p.x, p.y, p.z);
  if (!std::isfinite(distance)) return {};
  if (at_infinity || distance > farthest) {
    if (!(distance > 0)) return {};
    return p / distance * farthest;
  }
  return p;
}

}  // namespace

std::optional<ExactBlur> blur_on(const RayBundle& bundle, const Film& film) {
  const std::size_t count = bundle.x.size();
  for (const auto* numbers : {&bundle.y, &bundle.slope_x, &bundle.slope_y}) {
    if (numbers->size() == count) continue;
    throw Error("blur: bundle: x has " + std::to_string(count) + " values, y, slope_x or slope_y has " +
                std::to_string(numbers->size()) + "; must be equal");
  }
  if (count == 0) return {};
  const Vec3<double> right = film.right(), up = film.up(), normal = film.normal();
  const double to_film = film.z() - bundle.plane_z;
  const auto rise = [&](std::size_t i) {
    return normal.x * bundle.slope_x[i] + normal.y * bundle.slope_y[i] + normal.z;
  };
  // Relative to the point at which the film meets the axis.
  const auto hit = [&](std::size_t i) {
    const Ray<double> ray{{bundle.x[i], bundle.y[i], -to_film}, {bundle.slope_x[i], bundle.slope_y[i], 1}};
    return core_detail::meet_plane(ray, {0, 0, 0}, normal);
  };
  const bool ahead = rise(0) > 0;
  Vec3<double> middle{0, 0, 0};
  double slope_x = 0, slope_y = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if ((rise(i) > 0) != ahead || rise(i) == 0) return {};
    middle += hit(i);
    slope_x += bundle.slope_x[i], slope_y += bundle.slope_y[i];
  }
  const double each = 1 / static_cast<double>(count);
  middle *= each, slope_x *= each, slope_y *= each;
  double square = 0, largest = 0, spreads = 0, steepness = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3<double> from = hit(i) - middle;
    const double radius2 = glm::dot(from, from);
    square += radius2;
    largest = std::max(largest, radius2);
    // Positive if the rays diverge: the film then lies behind their focus.
    const double u = bundle.slope_x[i] - slope_x, v = bundle.slope_y[i] - slope_y;
    spreads += from.x * u + from.y * v;
    steepness += u * u + v * v;
  }
  const double rms = std::sqrt(square * each);
  if (!std::isfinite(rms)) return {};
  constexpr double diameter = 2 * std::numbers::sqrt2;  // diameter of a uniform disc divided by its RMS radius
  const double defocus = steepness > 0 ? spreads * each / std::sqrt(steepness * each) : 0;
  return ExactBlur{.centroid = {glm::dot(middle, right), glm::dot(middle, up)},
                   .rms_radius = rms,
                   .largest_radius = std::sqrt(largest),
                   .signed_diameter = focus_detail::signed_diameter(diameter * rms, diameter * defocus)};
}

struct ImageRays::Data {
  Lens lens;
  IdealLens ideal;
  EntrancePupilTable entrances;
  std::size_t ray_count;  // rays per point

  RayBundle send(const Vec3<double>& point, std::size_t count) const;
};

RayBundle ImageRays::Data::send(const Vec3<double>& point, std::size_t count) const {
  const std::size_t wavelength = lens.primary_wavelength();
  const auto start = [&](std::size_t begin, std::size_t end, const RayArrays<double>& rays) {
    std::array<double, pupil_detail::block_rays> u, v;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [around, outwards] = core_detail::fibonacci_point(i, count);
      u[i - begin] = around, v[i - begin] = outwards;
    }
    std::array<EntranceSample, pupil_detail::block_rays> samples;
    entrances.spread(point, end - begin, u.data(), v.data(), wavelength, samples.data());
    std::size_t started = 0;
    for (std::size_t i = 0; i < end - begin; ++i) {
      const auto& [at, along, distance, pdf] = samples[i];
      if (!(pdf > 0)) continue;
      rays.x[started] = at.x, rays.y[started] = at.y, rays.z[started] = at.z;
      rays.dx[started] = along.x, rays.dy[started] = along.y, rays.dz[started] = along.z;
      ++started;
    }
    return started;
  };
  return pupil_detail::trace_rays(lens, lens.surfaces().back().vertex_z, count,
                                  {.wavelength = wavelength, .arithmetic = Arithmetic::fast}, start);
}

ImageRays::ImageRays(const Lens& lens, double film_radius, std::size_t rays) {
  if (rays < 16) throw Error(lens.name() + ": point bundles: rays = " + std::to_string(rays) + "; must be at least 16");
  data_ = std::make_shared<const Data>(Data{
      .lens = lens,
      .ideal = thick_lens(lens, lens.primary_wavelength()),
      .entrances = traced_entrances(lens, FilmPupilTable::enclosing(lens, film_radius)),
      .ray_count = rays,
  });
}

const Lens& ImageRays::lens() const noexcept { return data_->lens; }
const IdealLens& ImageRays::ideal() const noexcept { return data_->ideal; }

RayBundle ImageRays::bundle(const ScenePoint& scene_point) const {
  const std::optional<Vec3<double>> point = seen_at(scene_point);
  if (!point) {
    RayBundle none;
    none.plane_z = data_->lens.surfaces().back().vertex_z;
    return none;
  }
  const std::size_t rays = data_->ray_count;
  RayBundle bundle = data_->send(*point, rays);
  // Send more rays if the lens blocks most of them, as can happen without rotational symmetry.
  const std::size_t kept = bundle.x.size();
  if (kept == 0 || 2 * kept >= rays) return bundle;
  return data_->send(*point, std::min(rays * rays / kept, 16 * rays));
}

ImageRays image_rays(const Lens& lens, const Film& film, std::span<const ScenePoint> points, std::size_t rays) {
  const IdealLens ideal = thick_lens(lens, lens.primary_wavelength());
  // 1.3: margin for a tilted and shifted film. No light of points far outside the film passes the lens.
  const double corner = std::hypot(film.width_mm, film.height_mm) / 2, focal_length = std::abs(ideal.rear_focal_length);
  const double limit = corner > 0 ? 3 * corner : 2 * focal_length;
  double farthest = std::max(1.3 * corner, 0.01 * focal_length);
  for (const ScenePoint& point : points) {
    const auto image = ideal.image(point);
    if (image) farthest = std::max(farthest, 1.1 * std::hypot(image->position.x, image->position.y));
  }
  constexpr std::size_t most_rays = std::size_t{1} << 22, fewest = 64;
  const std::size_t affordable = std::max(most_rays / std::max<std::size_t>(points.size(), 1), fewest);
  return {lens, std::min(farthest, limit), std::min(rays, affordable)};
}

ImageRays image_rays(const Lens& lens, const Film& film, std::span<const FocusTarget> targets, std::size_t rays) {
  std::vector<ScenePoint> points;
  for (const FocusTarget& target : targets) points.push_back(target.point);
  return image_rays(lens, film, points, rays);
}

std::vector<std::optional<ExactBlur>> exact_blurs(const Lens& lens, const Film& film,
                                                  std::span<const ScenePoint> points, std::size_t rays, int threads) {
  const ImageRays bundles = image_rays(lens, film, points, rays);
  std::vector<std::optional<ExactBlur>> result(points.size());
  parallel_for(points.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = blur_on(bundles.bundle(points[i]), film);
  });
  return result;
}

}  // namespace petzval
