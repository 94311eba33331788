// SPDX-License-Identifier: Apache-2.0
// Least median of squares (Rousseeuw 1984) over films through as many targets as a film has parameters, followed by the
// nearest minimum of Tukey's loss. Blurs are not weighted here: a target is an outlier independently of its weight.
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "film_fit.hpp"
#include "fit_to_rays.hpp"

namespace petzval::fit_detail {
namespace {

/// The groups of `size` among `count` targets: all of them if there are at most `most`, otherwise a uniform subset.
std::vector<std::array<std::size_t, 3>> groups(std::size_t count, int size, std::size_t most) {
  std::vector<std::array<std::size_t, 3>> result;
  const std::size_t second = size > 1 ? count : 1, third = size > 2 ? count : 1;
  double all = static_cast<double>(count);
  if (size > 1) all *= static_cast<double>(count - 1) / 2;
  if (size > 2) all *= static_cast<double>(count - 2) / 3;
  if (all <= static_cast<double>(most)) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = size > 1 ? i + 1 : 0; j < second; ++j)
        for (std::size_t k = size > 2 ? j + 1 : 0; k < third; ++k) result.push_back({i, j, k});
    return result;
  }
  // Multiples of the powers of 1 / g with g^4 = g + 1 fill the cube uniformly. Source: Roberts 2018, "The unreasonable
  // effectiveness of quasirandom sequences".
  constexpr double step = 0.8191725133961645;
  const auto pick = [&](std::size_t n, double power) {
    const double turn = static_cast<double>(n + 1) * power;
    return std::min(static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(count)), count - 1);
  };
  for (std::size_t n = 0; n < most; ++n) {
    const std::array<std::size_t, 3> group{pick(n, step), pick(n, step * step), pick(n, step * step * step)};
    const bool distinct =
        size < 2 || (group[0] != group[1] && (size < 3 || (group[0] != group[2] && group[1] != group[2])));
    if (distinct) result.push_back(group);
  }
  return result;
}

/// The film that makes a group of targets sharp; not finite if it is not unique.
FilmSlopes film_through(std::span<const IdealBlur> blurs, const std::array<std::size_t, 3>& group,
                        const TiltSpace& space) {
  Eigen::Matrix3d rows = Eigen::Matrix3d::Identity();
  Eigen::Vector3d offsets = Eigen::Vector3d::Zero();
  for (int i = 0; i < space.parameters; ++i) {
    const IdealBlur& blur = blurs[group[static_cast<std::size_t>(i)]];
    const double along = blur.x * space.along_x + blur.y * space.along_y;
    const double across = blur.y * space.along_x - blur.x * space.along_y;
    const Eigen::RowVector3d row(1, along / space.spread_along, across / space.spread_across);
    rows.row(i).head(space.parameters) = row.head(space.parameters);
    offsets[i] = blur.z;
  }
  const Eigen::Vector3d t = rows.inverse() * offsets;
  return space.film(t[0], t[1] / space.spread_along, t[2] / space.spread_across);
}

/// The film with the least median of squared blurs, and that median.
struct LeastMedian {
  FilmSlopes film;
  double square = std::numeric_limits<double>::infinity();
};

LeastMedian least_median(std::span<const IdealBlur> blurs, const TiltSpace& space) {
  // The number of triples of 24 targets.
  constexpr std::size_t most_groups = 2024;
  const auto count = static_cast<std::ptrdiff_t>(blurs.size());
  const std::ptrdiff_t half = count / 2 + (space.parameters + 1) / 2;  // number of blurs up to the median
  LeastMedian best;
  std::vector<double> squares(blurs.size());
  for (const auto& group : groups(blurs.size(), space.parameters, most_groups)) {
    const FilmSlopes film = film_through(blurs, group, space);
    std::ptrdiff_t larger_count = 0;
    for (std::size_t i = 0; i < blurs.size() && larger_count <= count - half; ++i) {
      double blur = 0;
      squares[i] = blurs[i](film, &blur, nullptr) ? blur * blur : std::numeric_limits<double>::infinity();
      if (!(squares[i] < best.square)) ++larger_count;
    }
    if (larger_count > count - half) continue;
    std::nth_element(squares.begin(), squares.begin() + (half - 1), squares.end());
    best = {film, squares[static_cast<std::size_t>(half - 1)]};
  }
  return best;
}

