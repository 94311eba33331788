// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/autofocus.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/text.hpp"
#include "keyframes.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/film.hpp"
#include "plane_fit.hpp"
#include "targets.hpp"

namespace petzval {
namespace {

bool finite(const Vec3<double>& v) noexcept { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const ScenePoint& scene_point, const std::string& where) {
  const auto& [p, at_infinity] = scene_point;
  const bool nowhere = at_infinity && p.x == 0 && p.y == 0 && p.z == 0;
  if (finite(p) && !nowhere) return;
  throw Error(where + "position = (" + to_text(p.x) + ", " + to_text(p.y) + ", " + to_text(p.z) + "); must be " +
              (at_infinity ? "a direction, finite and not 0" : "finite"));
}

void check(const TrianglePoint& scene_point, std::size_t vertices, const std::string& where) {
  const auto& [a, b, c] = scene_point.barycentric;
  constexpr double tolerance = 1e-9;
  // NaN fails both comparisons.
  if (!(std::min({a, b, c}) >= -tolerance) || !(std::abs(a + b + c - 1) <= tolerance)) {
    throw Error(where + "barycentric coordinates = (" + to_text(a) + ", " + to_text(b) + ", " + to_text(c) +
                "); must be at least 0, with the sum 1");
  }
  for (const std::size_t vertex : scene_point.vertices) {
    if (vertex < vertices) continue;
    throw Error(where + "vertex = " + std::to_string(vertex) + "; must be one of the " + std::to_string(vertices) +
                " vertices");
  }
}

void check(const FocusPoint& point, std::size_t vertices, const std::string& where) {
  if (point.keys.empty()) throw Error(where + "no keys; must have at least 1");
  if (!(point.from <= point.until)) {
    throw Error(where + "valid from " + to_text(point.from) + " s until " + to_text(point.until) +
                " s; `from` must not be after `until`");
  }
  for (std::size_t k = 0; k < point.keys.size(); ++k) {
    const FocusKey& key = point.keys[k];
    const std::string at = where + "key " + std::to_string(k) + ": ";
    if (!std::isfinite(key.time)) throw Error(at + "time = " + to_text(key.time) + " s; must be finite");
    if (k > 0 && !(key.time > point.keys[k - 1].time)) {
      throw Error(at + "time = " + to_text(key.time) + " s; must be after " + to_text(point.keys[k - 1].time) + " s");
    }
    if (!std::isfinite(key.blur_mm)) throw Error(at + "blur = " + to_text(key.blur_mm) + " mm; must be finite");
    if (!std::isfinite(key.weight) || key.weight < 0) {
      throw Error(at + "weight = " + to_text(key.weight) + "; must be finite and at least 0");
    }
    if (key.extent_stops.has_value() != point.keys.front().extent_stops.has_value()) {
      throw Error(at + "an extent is " + (key.extent_stops ? "given" : "missing") +
                  "; must be in every key of the point or in no key");
    }
    if (key.extent_stops) focus_detail::check_extent(*key.extent_stops, at);
    if (const auto* scene_point = std::get_if<ScenePoint>(&key.anchor)) {
      check(*scene_point, at);
    } else {
      check(std::get<TrianglePoint>(key.anchor), vertices, at);
    }
  }
}

void check(const FocusTime& moment) {
  if (std::isnan(moment.time)) throw Error("focus_targets: time = nan; must be a number");
  if (!moment.film) return;
  const Film& film = *moment.film;
  const double width = film.width_mm, height = film.height_mm, x = film.shift_x_mm, y = film.shift_y_mm;
  const double z = film.z_mm.value_or(0), turns = film.tilt_rad + film.swing_rad;
  if (!(width >= 0 && height >= 0) || !std::isfinite(width + height + x + y + z + turns)) {
    throw Error("focus_targets: film: size = " + to_text(width) + " x " + to_text(height) + " mm about (" + to_text(x) +
                ", " + to_text(y) + ") at z = " + to_text(z) + " mm; must be finite, and the size not negative");
  }
}

/// Interpolates a number over the keys.
/// @param of function; of(k) is the number at key k
double at_time(const FocusPoint& point, double time, const auto& of) {
  if (point.keys.size() == 1) return of(0);
  std::vector<double> times, values;
  for (std::size_t k = 0; k < point.keys.size(); ++k) {
    times.push_back(point.keys[k].time);
    values.push_back(of(k));
  }
  return focus_detail::Keyframes(std::move(times), std::move(values)).at(time);
}

Vec3<double> position_of(const TrianglePoint& on, const std::array<double, 3>& weights, const FocusTime& moment) {
  Vec3<double> sum{0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) sum += moment.vertices[on.vertices[i]] * weights[i];
  return sum;
}

/// The triangle on which all keys lie; null if the keys lie on several triangles or on no triangle.
const TrianglePoint* only_triangle(const FocusPoint& point) {
  const auto* first = std::get_if<TrianglePoint>(&point.keys.front().anchor);
  const auto same = [&](const FocusKey& key) {
    const auto* on = std::get_if<TrianglePoint>(&key.anchor);
    return on && on->vertices == first->vertices;
  };
  return first && std::all_of(point.keys.begin(), point.keys.end(), same) ? first : nullptr;
}

/// The scene point as seen from the front principal point; z is the inverse distance.
Vec3<double> seen(const ScenePoint& scene_point, double principal_z) {
  const focus_detail::PicturePoint point = focus_detail::picture_point(scene_point, principal_z);
  return {point.x, point.y, point.inverse_distance};
}

/// The position of a point at a moment; nullopt if a vertex is not finite, or if the path runs from behind the lens to
/// infinity.
std::optional<ScenePoint> scene_point_at(const IdealLens& lens, const FocusPoint& point, const FocusTime& moment) {
  if (const TrianglePoint* triangle = only_triangle(point)) {
    std::array<double, 3> weights{};
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      weights[i] = at_time(point, moment.time,
                           [&](std::size_t k) { return std::get<TrianglePoint>(point.keys[k].anchor).barycentric[i]; });
      sum += weights[i];
    }
    // Each coordinate stays within the range of its keys, but the sum of the coordinates may differ from 1.
    for (double& weight : weights) weight /= sum;
    return ScenePoint{position_of(*triangle, weights, moment), false};
  }
  std::vector<ScenePoint> scene_points;
  for (const FocusKey& key : point.keys) {
    const auto* on = std::get_if<TrianglePoint>(&key.anchor);
    scene_points.push_back(on ? ScenePoint{position_of(*on, on->barycentric, moment), false}
                              : std::get<ScenePoint>(key.anchor));
    if (!finite(scene_points.back().position)) return {};
  }
  if (scene_points.size() == 1) return scene_points[0];

