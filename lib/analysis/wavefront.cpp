// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/wavefront.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "core/least_squares.hpp"
#include "optical_path.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_nodes.hpp"

namespace petzval {
namespace {

/// Orders of a term: R_n^m(r) cos(m a), or sin(m a).
struct ZernikeOrder {
  int n, m;
  bool sine;
};

/// Fringe order: groups of equal n + m, in a group from large m to small m, cosine before sine.
constexpr std::array<ZernikeOrder, zernike_terms> zernike_orders() {
  std::array<ZernikeOrder, zernike_terms> orders{};
  std::size_t at = 0;
  for (int group = 0; at < zernike_terms; ++group) {
    for (int m = group; m >= 0 && at < zernike_terms; --m) {
      // The last of the 37 terms is the first of its group without azimuth.
      const int azimuth = at + 1 == zernike_terms ? 0 : m;
      orders[at++] = {2 * group - azimuth, azimuth, false};
      if (azimuth > 0 && at < zernike_terms) orders[at++] = {2 * group - azimuth, azimuth, true};
    }
  }
  return orders;
}

/// Radial polynomial R_n^m by its explicit sum.
double radial(int n, int m, double r) {
  double sum = 0;
  for (int k = (n - m) / 2; k >= 0; --k) {
    double factor = k % 2 == 0 ? 1 : -1;
    // (n - k)! / (k! ((n + m) / 2 - k)! ((n - m) / 2 - k)!)
    for (int i = 1; i <= n - k; ++i) factor *= i;
    for (int i = 1; i <= k; ++i) factor /= i;
    for (int i = 1; i <= (n + m) / 2 - k; ++i) factor /= i;
    for (int i = 1; i <= (n - m) / 2 - k; ++i) factor /= i;
    sum += factor * std::pow(r, n - 2 * k);
  }
  return sum;
}

/// Weighted fit of a plane in the directions behind the lens: the shift of the image point with the least deviation.
Eigen::VectorXd without_tilt(const Eigen::VectorXd& waves, const Eigen::VectorXd& weights,
                             const Eigen::MatrixXd& slopes) {
  Eigen::MatrixXd plane(waves.size(), 3);
  plane.col(0).setOnes();
  plane.rightCols(2) = slopes;
  const Eigen::VectorXd roots = weights.cwiseSqrt();
  const Eigen::VectorXd fit = core_detail::least_squares(roots.asDiagonal() * plane, roots.cwiseProduct(waves));
  return waves - plane * fit;
}

double deviation(const Eigen::VectorXd& waves, const Eigen::VectorXd& weights) {
  const double total = weights.sum(), mean = weights.dot(waves) / total;
  return std::sqrt(weights.dot((waves.array() - mean).square().matrix()) / total);
}

}  // namespace

double zernike_fringe(std::size_t term, const Vec2<double>& pupil) {
  if (term >= zernike_terms) throw Error("zernike_fringe: term = " + std::to_string(term) + "; must be 0 to 36");
  static constexpr auto orders = zernike_orders();
  const auto [n, m, sine] = orders[term];
  const double angle = m * std::atan2(pupil.y, pupil.x);
  return radial(n, m, std::hypot(pupil.x, pupil.y)) * (sine ? std::sin(angle) : std::cos(angle));
}

std::optional<Wavefront> wavefront(const Lens& lens, const FieldPoint& point, const WavefrontOptions& options) {
  if (options.directions < 12 || options.directions % 3 != 0) {
    throw Error("wavefront: directions = " + std::to_string(options.directions) +
                "; must be a multiple of 3, at least 12");
  }
  const std::size_t wavelength = lens.compiled_position(options.wavelength);
  const PupilBoundary boundary = pupil_boundary(lens, point, wavelength, options.directions);
  const auto errors = analysis_detail::SphereErrors::of(lens, point, wavelength);
  if (!errors || boundary.empty()) return {};
  Wavefront result{.points = {}, .image = errors->image(), .reference_radius = errors->radius()};
  const double entrance_unit = pupils(lens).entrance.diameter / 2;
  std::vector<Vec2<double>> slopes;
  std::vector<char> in_third;  // rays of every third direction, the middle one of three
  for (const analysis_detail::PupilNode& node : analysis_detail::pupil_nodes_and_rim(boundary)) {
    const auto ray = errors->paths()(node.position);
    if (!ray) continue;
    const bool at_stop = options.coordinates == PupilCoordinates::stop;
    result.points.push_back({at_stop ? ray->stop : node.position / entrance_unit, (*errors)(*ray), node.area});
    slopes.push_back({ray->direction.x, ray->direction.y});
    in_third.push_back(node.direction % 3 == 1);
  }
  if (result.points.empty()) return {};

  const auto count = static_cast<Eigen::Index>(result.points.size());
  Eigen::VectorXd waves(count), weights(count), third_weights(count);
  Eigen::MatrixXd tilts(count, 2), terms(count, static_cast<Eigen::Index>(zernike_terms));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    waves[i] = result.points[at].waves;
    weights[i] = result.points[at].weight;
    third_weights[i] = in_third[at] ? weights[i] : 0;
    tilts.row(i) << slopes[at].x, slopes[at].y;
    for (std::size_t k = 0; k < zernike_terms; ++k) {
      terms(i, static_cast<Eigen::Index>(k)) = zernike_fringe(k, result.points[at].pupil);
    }
  }
  weights /= weights.sum();
  for (std::size_t i = 0; i < result.points.size(); ++i)
    result.points[i].weight = weights[static_cast<Eigen::Index>(i)];

  const Eigen::VectorXd roots = weights.cwiseSqrt();
  const Eigen::VectorXd fit = core_detail::least_squares(roots.asDiagonal() * terms, roots.cwiseProduct(waves));
  std::copy_n(fit.data(), zernike_terms, result.zernike.begin());
  result.zernike_residual_waves = deviation(waves - terms * fit, weights);

  const Eigen::VectorXd level = without_tilt(waves, weights, tilts);
  result.rms_waves = deviation(waves, weights);
  result.rms_without_tilt = deviation(level, weights);
  result.peak_to_valley_waves = waves.maxCoeff() - waves.minCoeff();
  if (constexpr double largest_rms = 0.5; result.rms_without_tilt <= largest_rms) {
    std::complex<double> amplitude = 0;
    for (Eigen::Index i = 0; i < count; ++i) amplitude += std::polar(weights[i], 2 * std::numbers::pi * level[i]);
    result.strehl = std::norm(amplitude);
  }
  result.sampling_error_waves = third_weights.sum() > 0 ? std::abs(deviation(waves, third_weights) - result.rms_waves)
                                                        : std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace petzval
