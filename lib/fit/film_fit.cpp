// SPDX-License-Identifier: Apache-2.0
#include "fit/film_fit.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/text.hpp"
#include "focus/targets.hpp"
#include "petzval/core/error.hpp"
#include "tilt_rays.hpp"

namespace petzval::fit_detail {
namespace {

/// The options with film.z_mm set. Throws Error if the options are invalid.
TiltOptions checked(TiltOptions options, double unset_z) {
  if (!(options.max_tilt_rad >= 0 && options.max_tilt_rad < std::numbers::pi / 2)) {
    throw Error("fit_tilt: max_tilt_rad = " + to_text(options.max_tilt_rad) +
                "; must be at least 0 and below a quarter turn (pi/2)");
  }
  Film& film = options.film;
  film.z_mm = film.z_mm.value_or(unset_z);
  if (!std::isfinite(film.z()) || !std::isfinite(film.tilt_rad) || !std::isfinite(film.swing_rad)) {
    throw Error("fit_tilt: film: z_mm, tilt_rad, swing_rad = " + to_text(film.z()) + ", " + to_text(film.tilt_rad) +
                ", " + to_text(film.swing_rad) + "; must be finite");
  }
  const double sum = film.width_mm + film.height_mm + film.shift_x_mm + film.shift_y_mm;
  if (!(film.width_mm >= 0 && film.height_mm >= 0) || !std::isfinite(sum)) {
    throw Error("fit_tilt: film: width_mm x height_mm = " + to_text(film.width_mm) + " x " + to_text(film.height_mm) +
                ", shift = (" + to_text(film.shift_x_mm) + ", " + to_text(film.shift_y_mm) +
                "); must be finite, and the size not negative");
  }
  return options;
}

/// The point at which the chief ray of the picture centre on the film `before` meets `film`; nullopt if the ray is
/// parallel to `film`.
std::optional<FilmPoint> carried_centre(const IdealLens& lens, const Film& before, const Film& film) {
  const Vec3<double> middle = before.position({before.shift_x_mm, before.shift_y_mm});
  const double pupil_z = lens.pupils.exit.z;
  Vec3<double> line = middle - Vec3<double>(0, 0, pupil_z);
  if (!std::isfinite(pupil_z) || (middle.x == 0 && middle.y == 0)) line = {0, 0, 1};
  const Vec3<double> n = film.normal();
  const double steps = glm::dot(n, Vec3<double>(0, 0, film.z()) - middle) / glm::dot(n, line);
  if (!std::isfinite(steps)) return {};
  return film.point(middle + steps * line);
}

/// True if the film, including its corners, lies behind the lens.
bool clear_of_lens(const IdealLens& lens, const Film& film) {
  const auto corners = film.corners();
  return std::all_of(corners.begin(), corners.end(),
                     [&](const FilmPoint& corner) { return film.position(corner).z > lens.rear_z; });
}

/// The result for a solution; the given film if there is no solution.
/// @param blur_of the blur of a target on a film
TiltFit described(const IdealLens& lens, std::span<const FocusTarget> targets, const TiltOptions& options,
                  std::span<const ImagedTarget> seen, const TiltProblem& problem, const TiltSolution& solution,
                  const auto& blur_of) {
  TiltFit fit;
  fit.rank = problem.rank;
  fit.film = options.film;
  if (problem.rank == PlaneRank::none) {
    fit.status = FocusStatus::no_targets;
  } else if (!solution.converged) {
    fit.status = FocusStatus::not_converged;
  } else {
    Film film = problem.frame.film(solution.film, options.film);
    const std::optional<FilmPoint> centre = carried_centre(lens, options.film, film);
    if (centre) film.shift_x_mm = centre->x, film.shift_y_mm = centre->y;
    if (!centre || !clear_of_lens(lens, film)) {
      fit.status = FocusStatus::unreachable;
    } else {
      fit.status = solution.limited                   ? FocusStatus::limited
                   : problem.rank == PlaneRank::plane ? FocusStatus::solved
                                                      : FocusStatus::least_tilt;
      fit.film = film;
    }
  }
  fit.focus = focus_plane(lens, fit.film);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    fit.blurs.push_back({seen[i].status, targets[i].blur_mm, blur_of(i, fit.film)});
  }
  fit.rms_mm = focus_detail::rms_error(targets, fit.blurs);
  return fit;
}

/// The problem with reduced weights for outliers, or without outliers.
TiltProblem problem_without_outliers(const IdealLens& lens, std::span<ImagedTarget> seen, const TiltOptions& options,
                                     const RobustWeights& robust_weights) {
  constexpr std::size_t min_targets = 5;  // targets needed to identify an outlier
  const TiltProblem problem = tilt_problem(lens, seen, options.max_tilt_rad);
  if (!options.robust || !robust_weights || problem.used.size() < min_targets) return problem;
  const std::vector<double> kept = robust_weights(problem, seen);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ImagedTarget& target = seen[problem.used[i]];
    target.weight *= kept[i];
    if (!(target.weight > 0)) target.status = TargetStatus::outlier;
  }
  return tilt_problem(lens, seen, options.max_tilt_rad);
}

