// SPDX-License-Identifier: Apache-2.0
#include "tilt_rays.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace petzval::fit_detail {

RayBlur::RayBlur(const RayBundle& bundle, const TiltFrame& frame, double root, double target_blur) : root_(root) {
  const auto array = [](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::ArrayXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  const double to_frame = frame.origin.z - bundle.plane_z;
  slope_x_ = array(bundle.slope_x), slope_y_ = array(bundle.slope_y);
  x_ = (array(bundle.x) + to_frame * slope_x_ - frame.origin.x) / frame.unit;
  y_ = (array(bundle.y) + to_frame * slope_y_ - frame.origin.y) / frame.unit;
  if (target_blur == 0) return;
  // The blur on the sharpest upright film approximates the blur without defocus on any film.
  const Eigen::ArrayXd u = slope_x_ - slope_x_.mean(), v = slope_y_ - slope_y_.mean();
  const double sharpest = -(x_ * u + y_ * v).sum() / (u.square() + v.square()).sum();
  const Eigen::ArrayXd x = x_ + sharpest * slope_x_, y = y_ + sharpest * slope_y_;
  const double least = 8 * ((x - x.mean()).square() + (y - y.mean()).square()).mean();
  defocus_ = std::copysign(std::sqrt(std::max(target_blur * target_blur - least, 0.0)), target_blur);
}

bool RayBlur::operator()(const FilmSlopes& film, double* errors, double* derivatives) const {
  // A ray with slopes s from (x, y) at z = 0 meets the film at z = (z0 + p x + q y) / (1 - p s_x - q s_y). The
  // derivatives of this hit (X, Y, z) by z0, p and q are (1, X, Y) / (1 - p s_x - q s_y) times (s_x, s_y, 1).
  const Eigen::Index count = x_.size();
  const double scale = 8 / static_cast<double>(count);
  const Eigen::ArrayXd facing = 1 - film.p * slope_x_ - film.q * slope_y_;
  if (!(facing > 0).all()) return false;
  Eigen::Matrix<double, Eigen::Dynamic, 4> hits(3 * count, 4);  // derivatives by z0, p and q; then the hits
  auto columns = hits.reshaped(count, 12);                      // interleaved x, y and z
  columns.col(0) = slope_x_ / facing, columns.col(1) = slope_y_ / facing, columns.col(2) = 1 / facing;

  // Defocus changes the diameter at a rate that depends only on the slopes of the film.
  double offset = 0, offset_by_p = 0, offset_by_q = 0;
  if (defocus_ != 0) {
    const Eigen::Array<double, Eigen::Dynamic, 3> by_z = columns.leftCols<3>();
    const Eigen::Array<double, Eigen::Dynamic, 3> spread = by_z.rowwise() - by_z.colwise().mean();
    const double square = scale * spread.square().sum();
    const Eigen::ArrayXd magnification_change = (spread * by_z).rowwise().sum();
    offset = defocus_ / std::sqrt(square);
    offset_by_p = -offset * scale * (magnification_change * by_z.col(0)).sum() / square;
    offset_by_q = -offset * scale * (magnification_change * by_z.col(1)).sum() / square;
  }

  const Eigen::ArrayXd z = (film.z - offset + film.p * x_ + film.q * y_) / facing;
  const Eigen::ArrayXd x = x_ + slope_x_ * z, y = y_ + slope_y_ * z;
  columns.col(9) = x, columns.col(10) = y, columns.col(11) = z;
  if (!derivatives) {
    columns.rightCols<3>().rowwise() -= columns.rightCols<3>().colwise().mean().eval();
    std::fill_n(errors, 4, 0.0);
    errors[0] = root_ * std::sqrt(scale) * hits.col(3).norm();
    return true;
  }
  columns.middleCols<3>(3) = columns.leftCols<3>().array().colwise() * (x - offset_by_p);
  columns.middleCols<3>(6) = columns.leftCols<3>().array().colwise() * (y - offset_by_q);
  columns.rowwise() -= columns.colwise().mean().eval();
  // Reduces all hits to four errors with the same sum of squares, gradient and Gauss-Newton matrix: a square root of
  // their product matrix.
  const Eigen::Matrix4d products = scale * hits.transpose() * hits;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(products);
  const Eigen::Matrix4d rows =
      root_ * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  Eigen::Map<Eigen::Vector4d>{errors} = rows.col(3);
  Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>>{derivatives} = rows.leftCols<3>();
  return true;
}

}  // namespace petzval::fit_detail
