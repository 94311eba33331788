// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/focal_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "focus/targets.hpp"
#include "moving_least_squares.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval {
namespace {

using camera_detail::MovingLeastSquares;
using camera_detail::WeighedValue;

constexpr double margin = 1e-3;        // focal lengths in front of the front focal plane
constexpr double largest_power = 1e6;  // limit of inverse distances, in 1 / focal length: squares are finite

double entrance_pupil(const IdealLens& lens) {
  const double z = lens.pupils.entrance.z;
  if (!std::isfinite(z)) throw Error("focal surface: the entrance pupil is at infinity; must be at a finite distance");
  return z;
}

/// Inverse of the smallest distance at which a surface may focus.
double nearest_inverse(const IdealLens& lens) {
  const double f = std::abs(lens.front_focal_length);
  const double in_front = entrance_pupil(lens) - std::min(lens.front_focal_z - margin * f, lens.front_z);
  return in_front > 0 ? std::min(1 / in_front, largest_power / f) : largest_power / f;
}

/// Diameter of the blur on the film (mm) per 1/mm of difference between the inverse distances of focus and object;
/// constant for an ideal lens.
double blur_per_inverse(const IdealLens& lens, Film film) {
  film.tilt_rad = film.swing_rad = 0;
  const double near = nearest_inverse(lens) / 2;
  const auto blur = [&](const ScenePoint& at) {
    const auto image = lens.image(at);
    return image ? signed_blur(*image, film) : std::nan("");
  };
  return (blur({{0, 0, -1}, true}) - blur({{0, 0, entrance_pupil(lens) - 1 / near}, false})) / near;
}

/// Inverse distance at which the film is in focus on the axis.
double inverse_in_focus(const IdealLens& lens, const Film& film) {
  const ScenePoint scene = lens.scene_of({0, 0, film.z()});
  return scene.at_infinity ? 0 : 1 / (entrance_pupil(lens) - scene.position.z);
}

std::string point_name(std::size_t i) { return "focal surface: point " + std::to_string(i + 1) + ": "; }

void check(const FocalPoint& point, double nearest, double farthest, const std::string& where) {
  if (point.inverse_distance && *point.inverse_distance > nearest) {
    throw Error(where + "the object is " + to_text(1 / *point.inverse_distance) +
                " mm from the entrance pupil; must be farther away than " + to_text(1 / nearest) +
                " mm, in front of the front focal plane");
  }
  if (point.inverse_distance && !(*point.inverse_distance >= farthest)) {
    throw Error(where + "1 / distance = " + to_text(*point.inverse_distance) + " / mm; must be at least " +
                to_text(farthest) + " / mm");
  }
  if (!std::isfinite(point.blur_mm)) {
    throw Error(where + "blur = " + to_text(point.blur_mm) + " mm; must be finite");
  }
  if (point.extent_stops) focus_detail::check_extent(*point.extent_stops, where);
}

}  // namespace

std::string_view name(SurfaceKind kind) noexcept {
  switch (kind) {
    case SurfaceKind::affine: return "affine";
    case SurfaceKind::shepard: return "shepard";
  }
  return "unknown";
}

struct FocalSurface::Fields {
  double origin_z = 0;
  bool fixes_distance = false;
  double blur_per_inverse = 0;
  MovingLeastSquares distance, extent;
  /// Surface through the distances of the points without the shifts by `blur_mm`; nullopt if no point has a blur.
  std::optional<MovingLeastSquares> objects;
};

