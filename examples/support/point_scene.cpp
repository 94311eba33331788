// SPDX-License-Identifier: Apache-2.0
#include "point_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "petzval/core/error.hpp"

namespace examples {

PointScene::PointScene(const petzval::IdealLens& lens, std::span<const petzval::ScenePoint> points)
    : lens_(lens), from_z_(lens.pupils.entrance.z), parallel_(!std::isfinite(from_z_)) {
  if (parallel_) from_z_ = lens.front_focal_z;
  for (const petzval::ScenePoint& point : points) {
    const petzval::Vec3<double>& p = point.position;
    const double depth = point.at_infinity ? -p.z : from_z_ - p.z;
    if (!lens.image(point) || !(depth > 0) || (parallel_ && point.at_infinity)) continue;
    const double by = parallel_ ? 1 : 1 / depth;
    known_.push_back({p.x * by, p.y * by, point.at_infinity ? 0 : 1 / depth});
  }
  if (known_.empty()) throw petzval::Error("scene: no point is in front of the lens; must have at least one");
}

double PointScene::inverse_distance(double x, double y) const {
  // Weights relative to the nearest point do not overflow; at a known point only that point has weight.
  const auto squared_away = [&](const Known& k) { return (k.x - x) * (k.x - x) + (k.y - y) * (k.y - y); };
  double nearest2 = std::numeric_limits<double>::infinity(), least = nearest2, most = 0;
  for (const Known& k : known_) {
    nearest2 = std::min(nearest2, squared_away(k));
    least = std::min(least, k.inverse_distance), most = std::max(most, k.inverse_distance);
  }
  const auto weight = [&](const Known& k) {
    const double away2 = squared_away(k), ratio2 = away2 > nearest2 ? nearest2 / away2 : 1;
    return ratio2 * ratio2;
  };
  double weights = 0, mean_x = 0, mean_y = 0, mean = 0;
  for (const Known& k : known_) {
    const double w = weight(k);
    weights += w, mean_x += w * k.x, mean_y += w * k.y, mean += w * k.inverse_distance;
  }
  mean_x /= weights, mean_y /= weights, mean /= weights;
  double xx = 0, xy = 0, yy = 0, xd = 0, yd = 0;
  for (const Known& k : known_) {
    const double w = weight(k), dx = k.x - mean_x, dy = k.y - mean_y;
    xx += w * dx * dx, xy += w * dx * dy, yy += w * dy * dy;
    xd += w * dx * (k.inverse_distance - mean), yd += w * dy * (k.inverse_distance - mean);
  }
  // A small ridge: planes stay planes (to 1e-6), and points on a line give no slope across the line.
  const double ridge = 1e-6 * (xx + yy);
  xx += ridge, yy += ridge;
  const double determinant = xx * yy - xy * xy, range = most - least;
  if (determinant > 0) {
    mean += ((yy * xd - xy * yd) * (x - mean_x) + (xx * yd - xy * xd) * (y - mean_y)) / determinant;
  }
  return std::clamp(mean, std::max(0.0, least - range), most + range);
}

std::optional<petzval::ScenePoint> PointScene::at(const petzval::Film& film, const petzval::FilmPoint& point) const {
  // The chief ray passes through the conjugate of the point and the centre of the entrance pupil.
  const petzval::ScenePoint conjugate = lens_.scene_of(film.position(point));
  petzval::Vec3<double> towards = conjugate.position;
  if (parallel_) {
    if (conjugate.at_infinity) return {};
    const double w = inverse_distance(towards.x, towards.y);
    return petzval::ScenePoint{{towards.x, towards.y, from_z_ - 1 / w}, false};
  }
  if (!conjugate.at_infinity) towards.z -= from_z_;
  if (towards.z == 0) return {};
  const double x = -towards.x / towards.z, y = -towards.y / towards.z, w = inverse_distance(x, y);
  if (w == 0) return petzval::ScenePoint{{x, y, -1}, true};
  return petzval::ScenePoint{{x / w, y / w, from_z_ - 1 / w}, false};
}

std::optional<petzval::FilmPoint> on_film(const petzval::IdealLens& lens, const petzval::Film& film,
                                          const petzval::ScenePoint& scene_point) {
  const auto image = lens.image(scene_point);
  return image ? petzval::chief_point(*image, film) : std::nullopt;
}

}  // namespace examples
