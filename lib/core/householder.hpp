// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace petzval::core_detail {

/// Reduces the first columns of a matrix to upper-triangular form by Householder reflections and applies the
/// reflections to the rest. The triangle is R of the QR decomposition; entries below it are undefined. If there are at
/// least as many rows as columns, least-squares solutions and the scalar products of all columns are preserved.
///
/// The result is the same on every processor. Eigen's decompositions and products of large matrices sum in blocks whose
/// size depends on the processor's caches, so that their last bits differ between processors.
void to_triangle(Eigen::Ref<Eigen::MatrixXd> matrix, Eigen::Index columns);

}  // namespace petzval::core_detail
