// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <vector>

#include "core/kernel_vec.hpp"
#include "petzval/prescription/prescription.hpp"

/// Crossings of rays with aspheres, by brute force in long double.
namespace testing_aspheres {

struct Crossing {
  double t, cos_incidence;
};

/// The sag of a row by its definition, in long double.
struct Sag {
  const petzval::SurfaceRow& row;

  long double value(long double r) const {
    const long double c = row.radius == 0 ? 0 : 1 / static_cast<long double>(row.radius);
    long double z = c * r * r / (1 + std::sqrt(1 - (1 + static_cast<long double>(row.conic)) * c * c * r * r));
    long double power = r;
    int reached = 1;
    for (const auto& [order, a] : row.aspheric) {  // in increasing order
      for (; reached < order; ++reached) power *= r;
      z += a * power;
    }
    return z;
  }
  long double clearance(const petzval::kernel::Vec<double>& p, const petzval::kernel::Vec<double>& d,
                        long double t) const {
    return p.z + t * d.z - value(std::hypot(p.x + t * d.x, p.y + t * d.y));
  }
};

/// Crossings in the direction of travel within a height, by a scan in small steps. nullopt if two crossings are closer
/// than the steps or than 1/50 of the scan, because a search may miss such pairs.
inline std::optional<std::vector<Crossing>> scan(const petzval::SurfaceRow& r, double rim,
                                                 const petzval::kernel::Vec<double>& p,
                                                 const petzval::kernel::Vec<double>& d, int sense) {
  const Sag sag{r};
  const double across = d.x * d.x + d.y * d.y, middle = -(p.x * d.x + p.y * d.y) / across;
  const double closest = std::hypot(p.x + middle * d.x, p.y + middle * d.y);
  if (closest >= rim) return std::vector<Crossing>{};
  const double half = std::sqrt((rim * rim - closest * closest) / across);
  // A ray near the axis leaves the aperture far away; a few semi-diameters on both sides are enough.
  const long double from = std::max(middle - half, -2 * rim), to = std::min(middle + half, 4 * rim);
  constexpr int steps = 300;
  int turned = -steps;  // the last change of side
  std::vector<Crossing> found;
  long double low = from, below = sag.clearance(p, d, low);
  for (int i = 1; i <= steps; ++i) {
    const long double high = from + (to - from) * i / steps, above = sag.clearance(p, d, high);
    const long double little = 0.1L * (high - low);
    if (std::abs(below) < little && std::abs(above - below) < little) return std::nullopt;
    if ((below <= 0) != (above <= 0)) {
      if (i - turned < steps / 50) return std::nullopt;
      turned = i;
    }
    if (below * sense <= 0 && above * sense > 0) {
      long double a = low, b = high;
      for (int k = 0; k < 70; ++k) {
        const long double m = (a + b) / 2;
        (sag.clearance(p, d, m) * sense <= 0 ? a : b) = m;
      }
      const long double h = 1e-7L * rim, rate = (sag.clearance(p, d, a + h) - sag.clearance(p, d, a - h)) / (2 * h);
      const long double radius = std::hypot(p.x + a * d.x, p.y + a * d.y);
      const long double slope = (sag.value(radius + h) - sag.value(radius - h)) / (2 * h);
      const double cosine = static_cast<double>(std::abs(rate) / std::sqrt(1 + slope * slope));
      if (cosine < 0.02) return std::nullopt;
      found.push_back({static_cast<double>(a), cosine});
    }
    low = high;
    below = above;
  }
  return found;
}

/// Every third surface is a wave, down and up again. The others have up to five terms up to order 40; each term has a
/// slope of up to 5 at the rim.
inline petzval::SurfaceRow wild(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  petzval::SurfaceRow row;
  const double rim = std::pow(10.0, uniform(-1, 2));
  row.semi_diameter = rim;
  row.radius = 0;
  const auto add = [&](int order, double at_rim) {
    row.aspheric.push_back({order, at_rim / std::pow(rim, order - 1)});
  };
  if (random() % 3 == 0) {
    const double high = uniform(-1.5, 1.5);
    add(2, high), add(4, -uniform(2.4, 2.9) * high), add(6, uniform(1.5, 1.9) * high);
    return row;
  }
  if (random() % 4) row.radius = (random() % 2 ? 1 : -1) * rim * uniform(0.8, 20);
  row.conic = random() % 3 ? uniform(-5, 3) : uniform(-300, -10);
  std::vector<int> orders;
  for (std::size_t i = 0, terms = 1 + random() % 5; i < terms; ++i) {
    orders.push_back(static_cast<int>(random() % 3 ? 2 * (1 + random() % 20) : 3 + random() % 37));
  }
  std::sort(orders.begin(), orders.end());
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  const double steep = uniform(0, 5);
  for (const int order : orders) add(order, uniform(-steep, steep) / order);
  return row;
}

}  // namespace testing_aspheres
