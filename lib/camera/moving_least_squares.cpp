// SPDX-License-Identifier: Apache-2.0
#include "moving_least_squares.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/text.hpp"
#include "falling_power.hpp"
#include "moving_least_squares_loops.hpp"
#include "petzval/core/error.hpp"

namespace petzval::camera_detail {
namespace {

constexpr double longest_soft = 0.1;                 // sides
constexpr double full_alpha = 1e-3;                  // relative to the largest alpha; below it a point becomes soft
constexpr double negligible = 1e-9;                  // relative to the largest alpha
constexpr double scaled_reach = 2 * reach_in_sides;  // a scaled side is less than 2

/// Power of two that scales a number to about [1, 2).
double scale_of(double x) { return std::ldexp(1, -std::clamp(std::ilogb(x), -1000, 1000)); }

}  // namespace

void check(const WeighedValue& point, double side, const std::string& where) {
  const auto& [film_point, value, weight, fade] = point;
  if (!(std::abs(film_point.x) <= reach_in_sides * side && std::abs(film_point.y) <= reach_in_sides * side)) {
    throw Error(where + "film point = (" + to_text(film_point.x) + ", " + to_text(film_point.y) +
                ") mm; must be within " + to_text(reach_in_sides * side) + " mm");
  }
  if (!std::isfinite(value)) throw Error(where + "value = " + to_text(value) + "; must be finite");
  if (!std::isfinite(weight) || weight < 0) {
    throw Error(where + "weight = " + to_text(weight) + "; must be finite and at least 0");
  }
  if (!(fade >= 0 && fade <= 1)) throw Error(where + "fade = " + to_text(fade) + "; must be 0 to 1");
}

MovingLeastSquares::MovingLeastSquares(const std::string& where, std::span<const WeighedValue> points, double side,
                                       SurfaceKind kind, double beta, double extrapolation)
    : affine_(kind == SurfaceKind::affine) {
  if (!(beta >= 1 && beta <= 8)) throw Error(where + "beta = " + to_text(beta) + "; must be 1 to 8");
  if (!(side > 0 && std::isfinite(side))) {
    throw Error(where + "side of the picture = " + to_text(side) + " mm; must be finite and above 0");
  }
  double most_weight = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    check(points[i], side, where + "point " + std::to_string(i + 1) + ": ");
    if (points[i].fade > 0) most_weight = std::max(most_weight, points[i].weight);
  }
  const auto raw_alpha = [&](const WeighedValue& point) { return point.weight / most_weight * point.fade; };
  double most_alpha = 0, most_present = 0;
  if (most_weight > 0) {
    for (const auto& point : points) most_alpha = std::max(most_alpha, raw_alpha(point));
  }
  if (!(most_alpha > 0)) {
    throw Error(where + "0 of " + std::to_string(points.size()) + " points have a weight; must be at least 1");
  }
  // Continuous in all weights and fades; if all points fade equally, the most important point keeps the value 1.
  const auto presence = [&](const WeighedValue& point) {
    return point.fade * std::min(1.0, raw_alpha(point) / most_alpha / full_alpha);
  };
  for (const auto& point : points) most_present = std::max(most_present, presence(point));

  const bool whole = beta == std::floor(beta);
  power_ = {beta / 2, whole && static_cast<int>(beta) % 2 == 1, whole ? static_cast<int>(beta) / 2 : -1};
  to_scaled_ = scale_of(side);
  double largest = 0;
  for (const auto& point : points) {
    if (raw_alpha(point) >= negligible * most_alpha) largest = std::max(largest, std::abs(point.value));
  }
  to_scaled_value_ = largest > 0 ? scale_of(largest) : 1;
  Columns& to = points_;
  std::vector<double> presences;
  for (const auto& point : points) {
    const double alpha = raw_alpha(point) / most_alpha;
    if (!(alpha >= negligible)) continue;
    presences.push_back(presence(point) / most_present);
    const double soft = (1 - presences.back()) * longest_soft * side * to_scaled_;
    to.x.push_back(point.film_point.x * to_scaled_);
    to.y.push_back(point.film_point.y * to_scaled_);
    to.value.push_back(point.value * to_scaled_value_);
    to.alpha.push_back(alpha);
    to.soft2.push_back(soft * soft);
  }
  find_line(presences);
  // A point that vanishes has less and less influence on the limits.
  double mean = 0, alphas = 0;
  for (std::size_t i = 0; i < to.alpha.size(); ++i) mean += to.alpha[i] * to.value[i], alphas += to.alpha[i];
  mean /= alphas;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t i = 0; i < presences.size(); ++i) {
    const double value = presences[i] == 1 ? to.value[i] : mean + presences[i] * (to.value[i] - mean);
    least = std::min(least, value);
    most = std::max(most, value);
  }
  low_ = least - extrapolation * (most - least);
  high_ = most + extrapolation * (most - least);
  least_value_ = least;
}

