// SPDX-License-Identifier: Apache-2.0
#include "least_squares.hpp"

#include <Eigen/QR>

namespace petzval::core_detail {

Eigen::VectorXd least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(1e-9);
  return decomposition.compute(rows).solve(values);
}

}  // namespace petzval::core_detail
