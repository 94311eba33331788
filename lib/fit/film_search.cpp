// SPDX-License-Identifier: Apache-2.0
// Gauss-Newton steps over the three parameters of a film, within the slope limit. A step that does not reduce the
// errors is damped, as by Levenberg and Marquardt.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>

#include "core/bisect.hpp"
#include "tilt_problem.hpp"

namespace petzval::fit_detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The normal equations of the errors at a film. Parameters that are not fitted have the rows of an identity matrix.
struct NormalEquations {
  Matrix3d products = Matrix3d::Identity();
  Vector3d gradient = Vector3d::Zero();
  double squares = 0;  ///< sum of the squared errors
};

/// nullopt if the rays do not reach the front of the film, or the errors are not finite.
std::optional<NormalEquations> normal_equations(std::span<const BlurErrors* const> errors, const TiltSpace& space,
                                                int parameters, const Vector3d& at) {
  NormalEquations result;
  result.products.topLeftCorner(parameters, parameters).setZero();
  const auto by_parameters = space.by_parameters().leftCols(parameters).eval();
  const FilmSlopes film = space.film(at);
  for (const BlurErrors* error : errors) {
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_rows, 1> values(error->rows());
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, most_rows, 3> by_film(error->rows(), 3);
    if (!(*error)(film, values.data(), by_film.data())) return {};
    const auto by = (by_film * by_parameters).eval();
    result.products.topLeftCorner(parameters, parameters) += by.transpose() * by;
    result.gradient.head(parameters) += by.transpose() * values;
    result.squares += values.squaredNorm();
  }
  if (!std::isfinite(result.squares)) return {};
  return result;
}

/// A step to the best film within the slope limit, by the quadratic model of the errors.
struct Step {
  Vector3d by;
  bool limited = false;
};

/// @param cost the allowed films satisfy: sum of cost * parameter^2 at most 1
Step best_step(const NormalEquations& equations, double damping, const Vector3d& here, const Vector3d& cost) {
  // On the limit, the best film is the minimum with a penalty on squared slopes, whose factor (the price) is the
  // Lagrange multiplier. The slopes fall as the price rises.
  const auto step_at = [&](double price) -> Vector3d {
    const Vector3d prices = price * cost;
    const Vector3d diagonal = prices.array() + damping;
    const Matrix3d products = equations.products + Matrix3d(diagonal.asDiagonal());
    return products.ldlt().solve(-equations.gradient - prices.cwiseProduct(here));
  };
  const auto exceeds_limit = [&](double price) {
    const Vector3d there = here + step_at(price);
    return there.dot(cost.cwiseProduct(there)) > 1;
  };
  if (!exceeds_limit(0)) return {step_at(0)};
  double high = 1 / cost.maxCoeff();
  while (exceeds_limit(high)) high *= 4;
  return {step_at(core_detail::last_with(0.0, high, exceeds_limit)), true};
}

}  // namespace

TiltSolution least_blur(std::span<const BlurErrors* const> errors, const TiltSpace& space, const FilmSlopes& start) {
  const bool upright = space.parameters == 1 || space.largest_slope == 0;
  const int parameters = upright ? 1 : space.parameters;
  Vector3d here = space.parameters_of(start), cost = Vector3d::Zero();
  here.tail(3 - parameters).setZero();
  for (int i = 1; i < parameters; ++i) {
    const double limit =
        i == 1 ? space.spread_along * space.largest_slope : space.spread_across * space.largest_slope_across;
    cost[i] = 1 / (limit * limit);
  }
  here.tail<2>() /= std::sqrt(std::max(here.dot(cost.cwiseProduct(here)), 1.0));
  auto equations = normal_equations(errors, space, parameters, here);
  for (int i = 0; i < 60 && !equations; ++i) {  // a film that the rays do not meet becomes more upright
    here.tail<2>() /= 2;
    equations = normal_equations(errors, space, parameters, here);
  }
  TiltSolution result;
  double damping = 0, last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 200 && equations && !result.converged; ++i) {
    const Step step = best_step(*equations, damping, here, cost);
    const double length = step.by.norm();
    const auto next = normal_equations(errors, space, parameters, here + step.by);
    // Films closer than half of the digits have the same sum of squares, but different gradients.
    constexpr double coarse = 1e-6, stalled = 1e-10, rounding = 1e-13;
    if (next && (next->squares < equations->squares || length < coarse)) {
      result.converged = length < rounding || (length < stalled && length > last / 2);
      result.limited = upright ? space.parameters > 1 : step.limited;
      here += step.by, equations = next, last = length;
      damping = damping > 1e-6 ? damping / 10 : 0;
    } else {
      damping = damping > 0 ? 4 * damping : 1e-3;
    }
  }
  result.film = space.film(here);
  return result;
}

}  // namespace petzval::fit_detail