// Together with points on a line, one point off the line determines the plane, however small its weight. Therefore
// points nearly on a line determine only the slope along the line, and fading points are counted here by their squared
// share. Points count as on a line if their RMS spread across the line is below 0.02 of the spread along the line, and
// as in a plane from 0.08 on; between these values the results are blended.
void MovingLeastSquares::find_line(std::span<const double> presences) {
  constexpr double line_aspect = 0.02, plane_aspect = 0.08;
  double sum = 0, mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < presences.size(); ++i) {
    const double weight2 = presences[i] * presences[i];
    sum += weight2, mean_x += weight2 * points_.x[i], mean_y += weight2 * points_.y[i];
  }
  mean_x /= sum, mean_y /= sum;
  for (std::size_t i = 0; i < presences.size(); ++i) {
    const double weight2 = presences[i] * presences[i], x = points_.x[i] - mean_x, y = points_.y[i] - mean_y;
    xx += weight2 * x * x, xy += weight2 * x * y, yy += weight2 * y * y;
  }
  const double angle = std::atan2(2 * xy, xx - yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  along_ = {std::cos(angle), std::sin(angle)};
  const double along = (xx + yy) / 2 + half, across = std::max((xx + yy) / 2 - half, 0.0);
  const double aspect = along > 0 ? std::sqrt(across / along) : 0;
  const double fraction = std::clamp((aspect - line_aspect) / (plane_aspect - line_aspect), 0.0, 1.0);
  plane_ = fraction * fraction * (3 - 2 * fraction);
}

void MovingLeastSquares::keep_within(double low, double high) noexcept {
  low_ = std::max(low_, low * to_scaled_value_);
  high_ = std::min(high_, high * to_scaled_value_);
}

LeastSquaresJob MovingLeastSquares::job() const noexcept {
  return {
      .points = points_.x.size(),
      .x = points_.x.data(),
      .y = points_.y.data(),
      .value = points_.value.data(),
      .alpha = points_.alpha.data(),
      .soft2 = points_.soft2.data(),
      .affine = affine_,
      .plane = plane_,
      .along_x = along_.x,
      .along_y = along_.y,
      .power = power_,
      .low = low_,
      .high = high_,
      .to_scaled = to_scaled_,
      .reach = scaled_reach,
      .from_scaled = 1 / to_scaled_value_,
  };
}

void MovingLeastSquares::at(std::size_t count, const double* x, const double* y, double* out) const noexcept {
  if (points_.x.size() == 1) {
    std::fill_n(out, count, most());
  } else {
    least_squares_loops().values(job(), count, x, y, out);
  }
}

void MovingLeastSquares::at(std::size_t count, const float* x, const float* y, float* out) const noexcept {
  constexpr std::size_t block = 256;
  std::array<double, block> xs, ys, values;
  for (std::size_t i = 0; i < count; i += block) {
    const std::size_t size = std::min(block, count - i);
    std::copy_n(x + i, size, xs.begin());
    std::copy_n(y + i, size, ys.begin());
    at(size, xs.data(), ys.data(), values.data());
    std::transform(values.begin(), values.begin() + size, out + i, [](double v) { return static_cast<float>(v); });
  }
}

double MovingLeastSquares::at(const FilmPoint& film_point) const noexcept {
  double value = 0;
  at(1, &film_point.x, &film_point.y, &value);
  return value;
}

