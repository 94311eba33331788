// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace petzval::inline v0::core_detail {

/// The x for which rows * x is nearest to the values. Where columns say the same to 1e-9, the smallest of such x.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values);

}  // namespace petzval::inline v0::core_detail
