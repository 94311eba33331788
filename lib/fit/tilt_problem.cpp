// SPDX-License-Identifier: Apache-2.0
#include "tilt_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::fit_detail {
namespace {

/// The film that focuses a plane of the scene. At a distance v behind the rear principal plane, the inverse distance is
/// (1 - f' / v) / f and the picture is -f' (X, Y) / (f v). The plane a x + b y + c of inverse distances becomes
/// v (1 - c f) = f' (1 - a X - b Y).
FilmSlopes film_of(const focus_detail::PlaneFit& fit, const IdealLens& lens, const TiltFrame& frame) {
  const double at_axis = lens.rear_focal_length / (1 - fit.c * lens.front_focal_length);
  const double p = -fit.a * at_axis, q = -fit.b * at_axis;
  const double z = lens.rear_principal_z() + at_axis + p * frame.origin.x + q * frame.origin.y;
  return {(z - frame.origin.z) / frame.unit, p, q};
}

/// Main direction and spreads of the images, and the limits of the slopes. The limits fall to 0 as the images of the
/// targets move together, and the limit across the main direction falls to 0 as the images approach a line. When the
/// plane of the targets turns through a line of sight, the film therefore changes continuously.
TiltSpace tilt_space(const focus_detail::PlaneFit& fit, std::span<const IdealBlur> blurs, double max_tilt) {
  TiltSpace space;
  space.parameters = static_cast<int>(fit.rank);
  double xx = 0, xy = 0, yy = 0;
  for (const IdealBlur& blur : blurs) {
    const double squared = blur.root * blur.root;
    xx += squared * blur.x * blur.x, xy += squared * blur.x * blur.y, yy += squared * blur.y * blur.y;
  }
  const double turn = std::atan2(2 * xy, xx - yy) / 2;
  const double ax = std::cos(turn), ay = std::sin(turn);
  const double along = std::sqrt(ax * ax * xx + 2 * ax * ay * xy + ay * ay * yy);
  const double across = std::sqrt(std::max(ay * ay * xx - 2 * ax * ay * xy + ax * ax * yy, 0.0));
  space.along_x = ax, space.along_y = ay;
  if (along > 0) {
    space.spread_along = along;
    space.spread_across = std::max(across, 1e-9 * along);
  }
  const auto faded = [](double spread, double least) { return std::clamp(spread / least - 1, 1e-6, 1.0); };
  space.largest_slope = std::tan(max_tilt) * faded(fit.spread, focus_detail::coincidence_spread);
  space.largest_slope_across = space.largest_slope * faded(fit.aspect, focus_detail::line_aspect);
  return space;
}

}  // namespace

Film TiltFrame::film(const FilmSlopes& slopes, const Film& like) const {
  const double z = origin.z + unit * slopes.z - slopes.p * origin.x - slopes.q * origin.y;
  const double length = std::hypot(slopes.p, slopes.q, 1.0);
  return film_in({Vec3<double>(0 - slopes.p, 0 - slopes.q, 1) / length, z / length}, like);
}

bool IdealBlur::operator()(const FilmSlopes& film, double* errors, double* derivatives) const noexcept {
  const double facing = 1 - film.p * slope_x - film.q * slope_y;
  if (!(facing > 0)) return false;
  const double away = (film.z + film.p * x + film.q * y - z) / facing;
  *errors = root * away;
  if (derivatives) {
    derivatives[0] = root / facing;
    derivatives[1] = root / facing * (x + slope_x * away);
    derivatives[2] = root / facing * (y + slope_y * away);
  }
  return true;
}

std::vector<ImagedTarget> imaged_targets(const IdealLens& lens, std::span<const FocusTarget> targets) {
  const double farthest = focus_detail::farthest_film * std::abs(lens.rear_focal_length), z = lens.front_principal_z();
  std::vector<ImagedTarget> result;
  result.reserve(targets.size());
  for (const FocusTarget& target : targets) {
    const ScenePoint& scene_point = target.point;
    const double blur = target.blur_mm, weight = target.fixes_distance ? target.weight : 0;
    ImagedTarget& seen = result.emplace_back();
    seen.image = lens.image(scene_point);
    if (!focus_detail::well_formed(target)) {
      seen.status = TargetStatus::not_finite;
      continue;
    }
    seen.status = TargetStatus::no_image;
    if (!seen.image) continue;
    const ImagePoint& image = *seen.image;
    const double move = blur == 0 ? 0 : blur / image.diameter_per_mm;
    seen.target_point = image.position + move * Vec3<double>(image.slope_x, image.slope_y, 1);
    seen.picture = focus_detail::picture_point(blur == 0 ? scene_point : lens.scene_of(seen.target_point), z);
    const Vec3<double> from_lens = seen.target_point - Vec3<double>(0, 0, lens.rear_focal_z);
    const double away = std::max({std::abs(from_lens.x), std::abs(from_lens.y), std::abs(from_lens.z)});
    const PicturePoint& d = seen.picture;
    const bool near = away < farthest && std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.inverse_distance);
    if (weight == 0 || image.diameter_per_mm == 0) {  // a pinhole images all distances sharply
      seen.status = TargetStatus::no_weight;
    } else if (near) {
      seen.status = TargetStatus::used;
      seen.weight = weight;
    }
  }
  return result;
}

TiltProblem tilt_problem(const IdealLens& lens, std::span<const ImagedTarget> targets, double max_tilt) {
  TiltProblem problem;
  // Cones and weights are divided by their largest values so that their squares do not overflow.
  double largest = 0, largest_cone = 0, weights = 0;
  for (const ImagedTarget& target : targets) {
    if (!(target.weight > 0)) continue;
    largest = std::max(largest, target.weight);
    largest_cone = std::max(largest_cone, target.image->diameter_per_mm);
  }
  std::vector<PicturePoint> points;
  Vec3<double> mean{0, 0, 0};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!(targets[i].weight > 0)) continue;
    problem.used.push_back(i);
    points.push_back(targets[i].picture);
    points.back().weight = targets[i].weight;
    const double cone = targets[i].image->diameter_per_mm / largest_cone,
                 weight = targets[i].weight / largest * cone * cone;
    weights += weight;
    mean += weight * targets[i].target_point;
  }
  const focus_detail::PlaneFit fit = focus_detail::fit_plane(points);
  problem.rank = fit.rank;
  if (problem.used.empty()) return problem;
  problem.frame = {mean / weights, std::abs(lens.rear_focal_length)};
  for (const std::size_t i : problem.used) {
    const Vec3<double> at = (targets[i].target_point - problem.frame.origin) / problem.frame.unit;
    IdealBlur& blur = problem.blurs.emplace_back();
    blur.x = at.x, blur.y = at.y, blur.z = at.z;
    blur.slope_x = targets[i].image->slope_x, blur.slope_y = targets[i].image->slope_y;
    blur.root = targets[i].image->diameter_per_mm / largest_cone * std::sqrt(targets[i].weight / largest / weights);
  }
  problem.space = tilt_space(fit, problem.blurs, max_tilt);

  // A plane of focus within the focal length has no film. The fit then starts from an upright film at the centroid.
  const FilmSlopes film = film_of(fit, lens, problem.frame);
  const TiltSpace& space = problem.space;
  if (1 - fit.c * lens.front_focal_length > 0 && std::isfinite(film.z + film.p + film.q)) {
    problem.start =
        space.film(film.z, space.parameters > 1 ? space.along(film) : 0, space.parameters > 2 ? space.across(film) : 0);
  }
  return problem;
}

}  // namespace petzval::fit_detail
