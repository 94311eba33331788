// SPDX-License-Identifier: Apache-2.0
#include "describe_asphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace petzval::lens_detail {
namespace {

/// x^n by multiplication: scaling a lens by 2 must scale its constants by exact powers of two (pow() may round).
double power(double x, int n) {
  double result = 1;
  for (int i = 0; i < n; ++i) result *= x;
  return result;
}

/// Largest slope up to which an asphere is described. Beyond it, polynomials of high order diverge; bounds of sag and
/// slope that include such zones would force a search for every ray. A rim is limited to this height. Without a rim,
/// rays farther out hit the surface if Newton's iteration converges. (The steepest asphere of data/lenses has a slope
/// of 3.)
constexpr double steepest = 4;

/// Least height at which a single aspheric term reaches a slope.
double term_height(const LensSurface& s, double slope) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [order, coefficient] : s.aspheric) {
    if (coefficient == 0) continue;
    least = std::min(least, std::pow(order * std::abs(coefficient) / slope, -1.0 / (order - 1)));
  }
  return least;
}

/// Limit of the height up to which an asphere is described: its clear aperture, within the domain of the base conic. An
/// unlimited asphere ends where its strongest term reaches a slope of one, or where a paraboloid with the radius of the
/// base reaches the steepest slope. Farther out a hyperboloid is nearly straight, and even a weak term would cause
/// additional crossings.
double height(const LensSurface& s) {
  constexpr double max_term_slope = 1e6;  // slope that the other terms cannot compensate
  const double curvature = std::abs(s.curvature) * std::sqrt(std::max(0.0, 1 + s.conic));
  double limit = curvature > 0 ? 1 / curvature : std::numeric_limits<double>::infinity();
  if (s.semi_diameter > 0) limit = std::min(limit, s.semi_diameter);
  const bool limited = std::isfinite(s.semi_diameter);
  if (!limited && s.curvature != 0) limit = std::min(limit, steepest / std::abs(s.curvature));
  limit = std::min(limit, term_height(s, limited ? max_term_slope : 1));
  return std::isfinite(limit) && limit > 0 ? limit : 1.0;
}

kernel::Asphere<double> asphere_up_to(double height, const LensSurface& s) {
  kernel::Asphere<double> a;
  a.base = describe_quadric(s);
  a.height = height;
  for (const auto& [order, coefficient] : s.aspheric) {
    const double scaled = coefficient * power(a.height, order);
    if (order % 2 == 0) {
      a.even[static_cast<std::size_t>(order / 2 - 1)] += scaled;
      a.even_count = std::max(a.even_count, order / 2);
    } else {
      a.odd[static_cast<std::size_t>((order - 3) / 2)] += scaled;
      a.odd_count = std::max(a.odd_count, (order - 1) / 2);
    }
  }
  return a;
}

/// The polynomial of an asphere over rho = r / height, with bounds over intervals of rho from second-order expansions.
class Polynomial {
 public:
  Polynomial(const LensSurface& s, double height) {
    for (const auto& [order, coefficient] : s.aspheric) {
      if (coefficient != 0) terms_.push_back({order, coefficient * power(height, order)});
    }
  }

  /// Bounds of the value, and of the slope divided by rho.
  struct Bounds {
    double lowest, highest, least_bend, most_bend;
  };
  Bounds over(double from, double to) const {
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    const auto at = powers(middle), end = powers(to);
    double value = 0, slope = 0, bend = 0, bend_slope = 0;        // at the middle
    double size = 0, bend_size = 0, curved = 0, bend_curved = 0;  // sums of the magnitudes of the terms
    for (const auto& [order, a] : terms_) {
      const auto n = static_cast<std::size_t>(order);
      const double i = order, amount = std::abs(a);
      value += a * at[n];
      slope += i * a * at[n - 1];
      bend += i * a * at[n - 2];
      size += amount * end[n];
      bend_size += i * amount * end[n - 2];
      curved += i * (i - 1) * amount * end[n - 2];
      if (order == 2) continue;
      bend_slope += i * (i - 2) * a * at[n - 3];
      if (order > 3) bend_curved += i * (i - 2) * (i - 3) * amount * end[n - 4];
    }
    // Add the rounding errors of coefficients and sums in float.
    const double off = half * (std::abs(slope) + 0.5 * half * curved) + rounding * size;
    const double bend_off = half * (std::abs(bend_slope) + 0.5 * half * bend_curved) + rounding * bend_size;
    return {value - off, value + off, bend - bend_off, bend + bend_off};
  }

