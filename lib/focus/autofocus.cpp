// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/autofocus.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/bisect.hpp"
#include "core/text.hpp"
#include "focus/image.hpp"
#include "focus/image_rays.hpp"
#include "petzval/core/error.hpp"
#include "pupil/trace_rays.hpp"
#include "signed_diameter.hpp"
#include "targets.hpp"

namespace petzval {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double square(double x) noexcept { return x * x; }

Film moved(Film film, double z) noexcept {
  film.z_mm = z;
  return film;
}

/// The film before the move, with its position set. Throws Error if the film is tilted or its position is not finite.
Film standing(const Film& film, double unset_z) {
  const double z = film.z_mm.value_or(unset_z);
  if (!std::isfinite(z)) throw Error("autofocus: film: z = " + to_text(z) + " mm; must be finite");
  if (film.tilted()) {
    throw Error("autofocus: film: tilt_rad, swing_rad = " + to_text(film.tilt_rad) + ", " + to_text(film.swing_rad) +
                "; must be 0");
  }
  return moved(film, z);
}

/// The film position for one target.
struct Request {
  TargetStatus status = TargetStatus::used;
  double film_z = nan;   ///< position at which the blur equals the target's blur; NaN if there is no image
  double steepness = 0;  ///< derivative of the blur diameter with respect to the film position
};

/// Checks the target of a request and returns the request; film_z is NaN if the target is rejected.
Request checked(const IdealLens& lens, const FocusTarget& target, Request request) {
  const double farthest = focus_detail::farthest_film * std::abs(lens.rear_focal_length);
  if (!focus_detail::well_formed(target)) return {TargetStatus::not_finite, nan, 0};
  if (request.status != TargetStatus::used) return request;
  if (!(std::abs(request.film_z - lens.rear_focal_z) < farthest)) return {TargetStatus::no_image, nan, 0};
  if (target.weight == 0 || !target.fixes_distance || request.steepness == 0) request.status = TargetStatus::no_weight;
  return request;
}

double largest_weight(std::span<const FocusTarget> targets, std::span<const Request> requests) {
  double largest = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (requests[i].status == TargetStatus::used) largest = std::max(largest, targets[i].weight);
  }
  return largest;
}

/// The least-squares film position; nullopt if no target can be used.
std::optional<double> least_squares(std::span<const FocusTarget> targets, std::span<const Request> requests) {
  const double largest = largest_weight(targets, requests);
  double weights = 0, sum = 0, from = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (requests[i].status != TargetStatus::used) continue;
    if (weights == 0) from = requests[i].film_z;
    const double weight = targets[i].weight / largest * square(requests[i].steepness);
    weights += weight;
    sum += weight * (requests[i].film_z - from);
  }
  if (!(weights > 0)) return {};
  return from + sum / weights;
}

/// @param before the film before the move
/// @param infinity_z the film position that focuses infinity
/// @param blur_of the blur, on a film, of a target that has an image
Autofocus described(const IdealLens& lens, std::span<const FocusTarget> targets, std::span<const Request> requests,
                    const Film& before, double infinity_z, std::optional<double> found, const auto& blur_of) {
  using enum FocusStatus;
  Autofocus result;
  result.status = !found ? no_targets : std::isfinite(*found) && *found > lens.rear_z ? solved : unreachable;
  result.film = result ? moved(before, *found) : before;
  const double z = result.film.z(), z_before = before.z();

  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double blur = std::isnan(requests[i].film_z) ? nan : blur_of(i, result.film);
    result.blurs.push_back({requests[i].status, targets[i].blur_mm, blur});
  }
  result.rms_mm = focus_detail::rms_error(targets, result.blurs);

  result.breathing = lens.magnification_change(z, infinity_z);
  result.magnification_change = lens.magnification_change(z, z_before);
  return result;
}

/// The bundle of a scene point relative to its centroid, with weights of the sum 1; empty if no ray of the point passes
/// the lens.
RayBundle centred_bundle(const ImageRays& lens, const ScenePoint& scene_point) {
  RayBundle bundle = lens.bundle(scene_point);
  focus_detail::centre(bundle);
  return bundle;
}

/// The signed blur diameter on a film, by the criterion of the image.
double signed_diameter(const focus_detail::Image& image, double film_z) noexcept {
  const double away = film_z - image.film_z, diameter = image.diameter(film_z);
  return image.rays.empty() ? focus_detail::signed_diameter(diameter, image.slope * away)
                            : std::copysign(diameter, away);
}

