// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "petzval/core/config.hpp"

namespace petzval::core_detail {

/// The x that minimises |rows * x - values|; the shortest such x if columns are linearly dependent to 1e-9. Each column
/// of `values` has a column of the result.
PETZVAL_API Eigen::MatrixXd least_squares(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& values);

}  // namespace petzval::core_detail
