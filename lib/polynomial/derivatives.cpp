// SPDX-License-Identifier: Apache-2.0
#include <ceres/jet.h>

#include <array>

#include "data.hpp"
#include "horner.hpp"

namespace petzval::inline v0 {
namespace {

using Jet = ceres::Jet<double, 2>;

struct Pair {
  Jet x, y;

  friend Pair operator*(const Jet& s, const Pair& p) { return {s * p.x, s * p.y}; }
  friend Pair operator+(const Pair& a, const Pair& b) { return {a.x + b.x, a.y + b.y}; }
  friend Jet dot(const Pair& a, const Pair& b) { return a.x * b.x + a.y * b.y; }
};

/// s and o of the line (chart.hpp).
template <int n>
std::array<Pair, 2> evaluate(const double* c, const Pair& f, const Pair& p) noexcept {
  const Jet u = dot(f, f), v = dot(f, p), w = dot(p, p);
  constexpr int terms = polynomial_detail::term_count(n);
  const auto sum = [&](const double* at) {
    return polynomial_detail::horner<n>(at, u, v, w) * f + polynomial_detail::horner<n>(at + terms, u, v, w) * p;
  };
  return {sum(c), sum(c + 2 * terms)};
}

using Evaluate = std::array<Pair, 2> (*)(const double*, const Pair&, const Pair&) noexcept;
constexpr std::array<Evaluate, polynomial_detail::degree_count> evaluators{evaluate<1>, evaluate<2>, evaluate<3>,
                                                                           evaluate<4>, evaluate<5>};

}  // namespace

RayDerivatives RayPolynomial::to_scene(const TwoPlaneRayDerivatives& line, Wavelength at) const noexcept {
  Data::Room<double> room;
  const double* coefficients = data_->coefficients(at, room);
  const Domain& domain = data_->domain;
  RayDerivatives result{RayFate::outside_fit, {{0, 0, domain.reference_z}, {0, 0, -1}}};
  if (!coefficients) return result;
  const auto jet = [&](double TwoPlaneRay::*part, double scale) {
    Jet x(line.line.*part * scale);
    x.v[0] = line.by_u.*part * scale;
    x.v[1] = line.by_v.*part * scale;
    return x;
  };
  const double per_film = 1 / domain.film_radius, per_pupil = 1 / domain.pupil_radius;
  const Pair f{jet(&TwoPlaneRay::film_x, per_film), jet(&TwoPlaneRay::film_y, per_film)};
  const Jet shift(-domain.pupil_shift * domain.film_radius * per_pupil);
  const Pair p = Pair{jet(&TwoPlaneRay::pupil_x, per_pupil), jet(&TwoPlaneRay::pupil_y, per_pupil)} + shift * f;
  if (!(dot(f, f).a <= polynomial_detail::within_domain && dot(p, p).a <= polynomial_detail::within_domain))
    return result;

  const auto [s, o] = evaluators[data_->loop()](coefficients, f, p);
  const Jet square = dot(s, s), twice = 2.0 / (square + 1.0), along = twice * dot(s, o);
  const Jet x = o.x - s.x * along, y = o.y - s.y * along, z = along + domain.reference_z;
  const Jet dx = twice * s.x, dy = twice * s.y, dz = twice * (square - 1.0) / 2.0;
  const auto part = [&](int k) -> Ray<double> { return {{x.v[k], y.v[k], z.v[k]}, {dx.v[k], dy.v[k], dz.v[k]}}; };
  return {RayFate::transmitted, {{x.a, y.a, z.a}, {dx.a, dy.a, dz.a}}, part(0), part(1)};
}

}  // namespace petzval::inline v0
