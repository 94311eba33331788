// SPDX-License-Identifier: Apache-2.0
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "core/bisect.hpp"
#include "tilt_problem.hpp"

namespace petzval::fit_detail {
namespace {

/// Films as functions of the parameters, relative to an origin: z, and slopes times spreads.
class FilmChart {
 public:
  FilmChart(const TiltSpace& space, const FilmSlopes& origin, int parameters)
      : origin_(origin), by_parameters_(Eigen::Matrix3d::Zero()), parameters_(parameters) {
    const FilmSlopes along = space.film(0, 1 / space.spread_along, 0),
                     across = space.film(0, 0, 1 / space.spread_across);
    by_parameters_ << 1, 0, 0, 0, along.p, across.p, 0, along.q, across.q;
  }
  int parameters() const noexcept { return parameters_; }
  /// Derivatives of z, p and q with respect to the parameters.
  auto by_parameters() const noexcept { return by_parameters_.leftCols(parameters_); }
  FilmSlopes operator()(const double* t) const noexcept {
    const Eigen::Vector3d step = by_parameters() * Eigen::Map<const Eigen::VectorXd>(t, parameters_);
    return {origin_.z + step[0], origin_.p + step[1], origin_.q + step[2]};
  }

 private:
  FilmSlopes origin_;
  Eigen::Matrix3d by_parameters_;
  int parameters_;
};

/// A penalty on slopes; its square grows from 0 to `strength` at the slope limit.
class Restraint final : public BlurErrors {
 public:
  Restraint(const TiltSpace& space, double strength) : root_(std::sqrt(strength)) {
    along_ = space.film(0, 1 / space.largest_slope, 0);
    if (space.parameters > 2) across_ = space.film(0, 0, 1 / space.largest_slope_across);
  }
  int rows() const noexcept override { return 2; }
  bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const override {
    errors[0] = root_ * (along_.p * film.p + along_.q * film.q);
    errors[1] = root_ * (across_.p * film.p + across_.q * film.q);
    if (derivatives) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{derivatives} << 0, along_.p, along_.q,  //
          0, across_.p, across_.q;
      Eigen::Map<Eigen::Matrix<double, 6, 1>>{derivatives} *= root_;
    }
    return true;
  }

 private:
  FilmSlopes along_, across_;
  double root_;
};

/// Error of a film whose front the rays do not reach: so large that the solver rejects the step.
constexpr double unreachable_cost = 1e100;

class ChartedErrors final : public ceres::CostFunction {
 public:
  ChartedErrors(const BlurErrors& errors, const FilmChart& chart) : errors_(errors), chart_(chart) {
    set_num_residuals(errors.rows());
    mutable_parameter_block_sizes()->push_back(chart.parameters());
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const FilmSlopes film = chart_(parameters[0]);
    const int rows = errors_.rows(), columns = chart_.parameters();
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, most_rows, 3> by_film(rows, 3);
    const bool with_derivatives = jacobians && jacobians[0];
    // Ceres prints a message if an evaluation fails or a number is not finite.
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!errors_(film, residuals, with_derivatives ? by_film.data() : nullptr) ||
        !std::all_of(residuals, residuals + rows, finite)) {
      std::fill_n(residuals, rows, unreachable_cost);
      by_film.setZero();
    }
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (with_derivatives) Eigen::Map<Rows>(jacobians[0], rows, columns) = by_film * chart_.by_parameters();
    return true;
  }

 private:
  const BlurErrors& errors_;
  const FilmChart& chart_;
};

/// The normal equations of a sum of squares at a film.
struct NormalEquations {
  Eigen::Matrix3d products = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};
/// nullopt if the rays do not reach the front of the film.
std::optional<NormalEquations> normal_equations(std::span<const BlurErrors* const> errors, const FilmChart& chart,
                                                const FilmSlopes& film) {
  const int columns = chart.parameters();
  NormalEquations result;
  result.products.topLeftCorner(columns, columns).setZero();
  for (const BlurErrors* error : errors) {
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_rows, 1> values(error->rows());
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, most_rows, 3> by_film(error->rows(), 3);
    if (!(*error)(film, values.data(), by_film.data())) return {};
    const auto by = (by_film * chart.by_parameters()).eval();
    result.products.topLeftCorner(columns, columns) += by.transpose() * by;
    result.gradient.head(columns) += by.transpose() * values;
  }
  return result;
}

