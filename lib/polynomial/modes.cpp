// SPDX-License-Identifier: Apache-2.0
#include "modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace petzval::polynomial_detail {

FitModes find_modes(const std::vector<std::vector<double>>& coefficients, const std::array<double, 2>& tolerances) {
  using Eigen::Index;
  const auto count = static_cast<Index>(coefficients.size()), each = static_cast<Index>(coefficients[0].size());
  Eigen::MatrixXd all(each, count);
  for (Index w = 0; w < count; ++w) {
    all.col(w) = Eigen::Map<const Eigen::VectorXd>(coefficients[static_cast<std::size_t>(w)].data(), each);
  }
  const Eigen::VectorXd mean = all.rowwise().mean();

  // Scales the residual of each fit by its tolerance.
  Eigen::MatrixXd left = all.colwise() - mean;
  left.topRows(each / 2) /= tolerances[0];
  left.bottomRows(each - each / 2) /= tolerances[1];
  // The lazy product has the same bits on every processor; a blocked product sums in an order that depends on the cache
  // sizes.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(left.transpose().lazyProduct(left));

  FitModes result;
  result.weights.resize(coefficients.size(), {1});
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