/// The film position with the given signed blur diameter, or the sharpest film position if every diameter is larger.
double film_of(const focus_detail::Image& image, double target_blur) noexcept {
  if (target_blur == 0) return image.film_z;
  if (image.rays.empty()) {
    if (!(std::abs(target_blur) > image.least)) return image.film_z;
    return image.film_z +
           std::copysign(std::sqrt(square(target_blur) - square(image.least)) / image.slope, target_blur);
  }
  const auto within = [&](double film_z) { return image.diameter(film_z) <= std::abs(target_blur); };
  double away = target_blur;
  while (within(image.film_z + away)) away *= 2;
  return core_detail::last_with(image.film_z, image.film_z + away, within);
}

}  // namespace

Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, const Film& film) {
  const Film before = standing(film, lens.rear_focal_z);
  std::vector<Request> requests;
  std::vector<std::optional<ImagePoint>> images;
  for (const FocusTarget& target : targets) {
    const auto image = images.emplace_back(lens.image(target.point));
    Request request{.status = image ? TargetStatus::used : TargetStatus::no_image};
    if (image) {
      request.film_z = image->position.z + (image->diameter_per_mm > 0 ? target.blur_mm / image->diameter_per_mm : 0);
      request.steepness = image->diameter_per_mm;
    }
    requests.push_back(checked(lens, target, request));
  }
  return described(lens, targets, requests, before, lens.rear_focal_z, least_squares(targets, requests),
                   [&](std::size_t i, const Film& last) { return signed_blur(*images[i], last); });
}

Autofocus autofocus(const Lens& lens, std::span<const FocusTarget> targets, const Film& film, FocusCriterion criterion,
                    std::size_t rays) {
  return autofocus(image_rays(lens, film, targets, rays), targets, film, criterion);
}

Autofocus autofocus(const ImageRays& lens, std::span<const FocusTarget> targets, const Film& film,
                    FocusCriterion criterion) {
  if (criterion != FocusCriterion::min_rms && criterion != FocusCriterion::min_max) {
    throw Error("autofocus: criterion = " + std::string(name(criterion)) +
                "; must be min_rms or min_max, or the lens an ideal lens");
  }
  const Film before = standing(film, lens.lens().film_z());
  const bool rms = criterion == FocusCriterion::min_rms;
  std::vector<Request> requests;
  std::vector<RayBundle> bundles;
  std::vector<focus_detail::Image> images;  // by the criterion; empty for targets without an image
  for (const FocusTarget& target : targets) {
    const RayBundle& rays = bundles.emplace_back(centred_bundle(lens, target.point));
    focus_detail::Image& image = images.emplace_back();
    Request request;
    if (rays.empty()) {
      request.status = lens.ideal().image(target.point) ? TargetStatus::no_rays : TargetStatus::no_image;
    } else {
      image = focus_detail::least_rms(rays);
      request.steepness = image.slope;
      // Nearer to the lens, the rays diverge behind the lens.
      if (image.film_z > lens.ideal().rear_z) {
        request.film_z = film_of(image, target.blur_mm);
        if (!rms) image = focus_detail::least_maximum(rays);
      }
    }
    requests.push_back(checked(lens.ideal(), target, request));
  }

  std::optional<double> found = least_squares(targets, requests);
  if (!rms && found) {
    const double largest = largest_weight(targets, requests);
    RayBundle all;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (requests[i].status != TargetStatus::used) continue;
      const double scale = targets[i].weight / largest;
      const double shift = film_of(images[i], targets[i].blur_mm) - images[i].film_z;
      RayBundle& rays = bundles[i];
      for (std::size_t k = 0; k < rays.size(); ++k) {
        rays.x[k] = scale * (rays.x[k] - shift * rays.slope_x[k]);
        rays.y[k] = scale * (rays.y[k] - shift * rays.slope_y[k]);
        rays.slope_x[k] *= scale, rays.slope_y[k] *= scale;
      }
      all.plane_z = rays.plane_z;
      pupil_detail::append(all, rays);
    }
    found = focus_detail::least_maximum(std::move(all)).film_z;
  }
  const RayBundle far = centred_bundle(lens, {{0, 0, -1}, true});
  double at_infinity = nan;
  if (!far.empty()) at_infinity = (rms ? focus_detail::least_rms(far) : focus_detail::least_maximum(far)).film_z;
  return described(lens.ideal(), targets, requests, before, at_infinity, found,
                   [&](std::size_t i, const Film& last) { return signed_diameter(images[i], last.z()); });
}

std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                        const Vec3<double>& half_height, int columns, int rows) {
  constexpr std::int64_t max_targets = std::int64_t{1} << 20;
  if (columns < 1 || rows < 1 || std::int64_t{columns} * rows > max_targets) {
    throw Error("region_targets: columns x rows = " + std::to_string(columns) + " x " + std::to_string(rows) +
                "; must be at least 1 x 1 and have " + std::to_string(max_targets) + " targets at most");
  }
  std::vector<FocusTarget> targets;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double across = (2 * column + 1.0) / columns - 1, up = (2 * row + 1.0) / rows - 1;
      FocusTarget& target = targets.emplace_back();
      target.point.position = centre + half_width * across + half_height * up;
    }
  }
  return targets;
}

}  // namespace petzval