/// Gauss-Newton steps without a test of descent: differences between films below half of the digits do not change the
/// sum of squares, but they change the gradient.
FilmSlopes polished(std::span<const BlurErrors* const> errors, const FilmChart& chart) {
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();
  for (int i = 0; i < 8; ++i) {
    const FilmSlopes film = chart(solution.data());
    const auto equations = normal_equations(errors, chart, film);
    if (!equations) return film;
    const Eigen::Vector3d step = equations->products.ldlt().solve(equations->gradient);
    constexpr double coarse_step = 1e-6, rounding = 1e-13;
    if (!(step.norm() < coarse_step)) break;
    solution -= step;
    if (step.norm() < rounding) break;
  }
  return chart(solution.data());
}

/// Moves `film` to the least sum of losses over the first parameters. Returns false, and leaves `film` unchanged, if
/// the search does not converge.
bool minimise(std::span<const BlurErrors* const> errors, std::span<ceres::LossFunction* const> losses,
              const TiltSpace& space, int parameter_count, FilmSlopes& film) {
  const FilmChart chart(space, film, parameter_count);
  double parameters[3] = {0, 0, 0};
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    problem.AddResidualBlock(new ChartedErrors(*errors[i], chart), losses.empty() ? nullptr : losses[i], parameters);
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
  if (summary.termination_type != ceres::CONVERGENCE || !(summary.final_cost < unreachable_cost)) return false;
  film = chart(parameters);
  if (losses.empty()) film = polished(errors, FilmChart(space, film, parameter_count));
  return true;
}

bool faces_light(std::span<const BlurErrors* const> errors, const FilmSlopes& film) {
  double values[most_rows];
  return std::all_of(errors.begin(), errors.end(), [&](const auto* error) { return (*error)(film, values, nullptr); });
}

/// Slopes divided by the limit.
double fraction_of_limit(const TiltSpace& space, const FilmSlopes& film) {
  const double along = space.along(film) / space.largest_slope;
  return space.parameters < 3 ? std::abs(along) : std::hypot(along, space.across(film) / space.largest_slope_across);
}

/// The minimum of a sum of squares within the slope limit, starting at a film nearby. Each Gauss-Newton step goes to
/// the best film within the limit by the latest normal equations. nullopt if the steps do not become shorter quickly;
/// if they do, they end at a minimum, because the neglected second derivatives are small.
std::optional<TiltSolution> least_nearby(std::span<const BlurErrors* const> errors, const TiltSpace& space,
                                         FilmSlopes film) {
  TiltSolution result;
  result.converged = true;
  const double along = space.spread_along * space.largest_slope,
               across = space.spread_across * space.largest_slope_across;
  const Eigen::Vector3d cost(0, 1 / (along * along), space.parameters > 2 ? 1 / (across * across) : 0);
  double last = std::numeric_limits<double>::infinity();
  for (;;) {
    const FilmChart chart(space, film, space.parameters);
    const auto equations = normal_equations(errors, chart, film);
    if (!equations) return {};
    const Eigen::Vector3d here(film.z, space.spread_along * space.along(film),
                               space.spread_across * space.across(film));
    const auto step_at = [&](double price) -> Eigen::Vector3d {
      const Eigen::Vector3d prices = price * cost;
      const Eigen::Matrix3d products = equations->products + Eigen::Matrix3d(prices.asDiagonal());
      return products.ldlt().solve(-equations->gradient - prices.cwiseProduct(here));
    };
    const auto exceeds_limit = [&](double price) {
      const Eigen::Vector3d there = here + step_at(price);
      return there.dot(cost.cwiseProduct(there)) > 1;
    };
    result.limited = exceeds_limit(0);
    result.restraint = 0;
    if (result.limited) {
      double high = along * along;
      while (exceeds_limit(high)) high *= 4;
      result.restraint = core_detail::last_with(0.0, high, exceeds_limit);
    }
    const Eigen::Vector3d step = step_at(result.restraint);
    film = chart(step.data());
    constexpr double rounding = 1e-13, stalled_step = 1e-10;
    const double length = step.norm();
    if (length < rounding || (length < stalled_step && length > last / 2)) break;
    if (!(length < last / 2)) return {};
    last = length;
  }
  result.film = film;
  return result;
}

}  // namespace

