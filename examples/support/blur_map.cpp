// SPDX-License-Identifier: Apache-2.0
#include "blur_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "petzval/focus/autofocus.hpp"

namespace examples {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double ideal_blur(const petzval::Film& film, const PointScene& scene, const petzval::IdealLens& lens,
                  const petzval::FilmPoint& point) {
  const auto scene_point = scene.at(film, point);
  const auto image = scene_point ? lens.image(*scene_point) : std::nullopt;
  return image ? petzval::signed_blur(*image, film) : none;
}

/// The signed blur diameters of the scene points whose rays have their centroids at film points; NaN if no light
/// arrives. The chief ray of the ideal lens gives a first scene point; the offset of its centroid gives the next.
std::vector<double> exact_blurs(const petzval::Film& film, const PointScene& scene, const petzval::Lens& lens,
                                const std::vector<petzval::FilmPoint>& target, int threads) {
  constexpr int steps = 3;
  constexpr std::size_t rays = 96;
  std::vector<double> result(target.size(), none);
  std::vector<petzval::FilmPoint> sought = target;
  for (int step = 0; step < steps; ++step) {
    std::vector<std::size_t> nodes;
    std::vector<petzval::ScenePoint> points;
    for (std::size_t i = 0; i < target.size(); ++i) {
      if (step > 0 && std::isnan(result[i])) continue;
      const auto point = scene.at(film, sought[i]);
      if (!point) continue;
      nodes.push_back(i);
      points.push_back(*point);
    }
    const auto blurs = petzval::exact_blurs(lens, film, points, rays, threads);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!blurs[k]) continue;
      const std::size_t i = nodes[k];
      result[i] = blurs[k]->signed_diameter;
      sought[i].x += target[i].x - blurs[k]->centroid.x;
      sought[i].y += target[i].y - blurs[k]->centroid.y;
    }
  }
  return result;
}

}  // namespace

petzval::Film with_pixels(petzval::Film film, int longer_side) {
  const double pixel_mm = std::max(film.width_mm, film.height_mm) / longer_side;
  const auto pixels = [&](double length) { return std::max(1, static_cast<int>(std::lround(length / pixel_mm))); };
  film.columns = pixels(film.width_mm);
  film.rows = pixels(film.height_mm);
  return film;
}

BlurMap blur_map(const petzval::Film& film, const PointScene& scene, const petzval::IdealLens& lens,
                 const petzval::Lens* exact, int threads) {
  std::vector<petzval::FilmPoint> points;
  for (int y = 0; y < film.rows; ++y) {
    for (int x = 0; x < film.columns; ++x) points.push_back(film.point(x + 0.5, y + 0.5));
  }
  if (exact) return exact_blurs(film, scene, *exact, points, threads);
  BlurMap result;
  for (const petzval::FilmPoint& point : points) result.push_back(ideal_blur(film, scene, lens, point));
  return result;
}

double scale_of(std::span<const BlurMap> maps) {
  std::vector<double> sizes;
  for (const BlurMap& map : maps) {
    for (const double d : map) {
      if (std::isfinite(d)) sizes.push_back(std::abs(d));
    }
  }
  if (sizes.empty()) return 1e-3;
  const auto p99 = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), p99, sizes.end());
  const double target = std::max(*p99, 1e-3), decade = std::pow(10, std::floor(std::log10(target)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * decade >= target) return digit * decade;
  }
  return 10 * decade;
}

}  // namespace examples