// Let h(q) = a + g . (q - p) be the plane of a position p, and L_i = 1 / W + (p - mean) . C^-1 (x_i - mean) the share
// of point i in a. Differentiating the normal equations gives
//
//     da/dp = g + sum_i dw_i/dp L_i (f_i - h(x_i)),   dw_i/dp = -beta w_i (p - x_i) / r2_i,
//
// with the common factor m of the weights as a constant.
Vec2<double> MovingLeastSquares::slopes(const FilmPoint& film_point) const noexcept {
  using V = Vec2<double>;
  const Columns& points = points_;
  const std::size_t count = points.x.size();
  // Clamped as in at(); a clamped coordinate has derivative 0.
  const auto in_reach = [](double x) { return x < scaled_reach ? std::max(x, -scaled_reach) : scaled_reach; };
  const V scaled_point{film_point.x * to_scaled_, film_point.y * to_scaled_},
      p{in_reach(scaled_point.x), in_reach(scaled_point.y)};
  const double value = at(film_point) * to_scaled_value_;
  if (!(value > low_ && value < high_)) return {0, 0};
  const auto away = [&](std::size_t i) { return p - V{points.x[i], points.y[i]}; };
  const auto dot = [](const V& a, const V& b) { return a.x * b.x + a.y * b.y; };
  const auto r2_of = [&](std::size_t i) { return dot(away(i), away(i)) + points.soft2[i]; };

  // Squared distance below which a position coincides with a point; keeps the weights of other points normal numbers.
  constexpr double coincidence_distance2 = 1e-60;
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity(), next = least;
  for (std::size_t i = 0; i < count; ++i) {
    const double r2 = r2_of(i);
    if (r2 < least) least = r2, nearest = i;
    if (r2 > coincidence_distance2) next = std::min(next, r2);
  }
  // At a point, the other points determine the slopes, with weights relative to the nearest of them.
  const bool on_point = least <= coincidence_distance2;
  if (on_point && !(affine_ && std::isfinite(next))) return {0, 0};
  const auto weight = [&](std::size_t i) {
    const double r2 = r2_of(i);
    if (r2 <= coincidence_distance2) return 0.0;
    return points.alpha[i] * falling(power_, (on_point ? next : least) / r2);
  };
  const V centre{points.x[nearest], points.y[nearest]};
  const double centre_value = on_point ? value : points.value[nearest];
  double w_sum = 0, wf = 0, xx = 0, xy = 0, yy = 0;
  V wq{0, 0}, wqf{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const double w = weight(i), f = points.value[i] - centre_value;
    const V q = V{points.x[i], points.y[i]} - centre;
    w_sum += w;
    wf += w * f;
    wq += w * q;
    wqf += w * f * q;
    xx += w * q.x * q.x;
    xy += w * q.x * q.y;
    yy += w * q.y * q.y;
  }
  const V mean = on_point ? V{0, 0} : wq / w_sum;
  const double mean_value = on_point ? 0 : wf / w_sum, trace = xx + yy;
  const double a = xx - w_sum * mean.x * mean.x, b = xy - w_sum * mean.x * mean.y, c = yy - w_sum * mean.y * mean.y;
  // Solved as in the loops: for planes, and for planes that rise along a line only.
  const auto in_planes = [&](const V& right) {
    constexpr double regularisation2 = 1e-20;
    const double xx1 = a / trace, xy1 = b / trace, yy1 = c / trace, det = xx1 * yy1 - xy1 * xy1, tr = xx1 + yy1;
    const V by = right / trace, along{xx1 * by.x + xy1 * by.y, xy1 * by.x + yy1 * by.y};
    return (regularisation2 * along + det * (tr * by - along)) /
           (det * det + regularisation2 * (tr * tr - 2 * det + regularisation2));
  };
  const auto along_line = [&](const V& right) {
    const double moment = along_.x * (along_.x * a + along_.y * b) + along_.y * (along_.x * b + along_.y * c);
    return moment > 1e-10 * trace ? along_ * (dot(along_, right) / moment) : V{0, 0};
  };
  const auto with = [&](const auto& solved) {
    const V slope = solved(wqf - w_sum * mean_value * mean);
    V result = slope;
    if (on_point) return result;
    const V from_mean = p - centre - mean, towards = solved(from_mean);
    for (std::size_t i = 0; i < count; ++i) {
      const V q = V{points.x[i], points.y[i]} - centre - mean;
      const double residual = points.value[i] - centre_value - mean_value - dot(slope, q);
      const double factor = 1 / w_sum + dot(towards, q);
      result -= 2 * power_.exponent * weight(i) / r2_of(i) * factor * residual * away(i);
    }
    return result;
  };
  const V unit = V{p.x == scaled_point.x ? 1 : 0, p.y == scaled_point.y ? 1 : 0} * (to_scaled_ / to_scaled_value_);
  if (!affine_ || !(trace > 1e-290)) return with([](const V&) { return V{0, 0}; }) * unit;
  if (plane_ == 1) return with(in_planes) * unit;
  return (plane_ * with(in_planes) + (1 - plane_) * with(along_line)) * unit;
}

}  // namespace petzval::camera_detail