TiltSolution least_blur(std::span<const BlurErrors* const> errors, const TiltSpace& space, const TiltSolution& start) {
  TiltSolution result = start;
  for (int i = 0; i < 60 && !faces_light(errors, result.film); ++i) result.film.p /= 2, result.film.q /= 2;
  if (space.parameters == 1 || space.largest_slope == 0) {
    result.film.p = result.film.q = 0;
    result.converged = minimise(errors, {}, space, 1, result.film);
    result.restraint = 0;
    result.limited = space.parameters > 1;
    return result;
  }

  if (start.converged) {
    if (const auto nearby = least_nearby(errors, space, result.film)) return *nearby;
  }

  const auto bring_to_limit = [&] {
    const double fraction = fraction_of_limit(space, result.film);
    const double along = space.along(result.film) / fraction, across = space.across(result.film) / fraction;
    result.film = space.film(result.film.z, along, space.parameters > 2 ? across : 0);
  };
  if (fraction_of_limit(space, result.film) > 1) bring_to_limit();

  // The best film within the limit is either the unrestricted minimum or lies on the limit. A film on the limit is also
  // the unrestricted minimum with a penalty on squared slopes, whose factor (the price) is the Lagrange multiplier.
  // Slopes decrease monotonically with the price, and their reciprocals are nearly linear in the price. Unlike an angle
  // along the limit, the price has a single solution, which is continuous in the targets even if the unrestricted
  // minimum is far away.
  const double wide = std::max(space.spread_along, space.spread_across) * space.largest_slope;
  const double scale = wide * wide;  // price that approximately halves the slopes
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double dear = infinity, cheap = -1, last_price = 0, last_excess = 0;
  double& price = result.restraint;
  for (int step = 0; step < 100; ++step) {
    const Restraint restraint(space, price);
    std::vector<const BlurErrors*> all(errors.begin(), errors.end());
    if (price > 0) all.push_back(&restraint);
    result.converged = minimise(all, {}, space, space.parameters, result.film);
    // If the search diverged, the slopes exceeded the limit.
    const double excess = result.converged ? 1 - std::min(1 / fraction_of_limit(space, result.film), 1e100) : 1;
    if (price == 0 && excess <= 1e-14) {
      result.limited = false;
      return result;
    }
    (excess > 0 ? cheap : dear) = price;
    if (std::abs(excess) < 1e-10 || dear * (1 - 1e-14) <= cheap) break;
    const double straight = (last_excess - excess) / (price - last_price);
    const double slope = step > 0 && straight > 0 ? straight : (1 - std::min(excess, 0.999)) / (price + scale);
    last_price = price, last_excess = excess;
    double next = price + excess / slope;
    if (!(next > cheap && next < dear))
      next = dear < infinity ? (std::max(cheap, 0.0) + dear) / 2 : 4 * (price + scale);
    if (cheap < 0 && next < 1e-3 * scale) next = 0;
    price = next;
  }
  result.limited = true;
  bring_to_limit();
  result.converged = result.converged && minimise(errors, {}, space, 1, result.film);
  return result;
}

std::optional<FilmSlopes> least_tukey_loss(std::span<const BlurErrors* const> errors, std::span<const double> weights,
                                           const TiltSpace& space, const FilmSlopes& start, double reach) {
  ceres::TukeyLoss tukey(reach);
  std::vector<std::unique_ptr<ceres::ScaledLoss>> owned;
  std::vector<ceres::LossFunction*> losses;
  for (const double weight : weights) {
    owned.push_back(std::make_unique<ceres::ScaledLoss>(&tukey, weight, ceres::DO_NOT_TAKE_OWNERSHIP));
    losses.push_back(owned.back().get());
  }
  FilmSlopes film = start;
  if (!minimise(errors, losses, space, space.parameters, film)) return {};
  return film;
}

}  // namespace petzval::fit_detail
