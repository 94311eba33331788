// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace petzval::core_detail {

/// Turns a matrix by Householder's reflections until its first columns are a triangle: R of their QR decomposition, and
/// what is below it is not set; the columns behind them turn along. With at least as many rows as columns, least
/// squares keep their solutions and all columns their products with each other.
///
/// Eigen's decompositions and products of large matrices sum in blocks that the processor's caches choose, and so have
/// other bits on another processor. This has not.
void to_triangle(Eigen::Ref<Eigen::MatrixXd> matrix, Eigen::Index columns);

}  // namespace petzval::core_detail