FocalSurface::FocalSurface(const IdealLens& lens, const Film& film, std::span<const FocalPoint> points,
                           const FocalSurfaceOptions& options) {
  const double position = film.z() + film.tilt_rad + film.swing_rad;
  if (!(film.width_mm > 0 && film.height_mm > 0 && std::isfinite(film.area_mm2()) && std::isfinite(position))) {
    throw Error("focal surface: film = " + to_text(film.width_mm) + " x " + to_text(film.height_mm) +
                " mm at z = " + to_text(film.z()) + " mm; must be finite, with a size above 0");
  }
  const double origin_z = entrance_pupil(lens), side = std::sqrt(film.area_mm2());
  const double nearest = nearest_inverse(lens);
  const double farthest = -largest_power / std::abs(lens.front_focal_length);
  const double per_inverse = blur_per_inverse(lens, film);
  bool blurs = false, any = false;
  std::vector<WeighedValue> objects, extents;
  std::vector<std::size_t> numbers;  // indices of the points with distances
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FocalPoint& point = points[i];
    check(point, nearest, farthest, point_name(i));
    const WeighedValue with{point.film_point, 0, point.weight, point.fade};
    camera_detail::check(with, side, point_name(i));
    const bool counts = point.weight > 0 && point.fade > 0;
    if (!counts) continue;
    const auto add = [&](std::vector<WeighedValue>& to, double value) {
      to.push_back(with);
      to.back().value = value;
    };
    if (point.inverse_distance) {
      add(objects, *point.inverse_distance);
      numbers.push_back(i);
      blurs = blurs || point.blur_mm != 0;
    }
    if (point.extent_stops) add(extents, *point.extent_stops);
    any = any || point.inverse_distance || point.extent_stops;
  }
  if (!any) {
    throw Error("focal surface: 0 of " + std::to_string(points.size()) +
                " points have a weight and a distance or an extent; must be at least 1");
  }
  const bool fixes_distance = !objects.empty();
  if (!fixes_distance) {
    const double default_inverse_distance = options.default_inverse_distance.value_or(inverse_in_focus(lens, film));
    if (!(default_inverse_distance >= farthest && default_inverse_distance <= nearest)) {
      throw Error("focal surface: default 1 / distance = " + to_text(default_inverse_distance) + " / mm; must be " +
                  to_text(farthest) + " to " + to_text(nearest) + " / mm");
    }
    objects.push_back({{0, 0}, default_inverse_distance});
  }
  if (extents.empty()) extents.push_back({{0, 0}, 0});
  const MovingLeastSquares extent("focal surface: ", extents, side, options.kind, options.beta, 0);
  // Inverse distances are not negative, unless a point has a negative inverse distance.
  const auto field = [&](const std::vector<WeighedValue>& of) {
    MovingLeastSquares result("focal surface: ", of, side, options.kind, options.beta);
    result.keep_within(std::min(0.0, result.least_value()), nearest);
    return result;
  };
  MovingLeastSquares distance = field(objects);
  std::optional<MovingLeastSquares> own;
  if (blurs) {
    own = distance;
    std::vector<WeighedValue> moved = objects;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const double blur = points[numbers[k]].blur_mm;
      const double stopped = focus_detail::pupil_scale(extent.at(moved[k].film_point));
      if (blur != 0) moved[k].value += blur / (per_inverse * stopped);
      if (!(moved[k].value >= farthest && moved[k].value <= nearest)) {
        throw Error(point_name(numbers[k]) + "a blur of " + to_text(blur) +
                    " mm moves the surface to 1 / distance = " + to_text(moved[k].value) + " / mm; must be " +
                    to_text(farthest) + " to " + to_text(nearest) + " / mm, in front of the front focal plane");
      }
    }
    distance = field(moved);
  }
  fields_ = std::make_shared<const Fields>(
      Fields{origin_z, fixes_distance, per_inverse, std::move(distance), extent, std::move(own)});
}

bool FocalSurface::fixes_distance() const noexcept { return fields_->fixes_distance; }
double FocalSurface::origin_z() const noexcept { return fields_->origin_z; }

FocalSurface::Values FocalSurface::at(const FilmPoint& position) const noexcept {
  Values values{fields_->distance.at(position), fields_->extent.at(position), 0};
  if (fields_->objects) {
    const double stopped = focus_detail::pupil_scale(values.extent_stops);
    values.blur_mm = fields_->blur_per_inverse * stopped * (values.inverse_distance - fields_->objects->at(position));
  }
  return values;
}

FocalSurface::Slopes FocalSurface::slopes(const FilmPoint& position) const noexcept {
  return {at(position), fields_->distance.slopes(position), fields_->extent.slopes(position)};
}

