// SPDX-License-Identifier: Apache-2.0
#include "petzval/distortion/brown_conrady.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/least_squares.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"

namespace petzval::inline v0 {
namespace {

constexpr double widest_field = radians(88.0);

/// A place of the film: distances from the centre of projection over the focal length, in both pictures.
struct Radii {
  double distorted = 0, undistorted = 0;
};

/// The radius that the coefficients start from, and the one that they lead to.
struct Pair {
  double from = 0, to = 0;
};

std::vector<Radii> radii_of(const LensDistortion& distortion) {
  constexpr int places = 33;
  const Film& film = distortion.camera().film();
  std::vector<Radii> radii;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const Vec2<double> at{film.columns * (column / (places - 1.0)), film.rows * (row / (places - 1.0))};
      const auto undistorted = distortion.undistorted(at);
      if (!undistorted) continue;
      const auto radius = [&](const Vec2<double>& place) {
        const Vec2<double> tangent = (place - distortion.centre()) / distortion.focal_length_px();
        return std::hypot(tangent.x, tangent.y);
      };
      radii.push_back({radius(at), radius(*undistorted)});
    }
  }
  return radii;
}

double polynomial(double r2, const double* k) noexcept { return 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])); }

/// Coefficients of least squares, k1 to k3 and as many as wanted of the denominator's. to = from N / D is linear in
/// them after it is multiplied by D; the weights 1 / D of the round before make its errors those of `to` (Sanathanan
/// and Koerner 1963).
std::array<double, 6> fitted(const std::vector<Pair>& pairs, int in_denominator) {
  double scale = 0;
  for (const Pair& pair : pairs) scale = std::max(scale, pair.from);
  const int unknowns = 3 + in_denominator, rounds = in_denominator > 0 ? 8 : 1;
  // In radii over the largest one, so that all powers have one magnitude.
  std::array<double, 6> k{};
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd rows(pairs.size(), unknowns);
    Eigen::VectorXd wanted(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double r = pairs[i].from, r2 = (r / scale) * (r / scale);
      const double weight = 1 / polynomial(r2, &k[3]);
      for (int j = 0; j < unknowns; ++j) {
        const double power = std::pow(r2, j % 3 + 1);
        rows(static_cast<Eigen::Index>(i), j) = weight * power * (j < 3 ? r : -pairs[i].to);
      }
      wanted(static_cast<Eigen::Index>(i)) = weight * (pairs[i].to - r);
    }
    // Of least size where numerator and denominator say the same, as they do without distortion.
    const Eigen::VectorXd solution = core_detail::least_squares(rows, wanted);
    for (int j = 0; j < unknowns; ++j) k[static_cast<std::size_t>(j)] = solution(j);
  }
  for (std::size_t j = 0; j < 6; ++j) k[j] /= std::pow(scale, 2.0 * static_cast<double>(j % 3 + 1));
  return k;
}

/// Whether the denominator stays well above 0 up to a radius.
bool without_pole(const std::array<double, 6>& k, double radius) noexcept {
  constexpr int steps = 200;
  for (int i = 1; i <= steps; ++i) {
    const double r = radius * i / steps;
    if (!(polynomial(r * r, &k[3]) > 0.05)) return false;
  }
  return true;
}

/// Sets the errors of the coefficients.
void measure(BrownConrady& model, const std::vector<Pair>& pairs, double focal_length_px) {
  double squares = 0;
  model.largest_px = 0;
  for (const Pair& pair : pairs) {
    const double error = std::abs(model.radius(pair.from) - pair.to) * focal_length_px;
    squares += error * error;
    model.largest_px = std::max(model.largest_px, error);
  }
  model.rms_px = std::sqrt(squares / static_cast<double>(pairs.size()));
}

}  // namespace

std::string_view name(BrownConradyDirection direction) noexcept {
  return direction == BrownConradyDirection::to_undistorted ? "Brown-Conrady D-U" : "Brown-Conrady U-D";
}

double BrownConrady::radius(double r) const noexcept { return r * polynomial(r * r, &k[0]) / polynomial(r * r, &k[3]); }

BrownConrady fit_brown_conrady(const LensDistortion& distortion, const BrownConradyOptions& options) {
  const Camera& camera = distortion.camera();
  const std::string where = camera.lens().name() + ": Brown-Conrady: ";
  if (!with_iris(camera.lens(), {}).rotationally_symmetric()) {  // blades bend no ray
    throw Error(where + "the lens has cylinders, wanted one of revolution, whose distortion is radial");
  }
  if (camera.film().tilted())
    throw Error(where + "the film is tilted, wanted an upright one, on which distortion is radial");
  if (const double widest = distortion.widest_field_rad(); widest > widest_field) {
    throw Error(where + "the film sees a field of " + to_text(degrees(widest), 3) +
                " degrees, as a fisheye's does, wanted less than 88, as a pinhole's picture holds");
  }
  const std::vector<Radii> radii = radii_of(distortion);
  if (radii.empty()) throw Error(where + "no light reaches the film");

  BrownConrady result{.direction = options.direction, .pinhole = distortion.pinhole()};
  const bool to_undistorted = options.direction == BrownConradyDirection::to_undistorted;
  std::vector<Pair> pairs;
  double farthest = 0;
  for (const Radii& r : radii) {
    pairs.push_back(to_undistorted ? Pair{r.distorted, r.undistorted} : Pair{r.undistorted, r.distorted});
    farthest = std::max(farthest, pairs.back().from);
    result.field_rad = std::max(result.field_rad, std::atan(r.undistorted));
  }
  result.k = fitted(pairs, 0);
  measure(result, pairs, distortion.focal_length_px().x);
  for (int terms = 1; terms <= 3 && options.form == RadialForm::rational; ++terms) {
    BrownConrady next = result;
    next.k = fitted(pairs, terms);
    if (!without_pole(next.k, 1.1 * farthest)) continue;
    measure(next, pairs, distortion.focal_length_px().x);
    if (next.rms_px < result.rms_px) result = next;
  }
  return result;
}

}  // namespace petzval::inline v0
