// SPDX-License-Identifier: Apache-2.0
#include "least_blur.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "petzval/core/bisect.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/sequential.hpp"

namespace petzval::detail {
namespace {

struct Node {
  double x, weight;  // on (0, 1)
};

/// Nodes of Gauss and Legendre, by Newton's iteration on the three-term recurrence.
template <std::size_t count>
std::array<Node, count> gauss_legendre() {
  std::array<Node, count> nodes;
  for (std::size_t i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (count + 0.5));
    double slope = 0;
    for (int iteration = 0; iteration < 6; ++iteration) {
      double p = 1, before = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double order = static_cast<double>(k);
        const double next = ((2 * order + 1) * x * p - order * before) / (order + 1);
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    nodes[i] = {(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)};
  }
  return nodes;
}

}  // namespace

LeastBlur::LeastBlur(const Lens& lens, std::size_t wavelength) : lens_(lens), wavelength_(wavelength) {
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double semi_diameter = lens.surfaces()[i].semi_diameter;
    if (std::isinf(semi_diameter)) continue;
    rims_.push_back({semi_diameter, ray_matrix_to(lens, i, wavelength, Meridian::y),
                     ray_matrix_to(lens, i, wavelength, Meridian::x)});
  }
  if (rims_.empty()) {
    throw Error(lens.name() + ": no surface limits the beam, wanted a semi_diameter for the focus of least blur");
  }
  // Cylinders along x and y leave the four quadrants alike. Half as many azimuths serve an anamorphic lens to 1e-6 mm,
  // but not a cylinder lit to its equator.
  constexpr int per_quadrant = 16;
  const int count = lens.rotationally_symmetric() ? 1 : per_quadrant;
  for (int i = 0; i < count; ++i) {
    const double angle = count == 1 ? 0 : (i + 0.5) / per_quadrant * (std::numbers::pi / 2);
    azimuths_.push_back({std::sin(angle), std::cos(angle)});
  }
}

std::optional<LeastBlur::Ray> LeastBlur::trace(double subject_z, const Azimuth& azimuth, double height) const {
  // From the plane of the first vertex. Rays through an axial point meet all planes at heights in proportion, so that
  // equal areas here are equal areas of the entrance pupil.
  const double x = azimuth.x * height, y = azimuth.y * height;
  const double slope = std::isinf(subject_z) ? 0 : height / -subject_z;
  const double length = std::hypot(1.0, slope);
  const kernel::Vec<double> direction{azimuth.x * slope / length, azimuth.y * slope / length, 1 / length};
  const auto end =
      kernel::trace(lens_.view<double>(), kernel::Vec<double>{x, y, 0}, direction, {.wavelength = wavelength_});
  const auto& d = end.direction;
  if (end.fate != RayFate::transmitted || d.z == 0) return {};
  return Ray{0, end.origin.x, end.origin.y, end.origin.z, d.x / d.z, d.y / d.z};
}

/// Twice the height at which the paraxial beam is clipped: generous, as rims and aberrations go.
double LeastBlur::bound(double subject_z, const Azimuth& azimuth) const {
  const double nu = signed_index(lens_, 0, wavelength_) / -subject_z;
  double least = std::numeric_limits<double>::infinity();
  for (const Rim& rim : rims_) {
    const double height = std::hypot(azimuth.x * (rim.x.a + rim.x.b * nu), azimuth.y * (rim.y.a + rim.y.b * nu));
    if (height > 0) least = std::min(least, rim.semi_diameter / height);
  }
  return 2 * least;
}

std::vector<LeastBlur::Interval> LeastBlur::passing(double subject_z, const Azimuth& azimuth) const {
  const auto passes = [&](double height) { return trace(subject_z, azimuth, height).has_value(); };
  constexpr int samples = 64;
  const double step = bound(subject_z, azimuth) / samples;
  std::vector<Interval> intervals;
  if (!std::isfinite(step)) return intervals;
  bool inside = false;
  for (int i = 0; i <= samples; ++i) {
    const double height = i * step;
    const bool now = passes(height);
    if (now && !inside) intervals.push_back({i == 0 ? 0 : last_with(height, height - step, passes), height});
    if (!now && inside) intervals.back().to = last_with(height - step, height, passes);
    if (now) intervals.back().to = height;
    inside = now;
  }
  return intervals;
}

std::optional<double> LeastBlur::operator()(double subject_z) const {
  static constexpr std::size_t count = 24;
  const auto nodes = gauss_legendre<count>();
  std::vector<Ray> rays;
  for (const Azimuth& azimuth : azimuths_) {
    for (const auto& [from, to] : passing(subject_z, azimuth)) {
      const double area = (to - from) * (to + from);
      for (const Node& node : nodes) {
        auto ray = trace(subject_z, azimuth, std::sqrt(from * from + area * node.x));
        if (!ray || area == 0) continue;
        ray->weight = area * node.weight;
        rays.push_back(*ray);
      }
    }
  }
  if (rays.empty()) return {};

  // The mean square height over the film at z is a parabola with its vertex at z0 - cov(p, u) / var(u), p the point in
  // the plane z0 and u the slope; the means vanish by symmetry.
  const double z0 = lens_.surfaces().back().vertex_z;
  double covariance = 0, variance = 0;
  for (const Ray& ray : rays) {
    const double x = ray.x + (z0 - ray.z) * ray.slope_x, y = ray.y + (z0 - ray.z) * ray.slope_y;
    covariance += ray.weight * (x * ray.slope_x + y * ray.slope_y);
    variance += ray.weight * (ray.slope_x * ray.slope_x + ray.slope_y * ray.slope_y);
  }
  return variance == 0 ? std::numeric_limits<double>::infinity() : z0 - covariance / variance;
}

}  // namespace petzval::detail