template <class T>
void FocalSurface::at(std::size_t count, const T* film_x, const T* film_y, T* inverse_distances,
                      T* extents) const noexcept {
  fields_->distance.at(count, film_x, film_y, inverse_distances);
  if (extents) fields_->extent.at(count, film_x, film_y, extents);
}
template PETZVAL_API void FocalSurface::at(std::size_t, const float*, const float*, float*, float*) const noexcept;
template PETZVAL_API void FocalSurface::at(std::size_t, const double*, const double*, double*, double*) const noexcept;

template <class T>
void FocalSurface::frame(const Film& film, int threads, T* inverse_distances, T* extents) const {
  const auto columns = static_cast<std::size_t>(std::max(film.columns, 0));
  const auto rows = static_cast<std::size_t>(std::max(film.rows, 0));
  parallel_for(rows, 8, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<T> x(columns), y(columns);
    for (std::size_t c = 0; c < columns; ++c) {
      x[c] = static_cast<T>(film.point(static_cast<double>(c) + 0.5, 0).x);
    }
    for (std::size_t r = begin; r < end; ++r) {
      std::fill(y.begin(), y.end(), static_cast<T>(film.point(0, static_cast<double>(r) + 0.5).y));
      at(columns, x.data(), y.data(), inverse_distances + r * columns, extents ? extents + r * columns : nullptr);
    }
  });
}
template PETZVAL_API void FocalSurface::frame(const Film&, int, float*, float*) const;
template PETZVAL_API void FocalSurface::frame(const Film&, int, double*, double*) const;

double FocalSurface::nearest() const noexcept { return fields_->distance.most(); }
double FocalSurface::farthest() const noexcept { return fields_->distance.least(); }
double FocalSurface::least_extent() const noexcept { return fields_->extent.least(); }
double FocalSurface::most_extent() const noexcept { return fields_->extent.most(); }

std::vector<FocalPoint> focal_points(const IdealLens& lens, const Film& film, std::span<const FocusPoint> points,
                                     const FocusTime& moment, std::span<const double> fades) {
  focus_detail::check_points(points, moment);
  if (!fades.empty() && fades.size() != points.size()) {
    throw Error("focal_points: " + std::to_string(fades.size()) + " fades for " + std::to_string(points.size()) +
                " points; must be as many or 0");
  }
  const double nearest = nearest_inverse(lens),
               max_distance = camera_detail::reach_in_sides * std::sqrt(film.area_mm2());
  std::vector<FocusTarget> targets;
  std::vector<FocalPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool valid = moment.time >= points[i].from && moment.time <= points[i].until;
    const double fade = fades.empty() ? (valid ? 1 : 0) : fades[i];
    if (fade == 0) continue;
    if (!(fade > 0 && fade <= 1)) {
      throw Error("focal_points: fade " + std::to_string(i) + " = " + to_text(fade) + "; must be 0 to 1");
    }
    const auto target = focus_detail::target_at(lens, points[i], moment);
    const auto image = target ? lens.image(target->point) : std::nullopt;
    const auto position = image ? chief_point(*image, film) : std::nullopt;
    if (!position || !(std::abs(position->x) <= max_distance && std::abs(position->y) <= max_distance)) continue;
    FocalPoint point{
        .film_point = *position, .blur_mm = target->blur_mm, .extent_stops = target->extent_stops, .fade = fade};
    if (target->fixes_distance) {
      const bool at_infinity = target->point.at_infinity;
      point.inverse_distance = at_infinity ? 0 : 1 / (lens.pupils.entrance.z - target->point.position.z);
      if (!(*point.inverse_distance >= 0 && *point.inverse_distance <= nearest)) continue;
    }
    targets.push_back(*target);
    result.push_back(point);
  }
  if (moment.nearer_weighs_more) focus_detail::weigh_nearer_more(lens, targets);
  for (std::size_t k = 0; k < result.size(); ++k) result[k].weight = targets[k].weight;
  return result;
}

}  // namespace petzval
