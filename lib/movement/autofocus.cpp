// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/autofocus.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "petzval/core/bisect.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "signed_diameter.hpp"
#include "weighted_rms.hpp"

namespace petzval {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double square(double x) noexcept { return x * x; }

FilmPose upright(double film_z) noexcept { return {.film_z = film_z, .tilt_rad = 0, .swing_rad = 0}; }

/// What a target asks for.
struct Asked {
  TargetUse use = TargetUse::used;
  double film_z = nan;   ///< on which its blur is the wanted one; NaN where it has no image
  double steepness = 0;  ///< of its blur's diameter, per mm that the film is away
};

/// With the use that can be made of it.
Asked judged(const IdealLens& lens, const FocusTarget& target, Asked asked) {
  const double farthest = farthest_film * std::abs(lens.rear_focal_length);
  if (!well_formed(target)) return {TargetUse::not_finite, nan, 0};
  if (asked.use != TargetUse::used) return asked;
  if (!(std::abs(asked.film_z - lens.rear_focal_z) < farthest)) return {TargetUse::no_image, nan, 0};
  if (target.weight == 0 || asked.steepness == 0) asked.use = TargetUse::no_weight;
  return asked;
}

double largest_weight(std::span<const FocusTarget> targets, std::span<const Asked> asked) {
  double largest = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (asked[i].use == TargetUse::used) largest = std::max(largest, targets[i].weight);
  }
  return largest;
}

/// Nothing without targets that can be used.
std::optional<double> least_squares(std::span<const FocusTarget> targets, std::span<const Asked> asked) {
  const double largest = largest_weight(targets, asked);
  double weights = 0, sum = 0, from = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (asked[i].use != TargetUse::used) continue;
    if (weights == 0) from = asked[i].film_z;
    const double weight = targets[i].weight / largest * square(asked[i].steepness);
    weights += weight;
    sum += weight * (asked[i].film_z - from);
  }
  if (!(weights > 0)) return {};
  return from + sum / weights;
}

/// Films: where it stood, and what infinity is in focus on. blur_of: of a target that has an image, on a film.
struct Films {
  double before = 0, at_infinity = 0;
};
Autofocus described(const IdealLens& lens, std::span<const FocusTarget> targets, std::span<const Asked> asked,
                    const Films& films, std::optional<double> found, const auto& blur_of) {
  using enum Autofocus::Status;
  Autofocus result;
  result.status = !found ? no_targets : std::isfinite(*found) && *found > lens.rear_z ? solved : unreachable;
  result.film_z = result ? *found : films.before;

  std::vector<double> errors, weights;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double blur = std::isnan(asked[i].film_z) ? nan : blur_of(i, result.film_z);
    result.blurs.push_back({asked[i].use, targets[i].blur_mm, blur});
    if (asked[i].use != TargetUse::used) continue;
    errors.push_back(blur - targets[i].blur_mm);
    weights.push_back(targets[i].weight);
  }
  result.rms_mm = detail::weighted_rms(errors, weights);

  result.breathing = lens.growth(result.film_z, films.at_infinity);
  result.magnification_change = lens.growth(result.film_z, films.before);
  return result;
}

/// The rays of a target about their centroid.
struct Lines {
  double plane_z = 0;
  std::vector<double> x, y, slope_x, slope_y;

  explicit Lines(const PointBundle& b) : plane_z(b.plane_z), x(b.x), y(b.y), slope_x(b.slope_x), slope_y(b.slope_y) {
    for (auto* values : {&x, &y, &slope_x, &slope_y}) {
      double sum = 0;
      for (const double value : *values) sum += value;
      for (double& value : *values) value -= sum / static_cast<double>(values->size());
    }
  }
  std::size_t count() const noexcept { return x.size(); }
};

/// The mean square diameter is a parabola over the film's position: where it is least, how much it is there, how steep
/// it becomes. An even disc has an RMS radius of its diameter over the root of 8.
struct RmsBlur {
  double film_z = nan, least = 0, steepness = 0;

