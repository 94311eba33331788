// SPDX-License-Identifier: Apache-2.0
#include "image.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/bisect.hpp"

namespace petzval::focus_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double square(double x) { return x * x; }

/// Squared radius of a ray in the plane `shift` behind the plane of the bundle.
double square_radius(const RayBundle& rays, std::size_t i, double shift) noexcept {
  return square(rays.x[i] + shift * rays.slope_x[i]) + square(rays.y[i] + shift * rays.slope_y[i]);
}

}  // namespace

double Image::diameter(double film) const noexcept {
  if (rays.empty()) return std::hypot(least, slope * (film - film_z));
  double largest = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    largest = std::max(largest, square_radius(rays, i, film - rays.plane_z));
  }
  return 2 * std::sqrt(largest);
}

bool centre(RayBundle& bundle, bool centroid_on_axis) {
  const std::size_t count = bundle.size();
  if (bundle.weights.empty()) bundle.weights.assign(count, 1);
  double total = 0;
  for (const double weight : bundle.weights) total += weight;
  if (!(total > 0)) return false;
  for (double& weight : bundle.weights) weight /= total;
  if (centroid_on_axis) return true;
  for (auto* values : {&bundle.x, &bundle.y, &bundle.slope_x, &bundle.slope_y}) {
    double mean = 0;
    for (std::size_t i = 0; i < count; ++i) mean += bundle.weights[i] * (*values)[i];
    for (double& value : *values) value -= mean;
  }
  return true;
}

/// The mean squared radius is a parabola over the film position with its vertex at -cov(p, u) / var(u), where p is the
/// point in the plane and u the slope.
Image least_rms(const RayBundle& rays) {
  double covariance = 0, variance = 0, least = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double x = rays.x[i], y = rays.y[i], u = rays.slope_x[i], v = rays.slope_y[i];
    covariance += rays.weights[i] * (x * u + y * v);
    variance += rays.weights[i] * (square(u) + square(v));
  }
  const double shift = variance == 0 ? infinity : -covariance / variance;
  for (std::size_t i = 0; i < rays.size(); ++i) least += rays.weights[i] * square_radius(rays, i, shift);
  // The diameter of a uniform disc is sqrt(8) times its RMS radius.
  return {.film_z = rays.plane_z + shift, .least = std::sqrt(8 * least), .slope = std::sqrt(8 * variance)};
}

/// The largest squared radius as a function of the film position is the maximum of several parabolas, and therefore
/// convex. It decreases where the parabola with the largest value decreases.
Image least_maximum(RayBundle rays) {
  const auto rises = [&](double shift) {
    double largest = -1, slope = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double u = rays.slope_x[i], v = rays.slope_y[i];
      const double x = rays.x[i] + shift * u, y = rays.y[i] + shift * v;
      const double radius2 = square(x) + square(y);
      if (radius2 > largest) largest = radius2, slope = x * u + y * v;
    }
    return slope > 0;
  };
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double u = rays.slope_x[i], v = rays.slope_y[i], steepness = square(u) + square(v);
    if (steepness == 0) continue;
    const double vertex = -(rays.x[i] * u + rays.y[i] * v) / steepness;
    low = std::min(low, vertex), high = std::max(high, vertex);
  }
  double shift = low;
  if (low < high) shift = rises(low) ? low : core_detail::last_with(low, high, [&](double z) { return !rises(z); });
  return {.film_z = rays.plane_z + shift, .rays = std::move(rays)};
}

}  // namespace petzval::focus_detail
