// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/least_squares.hpp"
#include "optical_path.hpp"
#include "petzval/core/error.hpp"
#include "pupil_nodes.hpp"

namespace petzval::analysis_detail {

/// A point of the film as seen from one wavelength: its rays, and the map from directions behind the lens to positions
/// in the pupil plane.
class DirectionMap {
 public:
  /// @param caller      name of the public function, for messages
  /// @param directions  directions of the boundary; below 256 the polynomials use every third direction
  /// @throws Error      if the rays behind the lens are parallel in a section; under the conditions of aim()
  DirectionMap(const char* caller, const Lens& lens, const FieldPoint& point, std::size_t wavelength,
               const Vec3<double>& centre, std::size_t directions = 256)
      : boundary_(pupil_boundary(lens, point, wavelength, directions)),
        paths_(lens, boundary_.plane, wavelength, centre) {
    std::vector<Vec2<double>> reached, behind;
    Vec2<double> low{2, 2}, high{-2, -2};
    double blur_squared = 0;
    const bool fast = directions < 256;
    const std::vector<PupilNode> nodes = fast ? pupil_nodes_and_rim<4>(boundary_) : pupil_nodes_and_rim(boundary_);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const bool at_rim = i + boundary_.spans.size() >= nodes.size(), fitted = !fast || nodes[i].direction % 3 == 0;
      if (!at_rim && !fitted) continue;
      const auto ray = paths_(nodes[i].position);
      const Vec2<double> direction = ray ? Vec2<double>(ray->direction) : Vec2<double>(NAN);
      if (at_rim) rim_.push_back(direction);
      if (!ray) continue;
      if (fitted) reached.push_back(nodes[i].position), behind.push_back(direction);
      low = glm::min(low, direction), high = glm::max(high, direction);
      blur_squared = std::max(blur_squared, ray->miss_squared);
    }
    if (reached.empty()) return;
    blur_ = std::sqrt(blur_squared);
    middle_ = (low + high) / 2.0;
    half_ = std::max((high.x - low.x) / 2, (high.y - low.y) / 2);
    if (!(std::min(high.x - low.x, high.y - low.y) > 1e-6 * half_)) {
      throw Error(caller + (": the rays of " + lens.name()) + " are parallel in one section; must converge in both");
    }
    const auto count = static_cast<Eigen::Index>(reached.size());
    Eigen::MatrixXd rows(count, terms), positions(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      rows.row(i) = powers((behind[at] - middle_) / half_);
      positions.row(i) << reached[at].x, reached[at].y;
    }
    coefficients_.resize(terms, 2);
    for (const int axis : {0, 1}) coefficients_.col(axis) = core_detail::least_squares(rows, positions.col(axis));
  }

  bool empty() const noexcept { return half_ == 0; }
  const PupilBoundary& boundary() const noexcept { return boundary_; }
  /// Directions (x and y of unit vectors) of the outer ends of the spans of the boundary.
  const std::vector<Vec2<double>>& rim() const noexcept { return rim_; }
  const OpticalPaths& paths() const noexcept { return paths_; }
  /// Middle and half of the larger width of the directions (x and y of unit vectors).
  const Vec2<double>& middle() const noexcept { return middle_; }
  double half() const noexcept { return half_; }
  /// Largest distance of a ray from the centre of the image, mm.
  double blur() const noexcept { return blur_; }

  /// Position in the pupil plane of the ray that leaves the lens in a direction, by polynomials of total degree 8.
  Vec2<double> position(const Vec2<double>& direction) const noexcept {
    const Eigen::Matrix<double, 1, terms> row = powers((direction - middle_) / half_);
    return {row.dot(coefficients_.col(0)), row.dot(coefficients_.col(1))};
  }

  /// Area in the pupil plane for an area of directions, mm^2.
  double stretch(const Vec2<double>& direction) const noexcept {
    const double step = 1e-4 * half_;
    const Vec2<double> along_x =
        position(direction + Vec2<double>{step, 0}) - position(direction - Vec2<double>{step, 0});
    const Vec2<double> along_y =
        position(direction + Vec2<double>{0, step}) - position(direction - Vec2<double>{0, step});
    return std::abs(along_x.x * along_y.y - along_x.y * along_y.x) / (4 * step * step);
  }

  /// Optical path of the ray that leaves the lens in a direction: of the ray at the position of the polynomials, with
  /// a step to the direction. nullopt if no such ray is found.
  std::optional<double> path(const Vec2<double>& direction) const noexcept {
    Vec2<double> corrected = direction;
    for (int iteration = 0; iteration < 8; ++iteration) {
      const auto ray = paths_(position(corrected));
      if (!ray) break;
      const Vec2<double> miss = direction - Vec2<double>(ray->direction);
      if (glm::dot(miss, miss) < 1e-6 * half_ * half_) {
        return ray->path - paths_.film_index() * glm::dot(miss, ray->film);
      }
      corrected += miss;
    }
    return {};
  }

 private:
  static constexpr int degree = 8, terms = (degree + 1) * (degree + 2) / 2;

  /// The terms of a polynomial of two variables from -1 to 1.
  static Eigen::Matrix<double, 1, terms> powers(const Vec2<double>& at) noexcept {
    std::array<double, degree + 1> xs{1}, ys{1};
    for (std::size_t i = 1; i <= degree; ++i) xs[i] = xs[i - 1] * at.x, ys[i] = ys[i - 1] * at.y;
    Eigen::Matrix<double, 1, terms> result;
    Eigen::Index term = 0;
    for (std::size_t i = 0; i <= degree; ++i) {
      for (std::size_t j = 0; i + j <= degree; ++j) result[term++] = xs[i] * ys[j];
    }
    return result;
  }

  PupilBoundary boundary_;
  OpticalPaths paths_;
  std::vector<Vec2<double>> rim_;
  Vec2<double> middle_{0, 0};
  double half_ = 0, blur_ = 0;
  Eigen::MatrixXd coefficients_;  // of x and y
};

/// Weights of the wavelengths of diffraction_mtf(): the given ones, or equal weights.
inline std::vector<double> mtf_weights(std::size_t wavelengths, std::span<const double> weights) {
  if (weights.empty()) return std::vector<double>(wavelengths, 1);
  if (weights.size() == wavelengths) return {weights.begin(), weights.end()};
  throw Error("diffraction_mtf: " + std::to_string(weights.size()) + " weights; must be " +
              std::to_string(wavelengths) + ", one for each wavelength, or none");
}

}  // namespace petzval::analysis_detail
