// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "petzval/core/export.hpp"

namespace petzval::core_detail {

/// The x for which rows * x is nearest to the values. Where columns say the same to 1e-9, the smallest of such x.
PETZVAL_API Eigen::VectorXd least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values);

}  // namespace petzval::core_detail