  explicit RmsBlur(const Lines& lines) {
    if (lines.count() == 0) return;
    double covariance = 0, variance = 0, squares = 0;
    for (std::size_t i = 0; i < lines.count(); ++i) {
      covariance += lines.x[i] * lines.slope_x[i] + lines.y[i] * lines.slope_y[i];
      variance += square(lines.slope_x[i]) + square(lines.slope_y[i]);
    }
    const double shift = -covariance / variance;
    for (std::size_t i = 0; i < lines.count(); ++i) {
      squares += square(lines.x[i] + shift * lines.slope_x[i]) + square(lines.y[i] + shift * lines.slope_y[i]);
    }
    const auto count = static_cast<double>(lines.count());
    film_z = lines.plane_z + shift;
    least = std::sqrt(8 * squares / count);
    steepness = std::sqrt(8 * variance / count);
  }
  /// Signed diameter.
  double at(double z) const noexcept {
    const double defocus = steepness * (z - film_z);
    return detail::signed_diameter(std::hypot(least, defocus), defocus);
  }
  double film_of(double wanted) const noexcept {
    if (!(std::abs(wanted) > least)) return film_z;
    return film_z + std::copysign(std::sqrt(square(wanted) - square(least)) / steepness, wanted);
  }
};

/// The largest radius of several targets, each times a scale and on a film of its own, some way from the common one.
class LargestRadius {
 public:
  void add(const Lines& lines, double scale, double shift) {
    for (std::size_t i = 0; i < lines.count(); ++i) {
      const double to_film = -lines.plane_z - shift, u = lines.slope_x[i], v = lines.slope_y[i];
      rays_.push_back({scale * (lines.x[i] + to_film * u), scale * (lines.y[i] + to_film * v), scale * u, scale * v});
    }
  }
  double at(double film_z) const noexcept { return std::sqrt(farthest(film_z).square); }
  double signed_diameter(double film_z) const noexcept { return std::copysign(2 * at(film_z), film_z - least()); }

  /// Squared radii are parabolas over the film's position, the largest of them is convex: it falls where the parabola
  /// that is largest there falls.
  double least() const noexcept {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Line& ray : rays_) {
      const double steepness = square(ray.slope_x) + square(ray.slope_y);
      if (steepness == 0) continue;
      const double vertex = -(ray.x * ray.slope_x + ray.y * ray.slope_y) / steepness;
      low = std::min(low, vertex), high = std::max(high, vertex);
    }
    if (!(low < high) || farthest(low).rises) return low;
    return detail::last_with(low, high, [&](double film_z) { return !farthest(film_z).rises; });
  }

  /// The film on the side of `wanted` where twice the radius is that much; the sharpest where it always is more.
  double film_of(double wanted) const noexcept {
    const double sharpest = least();
    const auto within = [&](double film_z) { return 2 * at(film_z) <= std::abs(wanted); };
    if (wanted == 0) return sharpest;
    double away = wanted;
    while (within(sharpest + away)) away *= 2;
    return detail::last_with(sharpest, sharpest + away, within);
  }

 private:
  struct Line {
    double x = 0, y = 0, slope_x = 0, slope_y = 0;  // where z = 0
  };
  struct Farthest {
    double square = -1;
    bool rises = false;
  };
  Farthest farthest(double film_z) const noexcept {
    Farthest result;
    for (const Line& ray : rays_) {
      const double x = ray.x + film_z * ray.slope_x, y = ray.y + film_z * ray.slope_y;
      const double radius2 = square(x) + square(y);
      if (radius2 > result.square) result = {radius2, x * ray.slope_x + y * ray.slope_y > 0};
    }
    return result;
  }

  std::vector<Line> rays_;
};

}  // namespace

