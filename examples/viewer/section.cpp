// SPDX-License-Identifier: Apache-2.0
#include "viewer/section.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "petzval/blur/lens_rays.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace viewer {
namespace {

using petzval::Vec2;
using petzval::Vec3;

Vec2<float> at(double z, double y) { return {static_cast<float>(z), static_cast<float>(y)}; }

}  // namespace

Section section_of(const petzval::Lens& lens, const petzval::Film& film) {
  Section result;
  const auto surfaces = lens.surfaces();
  double widest = 0;
  for (const petzval::LensSurface& surface : surfaces) {
    if (std::isfinite(surface.semi_diameter)) widest = std::max(widest, surface.semi_diameter);
  }
  constexpr int steps = 24;
  std::vector<Vec2<float>> rims;
  double apart = 0;  // the surfaces of thin elements would overlap
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const double rim = std::min(surfaces[i].semi_diameter, widest);
    const bool stop = lens.stop() == i;
    const bool glass_before = i > 0 && std::abs(lens.index(i)) > 1.01,
               glass_behind = std::abs(lens.index(i + 1)) > 1.01;
    const double edge = surfaces[i].vertex_z + apart + petzval::sag(lens, i, 0, rim);
    if (glass_before && surfaces[i].vertex_z == surfaces[i - 1].vertex_z && edge < rims[i - 1].x) {
      apart += rims[i - 1].x - edge;
    }
    Polyline line;
    for (int k = -steps; k <= steps; ++k) {
      const double y = rim * k / steps, z = surfaces[i].vertex_z + apart + petzval::sag(lens, i, 0, y);
      if (std::isfinite(z)) line.push_back(at(z, y));
    }
    if (stop) {
      const auto z = static_cast<float>(surfaces[i].vertex_z), y = static_cast<float>(rim),
                 end = static_cast<float>(std::max(1.15 * rim, widest));
      result.stop.push_back({{z, y}, {z, end}});
      result.stop.push_back({{z, -y}, {z, -end}});
    }
    rims.push_back(line.empty() ? at(surfaces[i].vertex_z, rim) : line.back());
    if (glass_before) {
      const Vec2<float> a = rims[i - 1], b = rims[i];
      for (const float side : {1.0f, -1.0f}) result.surfaces.push_back({{a.x, side * a.y}, {b.x, side * b.y}});
    }
    if (glass_before || glass_behind || surfaces[i].mirror) result.surfaces.push_back(std::move(line));
  }
  for (Polyline& line : result.surfaces) {
    for (Vec2<float>& point : line) point.x -= static_cast<float>(apart / 2);
  }
  const Vec3<double> up = film.up(), middle{0, 0, film.z()};
  const Vec3<double> top = middle + up * (film.height_mm / 2), bottom = middle - up * (film.height_mm / 2);
  result.film.push_back({at(top.z, top.y), at(bottom.z, bottom.y)});
  result.least = result.most = at(film.z(), 0);
  for (const auto* const lines : {&result.surfaces, &result.stop, &result.film}) {
    for (const Polyline& line : *lines) {
      for (const Vec2<float>& point : line) {
        result.least = {std::min(result.least.x, point.x), std::min(result.least.y, point.y)};
        result.most = {std::max(result.most.x, point.x), std::max(result.most.y, point.y)};
      }
    }
  }
  return result;
}

std::vector<Polyline> rays_through(const petzval::Camera& camera, const petzval::FilmPoint& point) {
  std::vector<Polyline> result;
  constexpr int rays = 9;
  for (int k = 0; k < rays; ++k) {
    const double height = 2.0 * k / (rays - 1) - 1;  // along the vertical through the pupil
    const petzval::CameraRay ray =
        camera.sample({.film = point, .pupil_u = height < 0 ? 0.5 : 0.0, .pupil_v = std::min(height * height, 0.999)});
    if (!ray) continue;
    const Vec3<double> in = ray.ray.origin, towards = ray.ray.direction;
    Polyline line{at(in.z + towards.z * 1e3, in.y + towards.y * 1e3)};
    if (camera.model().is_first_order()) {
      line.push_back(at(in.z, in.y));
    } else {
      petzval::trace<double>(camera.lens(), {in, -towards}, {},
                             [&](int, const Vec3<double>& hit) { line.push_back(at(hit.z, hit.y)); });
    }
    const Vec3<double> end = camera.film().position(point);
    line.push_back(at(end.z, end.y));
    result.push_back(std::move(line));
  }
  return result;
}

Bokeh bokeh_of(const petzval::Camera& camera, const Vec2<double>& raster, double depth_mm, double focal_px) {
  constexpr int count = 1 << 13;
  const std::vector<petzval::PupilPoint> points = petzval::vogel_points(count);
  const petzval::FilmPoint film = camera.film().point(raster.x, raster.y);
  const double entrance_z = petzval::pupils(camera.lens()).entrance.z;
  struct Hit {
    double x, y, weight;
  };
  std::vector<Hit> hits;
  double x = 0, y = 0, weight = 0;
  for (const petzval::PupilPoint& pupil : points) {
    const petzval::CameraRay ray = camera.sample({.film = film, .pupil_u = pupil.u, .pupil_v = pupil.v});
    if (!ray) continue;
    const Vec3<double> from = ray.ray.origin, run = ray.ray.direction / -ray.ray.direction.z;
    // In pixels: slopes from the entrance pupil at the depth; at infinity, slopes of the ray.
    const double ahead = from.z - (entrance_z - depth_mm);
    const Vec2<double> slope = std::isinf(depth_mm)
                                   ? Vec2<double>(run.x, run.y)
                                   : Vec2<double>(from.x + run.x * ahead, from.y + run.y * ahead) / depth_mm;
    hits.push_back({slope.x * focal_px, -slope.y * focal_px, ray.weight});
    x += hits.back().x * ray.weight, y += hits.back().y * ray.weight, weight += ray.weight;
  }
  if (!(weight > 0)) return {};
  x /= weight, y /= weight;
  double reach = 0;
  for (const Hit& hit : hits) reach = std::max({reach, std::abs(hit.x - x), std::abs(hit.y - y)});
  Bokeh result{.pixels = 64, .values = std::vector<float>(64 * 64), .width_px = 2.2 * std::max(reach, 0.5)};
  for (const Hit& hit : hits) {
    // A scene point is seen by the film points around it: the picture of the point is turned by 180 degrees.
    const double column = result.pixels * (0.5 - (hit.x - x) / result.width_px),
                 row = result.pixels * (0.5 - (hit.y - y) / result.width_px);
    if (!(column >= 0 && column < result.pixels && row >= 0 && row < result.pixels)) continue;
    result.values[static_cast<std::size_t>(row) * 64 + static_cast<std::size_t>(column)] +=
        static_cast<float>(hit.weight);
  }
  const float most = *std::max_element(result.values.begin(), result.values.end());
  for (float& value : result.values) value /= most;
  return result;
}

}  // namespace viewer
