// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/plane_fit.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/sphere_manifold.h>

#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace petzval {
namespace {

void validate(std::span<const PlanePoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [p, weight] = points[i];
    const std::string where = "fit_plane: point " + std::to_string(i) + ": ";
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw Error(where + "position is (" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) +
                  ") mm, wanted finite coordinates");
    }
    if (!std::isfinite(weight) || weight < 0) {
      throw Error(where + "weight is " + number(weight) + ", wanted a finite one of 0 or more");
    }
  }
}

/// The points that count, relative to their centroid and divided by `scale`, so that none lies farther than 1 from it;
/// weights by the largest of them. What follows then works on numbers near 1, in whatever unit and wherever the points
/// were.
struct Cloud {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double scale = 0;
  Eigen::Matrix<double, Eigen::Dynamic, 3> points;
  Eigen::VectorXd weights;
};

Cloud centred(std::span<const PlanePoint> points) {
  const auto count = std::count_if(points.begin(), points.end(), [](const PlanePoint& p) { return p.weight > 0; });
  Cloud cloud;
  cloud.points.resize(count, 3);
  cloud.weights.resize(count);
  if (count == 0) return cloud;
  Eigen::Index row = 0;
  for (const auto& [p, weight] : points) {
    if (weight == 0) continue;
    cloud.points.row(row) << p.x, p.y, p.z;
    cloud.weights[row++] = weight;
  }
  cloud.weights /= cloud.weights.maxCoeff();

  // Differences first: a mean of the coordinates themselves would drown a small spread far from the origin.
  const Eigen::RowVector3d first = cloud.points.row(0);
  cloud.points.rowwise() -= first;
  const Eigen::RowVector3d mean = (cloud.weights.transpose() * cloud.points) / cloud.weights.sum();
  cloud.points.rowwise() -= mean;
  cloud.centroid = (first + mean).transpose();
  cloud.scale = cloud.points.cwiseAbs().maxCoeff();
  if (!std::isfinite(cloud.scale))
    throw Error("fit_plane: the points are too far apart for their distances to be finite");
  if (cloud.scale > 0) cloud.points /= cloud.scale;
  return cloud;
}

/// Weighted distance of a point from the plane normal . p = offset.
struct PlaneDistance {
  Eigen::Vector3d point;
  double root_weight;

  template <class T>
  bool operator()(const T* normal, const T* offset, T* residual) const {
    residual[0] = root_weight * (normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2] - offset[0]);
    return true;
  }
};

}  // namespace

PlaneFit fit_plane(std::span<const PlanePoint> points) {
  validate(points);
  const Cloud cloud = centred(points);
  PlaneFit fit;
  fit.point = {cloud.centroid.x(), cloud.centroid.y(), cloud.centroid.z()};
  if (cloud.points.rows() < 3 || cloud.scale == 0) return fit;

  // Singular values of the cloud itself: those of its covariance are squared, and could not tell 1e-9 from nothing.
  const Eigen::VectorXd root_weights = cloud.weights.cwiseSqrt();
  const Eigen::Matrix<double, Eigen::Dynamic, 3> weighted = root_weights.asDiagonal() * cloud.points;
  const Eigen::JacobiSVD<Eigen::Matrix<double, Eigen::Dynamic, 3>> svd(weighted,
                                                                       Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Vector3d spread = svd.singularValues();
  constexpr double smallest = 1e-9;
  if (spread[1] <= smallest * spread[0] || spread[1] - spread[2] <= smallest * spread[0]) return fit;

  Eigen::Vector3d normal = svd.matrixV().col(2);
  double offset = 0;
  ceres::Problem problem;
  problem.AddParameterBlock(normal.data(), 3, new ceres::SphereManifold<3>);
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PlaneDistance, 1, 3, 1>(
                                 new PlaneDistance{cloud.points.row(i).transpose(), root_weights[i]}),
                             nullptr, normal.data(), &offset);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-13;
  options.parameter_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  normal.normalize();
  if (normal.z() < 0) {
    normal = -normal;
    offset = -offset;
  }
  fit.status =
      summary.termination_type == ceres::CONVERGENCE ? PlaneFit::Status::solved : PlaneFit::Status::not_converged;
  fit.normal = {normal.x(), normal.y(), normal.z()};
  const Eigen::VectorXd distances = (cloud.points * normal).array() - offset;
  fit.rms_distance = cloud.scale * std::sqrt(cloud.weights.dot(distances.cwiseAbs2()) / cloud.weights.sum());
  return fit;
}

}  // namespace petzval
