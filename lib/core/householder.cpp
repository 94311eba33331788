// SPDX-License-Identifier: Apache-2.0
#include "householder.hpp"

#include <Eigen/Householder>

namespace petzval::core_detail {

void to_triangle(Eigen::Ref<Eigen::MatrixXd> matrix, Eigen::Index columns) {
  Eigen::RowVectorXd workspace(matrix.cols());
  for (Eigen::Index k = 0; k < columns; ++k) {
    auto column = matrix.col(k).tail(matrix.rows() - k);
    double scale = 0, diagonal = 0;
    column.makeHouseholderInPlace(scale, diagonal);
    column[0] = diagonal;
    matrix.bottomRightCorner(matrix.rows() - k, matrix.cols() - k - 1)
        .applyHouseholderOnTheLeft(column.tail(column.size() - 1), scale, workspace.data());
  }
}

}  // namespace petzval::core_detail
