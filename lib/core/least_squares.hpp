// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "petzval/core/config.hpp"

namespace petzval::core_detail {

/// The x that minimises |rows * x - values|; the shortest such x if columns are linearly dependent to 1e-9.
PETZVAL_API Eigen::VectorXd least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values);

}  // namespace petzval::core_detail