/// The blur of a target as a function of the first parameters of a film.
class ParameterBlur final : public ceres::CostFunction {
 public:
  ParameterBlur(const IdealBlur& blur, const TiltSpace& space) : blur_(blur), space_(space) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(space.parameters);
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    std::copy_n(parameters[0], space_.parameters, at.data());
    Eigen::RowVector3d by_film;
    // Ceres prints a message if an evaluation fails or a number is not finite.
    if (!blur_(space_.film(at), residuals, by_film.data()) || !std::isfinite(*residuals)) {
      *residuals = unreachable, by_film.setZero();
    }
    const Eigen::RowVector3d by = by_film * space_.by_parameters();
    if (jacobians && jacobians[0]) std::copy_n(by.data(), space_.parameters, jacobians[0]);
    return true;
  }
  /// Error of a film whose front the rays do not reach: so large that the solver rejects the step.
  static constexpr double unreachable = 1e100;

 private:
  const IdealBlur& blur_;
  const TiltSpace& space_;
};

/// The film with the least Tukey loss (biweight; errors above `reach` have no weight), without a slope limit; `start`
/// if the search does not converge.
FilmSlopes least_tukey_loss(std::span<const IdealBlur> blurs, std::span<const double> weights, const TiltSpace& space,
                            const FilmSlopes& start, double reach) {
  ceres::TukeyLoss tukey(reach);
  Eigen::Vector3d parameters = space.parameters_of(start);
  ceres::Problem problem;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    problem.AddResidualBlock(new ParameterBlur(blurs[i], space),
                             new ceres::ScaledLoss(&tukey, weights[i], ceres::DO_NOT_TAKE_OWNERSHIP),
                             parameters.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  // The parameters are scaled, so the first step is not shortened. The search ends at the rounding error of numbers
  // near 1 or of the sum of squares.
  options.initial_trust_region_radius = options.max_trust_region_radius;
  options.jacobi_scaling = false;
  options.function_tolerance = 1e-13;
  options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-14;
  options.max_num_iterations = 200;
  options.max_num_consecutive_invalid_steps = options.max_num_iterations;  // Ceres prints if it gives up
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const bool found = summary.termination_type == ceres::CONVERGENCE && summary.final_cost < ParameterBlur::unreachable;
  return found ? space.film(parameters) : start;
}

/// The fraction of its weight, 0 to 1, that each target of problem.used keeps.
std::vector<double> robust_weights(const TiltProblem& problem, std::span<const ImagedTarget> targets) {
  // In units of the mean cone, to which the constant `rounding` below is relative.
  std::vector<IdealBlur> blurs = problem.blurs;
  std::vector<double> weights;
  double cones = 0;
  for (const std::size_t i : problem.used)
    cones += targets[i].image->diameter_per_mm / static_cast<double>(blurs.size());
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    const ImagedTarget& target = targets[problem.used[i]];
    blurs[i].root = target.image->diameter_per_mm / cones;
    weights.push_back(target.weight);
  }
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (double& weight : weights) weight /= largest;

  // The median for exact targets is a rounding error, which must not set the scale for outliers.
  constexpr double rounding = 1e-11;
  const LeastMedian start = least_median(blurs, problem.space);
  const double spare = static_cast<double>(blurs.size()) - problem.space.parameters;
  const double deviation = std::max(1.4826 * (1 + 5 / spare) * std::sqrt(start.square), rounding);
  const double reach = 4.685 * deviation;
  const FilmSlopes film = least_tukey_loss(blurs, weights, problem.space, start.film, reach);

  for (std::size_t i = 0; i < blurs.size(); ++i) {
    double blur = 0;
    const double relative_blur = blurs[i](film, &blur, nullptr) ? std::min(std::abs(blur) / reach, 1.0) : 1;
    weights[i] = (1 - relative_blur * relative_blur) * (1 - relative_blur * relative_blur);
  }
  return weights;
}

}  // namespace
}  // namespace petzval::fit_detail

namespace petzval {

TiltFit fit_tilt(const IdealLens& lens, std::span<const FocusTarget> targets, const TiltOptions& options) {
  return fit_detail::fit_film(lens, targets, options, fit_detail::robust_weights);
}

TiltFit fit_tilt(const ImageRays& lens, std::span<const FocusTarget> targets, const TiltOptions& options) {
  return fit_detail::fit_film(lens, targets, options, fit_detail::robust_weights);
}

TiltFit fit_tilt(const Lens& lens, std::span<const FocusTarget> targets, const TiltOptions& options) {
  return fit_tilt(image_rays(lens, options.film, targets, options.rays), targets, options);
}

}  // namespace petzval