TiltSolution solved(const TiltProblem& problem) {
  if (problem.rank == PlaneRank::none) return {};
  std::vector<const BlurErrors*> errors;
  for (const auto& blur : problem.blurs) errors.push_back(&blur);
  return least_blur(errors, problem.space, problem.start);
}

}  // namespace

TiltFit fit_film(const IdealLens& lens, std::span<const FocusTarget> targets, const TiltOptions& given,
                 const RobustWeights& robust_weights) {
  const TiltOptions options = checked(given, lens.rear_focal_z);
  std::vector<ImagedTarget> seen = imaged_targets(lens, targets);
  const TiltProblem problem = problem_without_outliers(lens, seen, options, robust_weights);
  return described(lens, targets, options, seen, problem, solved(problem), [&](std::size_t i, const Film& film) {
    return seen[i].image ? signed_blur(*seen[i].image, film) : std::numeric_limits<double>::quiet_NaN();
  });
}

TiltFit fit_film(const ImageRays& lens, std::span<const FocusTarget> targets, const TiltOptions& given,
                 const RobustWeights& robust_weights) {
  const TiltOptions options = checked(given, lens.lens().film_z());
  const IdealLens& ideal = lens.ideal();
  std::vector<ImagedTarget> seen = imaged_targets(ideal, targets);
  std::vector<RayBundle> bundles(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!seen[i].image) continue;
    bundles[i] = lens.bundle(targets[i].point);
    if (bundles[i].empty() && seen[i].weight > 0) {
      seen[i].status = TargetStatus::no_rays;
      seen[i].weight = 0;
    }
  }
  const TiltProblem problem = problem_without_outliers(ideal, seen, options, robust_weights);
  const TiltSolution thick = solved(problem);
  TiltSolution solution = thick;
  if (thick.converged) {
    std::vector<RayBlur> blurs;
    std::vector<const BlurErrors*> errors;
    blurs.reserve(problem.used.size());
    for (std::size_t k = 0; k < problem.used.size(); ++k) {
      const std::size_t i = problem.used[k];
      const double root = problem.blurs[k].root / seen[i].image->diameter_per_mm;
      blurs.emplace_back(bundles[i], problem.frame, root, targets[i].blur_mm / problem.frame.unit);
      errors.push_back(&blurs.back());
    }
    solution = least_blur(errors, problem.space, thick.film);
  }
  TiltFit fit = described(ideal, targets, options, seen, problem, solution, [&](std::size_t i, const Film& film) {
    const std::optional<ExactBlur> blur = blur_on(bundles[i], film);
    return blur ? blur->signed_diameter : std::numeric_limits<double>::quiet_NaN();
  });
  // Aberrations move the film by nearly the same distance for all subjects. The plane of focus is therefore computed
  // from the film of the thick lens for the same targets.
  if (fit) fit.focus = focus_plane(ideal, problem.frame.film(thick.film, options.film));
  return fit;
}

}  // namespace petzval::fit_detail