  const double z = lens.front_principal_z();
  const auto in_front = [&](const ScenePoint& scene_point) {
    return scene_point.position.z < (scene_point.at_infinity ? 0 : z) && finite(seen(scene_point, z));
  };
  const auto at_infinity = [](const ScenePoint& scene_point) { return scene_point.at_infinity; };
  Vec3<double> at{0, 0, 0};
  if (std::all_of(scene_points.begin(), scene_points.end(), in_front)) {
    for (int i = 0; i < 3; ++i) {
      at[i] = at_time(point, moment.time, [&](std::size_t k) { return seen(scene_points[k], z)[i]; });
    }
    const double depth = 1 / at.z;
    if (!std::isfinite(depth)) return ScenePoint{{at.x, at.y, -1}, true};
    return ScenePoint{{at.x * depth, at.y * depth, z - depth}, false};
  }
  if (std::any_of(scene_points.begin(), scene_points.end(), at_infinity)) return {};
  for (int i = 0; i < 3; ++i) {
    at[i] = at_time(point, moment.time, [&](std::size_t k) { return scene_points[k].position[i]; });
  }
  return ScenePoint{at, false};
}

bool within(Film film, const IdealLens& lens, const ImagePoint& image) {
  film.z_mm = film.z_mm.value_or(lens.rear_focal_z);
  const std::optional<FilmPoint> hit = chief_point(image, film);
  return hit && film.contains(*hit);
}

}  // namespace

std::optional<FocusTarget> focus_detail::target_at(const IdealLens& lens, const FocusPoint& point,
                                                   const FocusTime& moment) {
  const auto scene_point = scene_point_at(lens, point, moment);
  const auto image = scene_point ? lens.image(*scene_point) : std::nullopt;
  if (!image || (moment.film && !within(*moment.film, lens, *image))) return {};
  const auto now = [&](const auto& of) {
    return at_time(point, moment.time, [&](std::size_t k) { return of(point.keys[k]); });
  };
  FocusTarget target{*scene_point, now([](const FocusKey& key) { return key.blur_mm; }),
                     now([](const FocusKey& key) { return key.weight; })};
  if (point.keys.front().extent_stops) {
    target.extent_stops = now([](const FocusKey& key) { return *key.extent_stops; });
  }
  target.fixes_distance = point.fixes_distance;
  return target;
}

void focus_detail::check_points(std::span<const FocusPoint> points, const FocusTime& moment) {
  check(moment);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check(points[i], moment.vertices.size(), "focus point " + std::to_string(i) + ": ");
  }
}

void focus_detail::weigh_nearer_more(const IdealLens& lens, std::span<FocusTarget> targets) {
  const auto inverse_distance = [&](const FocusTarget& target) {
    return seen(target.point, lens.front_principal_z()).z;
  };
  double nearest = 0;
  for (const FocusTarget& target : targets) nearest = std::max(nearest, inverse_distance(target));
  if (!(nearest > 0)) return;
  for (FocusTarget& target : targets) target.weight *= inverse_distance(target) / nearest;
}

std::vector<FocusTarget> focus_targets(const IdealLens& lens, std::span<const FocusPoint> points,
                                       const FocusTime& moment) {
  focus_detail::check_points(points, moment);
  std::vector<FocusTarget> targets;
  for (const FocusPoint& point : points) {
    if (moment.time < point.from || moment.time > point.until) continue;
    if (const auto target = focus_detail::target_at(lens, point, moment)) targets.push_back(*target);
  }
  if (moment.nearer_weighs_more) focus_detail::weigh_nearer_more(lens, targets);
  return targets;
}

}  // namespace petzval