 private:
  static constexpr double rounding = 4e-6;
  using Powers = std::array<double, kernel::max_asphere_order + 1>;

  static Powers powers(double x) {
    Powers p{1};
    for (std::size_t i = 1; i < p.size(); ++i) p[i] = p[i - 1] * x;
    return p;
  }

  std::vector<AsphereTerm> terms_;
};

/// Sets the bounds over the rings and over the complete surface. Each ring is divided into intervals. In an interval
/// the sag and the slope / r of the base are monotonic, and therefore bounded by their values at the ends.
void bound(const LensSurface& s, kernel::Asphere<double>& a) {
  constexpr int intervals = 8;
  constexpr double radius_margin_mm = 1e-5;  // allows for rounding of radii in float
  constexpr double huge = std::numeric_limits<double>::max();
  kernel::Asphere<double> base;
  base.base = a.base;
  base.height = a.height;
  const Polynomial polynomial(s, a.height);
  const double per_height2 = 1 / (a.height * a.height);
  const auto radius = [&](int ring) { return std::sqrt(ring / double{kernel::asphere_rings}); };
  for (int k = 0; k < kernel::asphere_rings; ++k) {
    const double inner = std::max(0., radius(k) - radius_margin_mm), outer = radius(k + 1) + radius_margin_mm;
    kernel::AsphereRing<double> ring{
        k == 0 ? -huge : a.height * a.height * k / kernel::asphere_rings,
        k + 1 == kernel::asphere_rings ? huge : a.height * a.height * (k + 1) / kernel::asphere_rings,
        a.height * outer,
        huge,
        -huge,
        huge,
        -huge};
    double from = inner;
    auto below = kernel::sag(base, a.height * a.height * from * from);
    for (int i = 1; i <= intervals; ++i) {
      const double to = inner + (outer - inner) * i / intervals;
      const auto above = kernel::sag(base, a.height * a.height * to * to);
      const auto terms = polynomial.over(from, to);
      const double rounding = 4e-6 * std::abs(above.slope);
      const double least = std::min(below.slope, above.slope) + per_height2 * terms.least_bend - rounding;
      const double most = std::max(below.slope, above.slope) + per_height2 * terms.most_bend + rounding;
      ring.lowest = std::min(ring.lowest, std::min(below.z, above.z) + terms.lowest);
      ring.highest = std::max(ring.highest, std::max(below.z, above.z) + terms.highest);
      ring.least_bend = std::min(ring.least_bend, least);
      ring.most_bend = std::max(ring.most_bend, most);
      a.steepest = std::max(a.steepest, a.height * to * std::max(-least, most));
      from = to;
      below = above;
    }
    const double margin = 1e-6 * (a.height + std::max(std::abs(ring.lowest), std::abs(ring.highest)));
    ring.lowest -= margin;
    ring.highest += margin;
    a.lowest = std::min(a.lowest, ring.lowest);
    a.highest = std::max(a.highest, ring.highest);
    a.rings[static_cast<std::size_t>(k)] = ring;
  }
}

/// The asphere without its bounds.
kernel::Asphere<double> described(const LensSurface& s) {
  constexpr int samples = 256;
  kernel::Asphere<double> a = asphere_up_to(height(s), s);
  for (int i = 0; i <= samples; ++i) {
    const double r = a.height * i / samples;
    const auto [z, slope, defined] = kernel::sag(a, r * r);
    if (defined && std::abs(slope) * r <= steepest) continue;
    a = asphere_up_to(a.height * std::max(i - 1, 1) / samples, s);
    i = -1;
  }
  return a;
}

}  // namespace

double described_height(const LensSurface& surface) { return described(surface).height; }

kernel::Quadric<double> describe_quadric(const LensSurface& s) {
  return kernel::make_quadric<double>(s.curvature, s.conic, s.curved_in != Section::y, s.curved_in != Section::x);
}

std::vector<kernel::Asphere<double>> describe_aspheres(std::span<const LensSurface> surfaces) {
  std::vector<kernel::Asphere<double>> aspheres;
  for (const LensSurface& s : surfaces) {
    if (s.aspheric.empty()) continue;
    kernel::Asphere<double>& a = aspheres.emplace_back(described(s));
    if (std::isfinite(s.semi_diameter)) a.rim2 = a.height * a.height;
    bound(s, a);
    a.edge = kernel::sag(a, a.height * a.height).z;
  }
  return aspheres;
}

}  // namespace petzval::lens_detail