std::string_view name(Autofocus::Status status) noexcept {
  switch (status) {
    case Autofocus::Status::solved: return "solved";
    case Autofocus::Status::no_targets: return "no_targets";
    case Autofocus::Status::unreachable: return "unreachable";
  }
  return "unknown";
}

Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, double film_z) {
  if (!std::isfinite(film_z)) {
    throw Error("autofocus: the film stands at z = " + number(film_z) + " mm, wanted a finite place");
  }
  std::vector<Asked> asked;
  std::vector<std::optional<ImagePoint>> images;
  for (const FocusTarget& target : targets) {
    const auto image = images.emplace_back(lens.image(target.place));
    Asked asks{.use = image ? TargetUse::used : TargetUse::no_image};
    if (image) {
      asks.film_z = image->position.z + (image->cone > 0 ? target.blur_mm / image->cone : 0);
      asks.steepness = image->cone;
    }
    asked.push_back(judged(lens, target, asks));
  }
  return described(lens, targets, asked, {film_z, lens.rear_focal_z}, least_squares(targets, asked),
                   [&](std::size_t i, double z) { return signed_blur(*images[i], upright(z)); });
}

Autofocus autofocus(const PointBundles& lens, std::span<const FocusTarget> targets, FocusCriterion criterion) {
  if (criterion != FocusCriterion::min_rms && criterion != FocusCriterion::min_max) {
    throw Error("autofocus: criterion is " + std::string(name(criterion)) +
                ", wanted min_rms or min_max, or an ideal lens");
  }
  const bool rms = criterion == FocusCriterion::min_rms;
  std::vector<Asked> asked;
  std::vector<RmsBlur> blurs;
  std::vector<LargestRadius> radii;
  std::vector<Lines> lines;
  for (const FocusTarget& target : targets) {
    const PointBundle bundle = lens.bundle(target.place);
    const RmsBlur& blur = blurs.emplace_back(lines.emplace_back(bundle));
    LargestRadius& radius = radii.emplace_back();
    Asked asks{.use = TargetUse::used, .film_z = nan, .steepness = blur.steepness};
    if (bundle.empty()) {
      asks.use = lens.ideal().image(target.place) ? TargetUse::no_rays : TargetUse::no_image;
    } else if (blur.film_z > lens.ideal().rear_z) {  // else rays run apart behind the lens
      asks.film_z = blur.film_of(target.blur_mm);
      if (!rms) radius.add(lines.back(), 1, 0);
    }
    asked.push_back(judged(lens.ideal(), target, asks));
  }

  std::optional<double> found = least_squares(targets, asked);
  if (!rms && found) {
    const double largest = largest_weight(targets, asked);
    LargestRadius all;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (asked[i].use != TargetUse::used) continue;
      const double wanted = targets[i].blur_mm;
      all.add(lines[i], targets[i].weight / largest, wanted == 0 ? 0 : radii[i].film_of(wanted) - radii[i].least());
    }
    found = all.least();
  }
  const Lines far(lens.bundle({{0, 0, -1}, true}));
  double at_infinity = RmsBlur(far).film_z;
  if (!rms && far.count() > 0) {
    LargestRadius radius;
    radius.add(far, 1, 0);
    at_infinity = radius.least();
  }
  return described(lens.ideal(), targets, asked, {lens.lens().film_z(), at_infinity}, found,
                   [&](std::size_t i, double z) { return rms ? blurs[i].at(z) : radii[i].signed_diameter(z); });
}

std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                        const Vec3<double>& half_height, int columns, int rows) {
  if (columns < 1 || rows < 1) {
    throw Error("region_targets: " + std::to_string(columns) + " x " + std::to_string(rows) +
                " targets, wanted 1 x 1 or more");
  }
  std::vector<FocusTarget> targets;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double across = (2 * column + 1.0) / columns - 1, up = (2 * row + 1.0) / rows - 1;
      FocusTarget& target = targets.emplace_back();
      target.place.position = centre + half_width * across + half_height * up;
    }
  }
  return targets;
}

}  // namespace petzval
