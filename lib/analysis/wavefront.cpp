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

constexpr double largest_strehl_rms = 0.5;  // waves; beyond, an image has no single peak
constexpr double strehl_goal = 1e-4;        // error by the number of rays, below the digits that are printed

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

/// Statistics of a wavefront by some of its rays.
struct Statistics {
  double rms = 0, rms_without_tilt = 0, strehl = 0;
};

/// weights: at least one is above 0.
Statistics statistics(const Eigen::VectorXd& waves, const Eigen::VectorXd& weights, const Eigen::MatrixXd& slopes) {
  const Eigen::VectorXd level = without_tilt(waves, weights, slopes);
  std::complex<double> amplitude = 0;
  for (Eigen::Index i = 0; i < waves.size(); ++i) amplitude += std::polar(weights[i], 2 * std::numbers::pi * level[i]);
  return {deviation(waves, weights), deviation(level, weights), std::norm(amplitude / weights.sum())};
}

/// The rays of one quadrature over a pupil.
struct PupilRays {
  std::vector<Wavefront::Point> points{};  ///< with areas as weights
  Eigen::VectorXd waves{}, weights{};      ///< of the points; the weights sum to 1
  Eigen::VectorXd third_weights{};         ///< 0 unless the direction is the middle one of three
  Eigen::MatrixXd slopes{};                ///< directions behind the lens, x and y

  PupilRays(const analysis_detail::SphereErrors& errors, const std::vector<analysis_detail::PupilNode>& nodes,
            std::optional<double> entrance_unit) {
    std::vector<analysis_detail::PathRay> rays;
    std::vector<double> thirds;
    for (const analysis_detail::PupilNode& node : nodes) {
      const auto ray = errors.paths()(node.position);
      if (!ray) continue;
      points.push_back({entrance_unit ? node.position / *entrance_unit : ray->stop, errors(*ray), node.area});
      thirds.push_back(node.direction % 3 == 1 ? node.area : 0);
      rays.push_back(*ray);
    }
    const auto count = static_cast<Eigen::Index>(points.size());
    waves.resize(count), weights.resize(count), third_weights.resize(count), slopes.resize(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      waves[i] = points[at].waves, weights[i] = points[at].weight, third_weights[i] = thirds[at];
      slopes.row(i) << rays[at].direction.x, rays[at].direction.y;
    }
    weights /= weights.sum();
    for (std::size_t i = 0; i < points.size(); ++i) points[i].weight = weights[static_cast<Eigen::Index>(i)];
  }

  /// With a third of the directions; nullopt if they have no ray.
  std::optional<Statistics> of_third() const {
    if (!(third_weights.sum() > 0)) return {};
    return statistics(waves, third_weights, slopes);
  }
};

}  // namespace

double zernike_fringe(std::size_t term, const Vec2<double>& pupil) {
  if (term >= zernike_terms) throw Error("zernike_fringe: term = " + std::to_string(term) + "; must be 0 to 36");
  static constexpr auto orders = zernike_orders();
  const auto [n, m, sine] = orders[term];
  const double angle = m * std::atan2(pupil.y, pupil.x);
  return radial(n, m, std::hypot(pupil.x, pupil.y)) * (sine ? std::sin(angle) : std::cos(angle));
}

std::optional<Wavefront> wavefront(const Lens& lens, const FieldPoint& point, Wavelength at,
                                   PupilCoordinates coordinates, std::size_t least_directions) {
  if (least_directions < 12 || least_directions % 3 != 0) {
    throw Error("wavefront: directions = " + std::to_string(least_directions) +
                "; must be a multiple of 3, at least 12");
  }
  const std::size_t wavelength = lens.wavelength_index(at);
  const auto errors = analysis_detail::SphereErrors::of(lens, point, wavelength);
  if (!errors) return {};
  std::optional<double> entrance_unit;
  if (coordinates == PupilCoordinates::entrance) entrance_unit = pupils(lens).entrance.diameter / 2;
  std::size_t directions = least_directions, radii = 16;
  std::optional<PupilBoundary> boundary;
  const auto trace = [&](std::size_t nodes) {
    return PupilRays(*errors,
                     nodes == 8    ? analysis_detail::pupil_nodes_and_rim<8>(*boundary)
                     : nodes == 16 ? analysis_detail::pupil_nodes_and_rim<16>(*boundary)
                                   : analysis_detail::pupil_nodes_and_rim<32>(*boundary),
                     entrance_unit);
  };
  Wavefront result{.points = {}, .image = errors->image(), .reference_radius = errors->radius()};
  // A third of the directions and half of the nodes along the radius estimate the errors. The phases of the Strehl
  // ratio need more rays than the RMS.
  for (std::optional<PupilRays> rays, fewer;;) {
    if (!rays) {
      boundary = pupil_boundary(lens, point, wavelength, directions);
      fewer = trace(radii / 2), rays = trace(radii);
      if (rays->points.empty() || fewer->points.empty()) return {};
    }
    const Statistics all = statistics(rays->waves, rays->weights, rays->slopes),
                     half = statistics(fewer->waves, fewer->weights, fewer->slopes);
    constexpr double unknown = std::numeric_limits<double>::infinity();
    const Statistics third = rays->of_third().value_or(Statistics{unknown, unknown, unknown});
    const double by_radius = std::abs(half.strehl - all.strehl), by_direction = std::abs(third.strehl - all.strehl);
    const bool has_strehl = all.rms_without_tilt <= largest_strehl_rms;
    if (has_strehl && by_radius > strehl_goal && radii < 32) {
      radii *= 2, fewer = std::move(rays), rays = trace(radii);
      continue;
    }
    // Lenses of thousands of surfaces keep the first number of directions, so that reports take seconds.
    constexpr std::size_t most_hits = 1 << 20;
    if (has_strehl && by_direction > strehl_goal && directions < 9 * least_directions &&
        3 * directions * radii * lens.surface_count() <= most_hits) {
      directions *= 3, rays.reset();
      continue;
    }
    result.rms_waves = all.rms, result.rms_without_tilt = all.rms_without_tilt;
    result.sampling_error_waves = std::max(std::abs(third.rms - all.rms), std::abs(half.rms - all.rms));
    if (has_strehl) result.strehl = all.strehl, result.strehl_error = std::max(by_radius, by_direction);

    Eigen::MatrixXd terms(rays->waves.size(), static_cast<Eigen::Index>(zernike_terms));
    for (Eigen::Index i = 0; i < terms.rows(); ++i) {
      const Vec2<double>& pupil = rays->points[static_cast<std::size_t>(i)].pupil;
      for (std::size_t k = 0; k < zernike_terms; ++k) terms(i, static_cast<Eigen::Index>(k)) = zernike_fringe(k, pupil);
    }
    const Eigen::VectorXd roots = rays->weights.cwiseSqrt();
    const Eigen::VectorXd fit = core_detail::least_squares(roots.asDiagonal() * terms, roots.cwiseProduct(rays->waves));
    std::copy_n(fit.data(), zernike_terms, result.zernike.begin());
    result.zernike_residual_waves = deviation(rays->waves - terms * fit, rays->weights);
    result.peak_to_valley_waves = rays->waves.maxCoeff() - rays->waves.minCoeff();
    result.points = std::move(rays->points);
    return result;
  }
}

}  // namespace petzval
