// SPDX-License-Identifier: Apache-2.0
#include "modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace petzval::polynomial_detail {

FitModes find_modes(const std::vector<RayPolynomial::Fit>& fits, const std::vector<std::vector<double>>& coefficients) {
  using Eigen::Index;
  const auto count = static_cast<Index>(fits.size()), each = static_cast<Index>(coefficients[0].size());
  Eigen::MatrixXd all(each, count);
  for (Index w = 0; w < count; ++w) {
    all.col(w) = Eigen::Map<const Eigen::VectorXd>(coefficients[static_cast<std::size_t>(w)].data(), each);
  }
  const Eigen::VectorXd mean = all.rowwise().mean();

  // Scales the residual of each fit by its tolerance.
  constexpr double relative_tolerance = 0.05, least_rad = 5e-8;
  double most_rad = 0, most_mm = 0;
  for (const RayPolynomial::Fit& fit : fits) {
    most_rad = std::max(most_rad, fit.rms_rad), most_mm = std::max(most_mm, fit.rms_mm);
  }
  const double least_mm = least_rad * all.bottomRows(each / 2).cwiseAbs().maxCoeff();
  Eigen::MatrixXd left = all.colwise() - mean;
  left.topRows(each / 2) /= relative_tolerance * most_rad + least_rad;
  left.bottomRows(each / 2) /= relative_tolerance * most_mm + least_mm + 1e-300;
  // The lazy product has the same bits on every processor; a blocked product sums in an order that depends on the cache
  // sizes.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(left.transpose().lazyProduct(left));

  FitModes result;
  result.weights.resize(fits.size(), {1});
  const auto add = [&](const Eigen::VectorXd& mode) { result.modes.emplace_back(mode.data(), mode.data() + each); };
  add(mean);
  for (Index k = count - 1; k > 0 && result.modes.size() < most_modes; --k) {  // eigenvalues ascend
    if (left.colwise().norm().maxCoeff() <= 1) break;
    const Eigen::VectorXd direction = solver.eigenvectors().col(k);
    for (Index w = 0; w < count; ++w) {
      result.weights[static_cast<std::size_t>(w)][result.modes.size()] = direction[w];
    }
    add((all.colwise() - mean) * direction);
    left -= (left * direction) * direction.transpose();
  }
  return result;
}

}  // namespace petzval::polynomial_detail
