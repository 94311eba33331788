// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "chart.hpp"
#include "data.hpp"
#include "sums.hpp"

namespace petzval {
namespace {

using polynomial_detail::horner;
using polynomial_detail::OfMirrors;
using polynomial_detail::OfRevolution;
using polynomial_detail::SceneLine;
using Place = Eigen::Vector4d;  // f and p, scaled to the domain

/// Value of a polynomial and its derivatives with respect to the last N variables, in their order. Horner's rule
/// multiplies by the last variable most often, with only one derivative to carry then.
template <int N>
struct Gradient {
  double value = 0;
  std::array<double, N> by{};

  Gradient() = default;
  Gradient(double constant) noexcept : value(constant) {}
};

/// A variable followed by N - 1 others.
template <int N>
struct Variable {
  double value;

  friend PETZVAL_INLINE Gradient<N> operator*(const Variable& x, const Gradient<N>& p) noexcept {
    Gradient<N> product;
    product.value = x.value * p.value;
    product.by[0] = x.value * p.by[0] + p.value;
    for (std::size_t k = 1; k < N; ++k) product.by[k] = x.value * p.by[k];
    return product;
  }
  friend PETZVAL_INLINE Gradient<N> operator*(const Variable& x, double p) noexcept {
    Gradient<N> product;
    product.value = x.value * p;
    product.by[0] = p;
    return product;
  }
};

/// Adds a term that does not depend on the first variable.
template <int N>
PETZVAL_INLINE Gradient<N> operator+(const Gradient<N>& p, const Gradient<N - 1>& q) noexcept {
  Gradient<N> sum;
  sum.value = p.value + q.value;
  sum.by[0] = p.by[0];
  for (std::size_t k = 1; k < N; ++k) sum.by[k] = p.by[k] + q.by[k - 1];
  return sum;
}
template <int N>
PETZVAL_INLINE Gradient<N> operator+(const Gradient<N>& p, double q) noexcept {
  Gradient<N> sum = p;
  sum.value += q;
  return sum;
}

/// s and o at (f, p) with their derivatives: A f + B p, through the derivatives of A and B with respect to u, v and w.
/// Flattened, because compilers do not inline this much code otherwise.
template <int n>
[[gnu::flatten]] void evaluate(OfRevolution<n>, const double* c, const Place& x, Place& value,
                               Eigen::Matrix4d& slope) noexcept {
  const Variable<1> u{x[0] * x[0] + x[1] * x[1]};
  const Variable<2> v{x[0] * x[2] + x[1] * x[3]};
  const Variable<3> w{x[2] * x[2] + x[3] * x[3]};
  Eigen::Matrix<double, 3, 4> invariants;
  invariants << 2 * x[0], 2 * x[1], 0, 0, x[2], x[3], x[0], x[1], 0, 0, 2 * x[2], 2 * x[3];
  constexpr int terms = OfRevolution<n>::terms;
  const auto put = [&](int row, const Gradient<3>& by_film, const Gradient<3>& by_pupil) {
    const auto along = [&](const Gradient<3>& p, int k) {
      return p.by[2] * invariants(0, k) + p.by[1] * invariants(1, k) + p.by[0] * invariants(2, k);
    };
    for (int k = 0; k < 4; ++k) {
      const double film_slope = along(by_film, k), pupil_slope = along(by_pupil, k);
      for (int axis = 0; axis < 2; ++axis) {
        slope(row + axis, k) = film_slope * x[axis] + pupil_slope * x[axis + 2];
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      value[row + axis] = by_film.value * x[axis] + by_pupil.value * x[axis + 2];
      slope(row + axis, axis) += by_film.value;
      slope(row + axis, axis + 2) += by_pupil.value;
    }
  };
  put(0, horner<n>(c, w, v, u), horner<n>(c + terms, w, v, u));
  put(2, horner<n>(c + 2 * terms, w, v, u), horner<n>(c + 3 * terms, w, v, u));
}

/// The same through the derivatives of A and B with respect to the squares of fx, fy, px and py and to the product of
/// film and pupil coordinate along the other axis.
template <int n>
[[gnu::flatten]] void evaluate(OfMirrors<n>, const double* c, const Place& x, Place& value,
                               Eigen::Matrix4d& slope) noexcept {
  using Mirrors = OfMirrors<n>;
  for (const int axis : {0, 1}) {
    const int other = 1 - axis;
    const double film = x[axis], pupil = x[axis + 2], other_film = x[other], other_pupil = x[other + 2];
    const Variable<1> film2{film * film};
    const Variable<2> pupil2{pupil * pupil};
    const Variable<3> other_film2{other_film * other_film};
    const Variable<4> other_pupil2{other_pupil * other_pupil};
    for (const int row : {axis, axis + 2}) {
      value[row] = 0;
      slope.row(row).setZero();
      for (const int factor : {axis, axis + 2}) {  // film or pupil point
        const double* own = c + ((row - axis) * 2 + factor) * Mirrors::terms;
        const Gradient<4> even = horner<n>(own, other_pupil2, other_film2, pupil2, film2);
        const Gradient<4> odd = horner<n - 1>(own + Mirrors::even, other_pupil2, other_film2, pupil2, film2);
        const double sum = other_film * other_pupil * odd.value + even.value;
        const auto by = [&](std::size_t k) { return other_film * other_pupil * odd.by[k] + even.by[k]; };
        value[row] += x[factor] * sum;
        slope(row, factor) += sum;
        slope(row, axis) += x[factor] * 2 * film * by(3);
        slope(row, axis + 2) += x[factor] * 2 * pupil * by(2);
        slope(row, other) += x[factor] * (2 * other_film * by(1) + other_pupil * odd.value);
        slope(row, other + 2) += x[factor] * (2 * other_pupil * by(0) + other_film * odd.value);
      }
    }
  }
}

bool within(const Place& x, double square) noexcept {
  return x.head<2>().squaredNorm() <= square && x.tail<2>().squaredNorm() <= square;
}

/// Solves a linear system by elimination with partial pivoting.
PETZVAL_INLINE Place solution(Eigen::Matrix4d a, Place b) noexcept {
  for (int k = 0; k < 4; ++k) {
    int pivot = k;
    for (int i = k + 1; i < 4; ++i) pivot = std::abs(a(i, k)) > std::abs(a(pivot, k)) ? i : pivot;
    for (int j = k; j < 4; ++j) std::swap(a(k, j), a(pivot, j));
    std::swap(b[k], b[pivot]);
    const double per_pivot = 1 / a(k, k);
    for (int i = k + 1; i < 4; ++i) {
      const double factor = a(i, k) * per_pivot;
      for (int j = k + 1; j < 4; ++j) a(i, j) -= factor * a(k, j);
      b[i] -= factor * b[k];
    }
  }
  for (int k = 3; k >= 0; --k) {
    for (int j = k + 1; j < 4; ++j) b[k] -= a(k, j) * b[j];
    b[k] /= a(k, k);
  }
  return b;
}

/// Value and slope of a polynomial at a point.
struct At {
  Place value;
  Eigen::Matrix4d slope;
};

/// Newton's iteration, from a point with known value and slope. Returns false if a step is longer than half of the last
/// step, as it may then lead to another branch of the polynomial, or if it leaves the neighbourhood of the domain.
template <class Symmetry>
bool correct(const double* c, const Place& wanted, const At& begin, Place& x) noexcept {
  constexpr double far = 2, settled = 1e-7, rounding = 1e-9;  // the square of a settled step is its error
  At at = begin;
  for (double last = std::numeric_limits<double>::infinity();;) {
    const Place move = solution(at.slope, wanted - at.value);
    const double length = move.norm();
    x += move;
    if (!within(x, far)) return false;
    if (length < settled) return true;
    if (!(length < last / 2)) return length < rounding;
    last = length;
    evaluate(Symmetry{}, c, x, at.value, at.slope);
  }
}

/// Smallest film height, along one axis, at which the line through the centre of the pupil has the slope `s` (in the
/// chart). Stops at the height where slopes no longer grow: light may end there, and a polynomial bends back outside
/// the fitted range. slope: function of height, divided by the height.
template <class Slope>
double chief_height(double s, const Slope& slope) noexcept {
  constexpr int steps = 32, halvings = 7;
  const double length = std::abs(s), sign = slope(0) < 0 ? -1 : 1;
  const auto at = [&](double height) { return sign * height * slope(height); };
  double low = 0, high = 0, before = 0;
  for (int i = 1; i <= steps; ++i) {
    const double next = static_cast<double>(i) / steps, reached = at(next);
    if (reached < before) break;
    low = high, high = next, before = reached;
    if (reached >= length) break;
  }
  if (before > length) {
    for (int i = 0; i < halvings; ++i) {
      const double middle = (low + high) / 2;
      (at(middle) < length ? low : high) = middle;
    }
  }
  return std::copysign(high, sign * s);
}

/// The film point whose line through the centre of the pupil has approximately the direction of a given line.
template <int n>
Place chief(OfRevolution<n>, const double* c, const SceneLine& line) noexcept {
  const double length = std::hypot(line.sx, line.sy);
  if (!(length > 0)) return Place::Zero();
  const double part = chief_height(length, [c](double h) { return horner<n>(c, h * h); }) / length;
  return {part * line.sx, part * line.sy, 0, 0};
}

template <int n>
Place chief(OfMirrors<n>, const double* c, const SceneLine& line) noexcept {
  // Treats the sections as independent; the combination may lie outside the film.
  const double x = chief_height(line.sx, [c](double h) { return horner<n>(c, h * h); });
  const double y = chief_height(line.sy, [c](double h) { return horner<n>(c + OfMirrors<n>::terms, h * h); });
  const double within = std::max(std::hypot(x, y), 1.0);
  return {x / within, y / within, 0, 0};
}

/// Moves from the line of x to the line of `wanted` over intermediate lines, in steps that the iteration can follow:
/// mostly one step, several for a fisheye. Returns false if an iteration fails or the result is outside the domain.
template <class Symmetry>
bool follow(const double* c, const Place& wanted, Place& x) noexcept {
  At at;
  evaluate(Symmetry{}, c, x, at.value, at.slope);
  const Place first = at.value;
  double left = 1, step = 1;
  while (left > 0) {
    const double next = std::max(left - step, 0.0);
    Place there = x;
    if (correct<Symmetry>(c, wanted + next * (first - wanted), at, there)) {
      x = there;
      left = next;
      step *= 2;
      if (left > 0) evaluate(Symmetry{}, c, x, at.value, at.slope);
    } else if ((step /= 2) < 1.0 / 64) {
      return false;
    }
  }
  return within(x, polynomial_detail::within_domain);
}

/// Finds (f, p) of a line; returns false if no solution in the domain is found. Starts at a line of similar direction
/// and, if this fails, at the axis: the first start may lie outside the fitted light.
template <class Symmetry>
bool solve(const double* c, const SceneLine& line, Place& x) noexcept {
  const Place wanted(line.sx, line.sy, line.ox, line.oy);
  x = chief(Symmetry{}, c, line);
  if (follow<Symmetry>(c, wanted, x)) return true;
  x.setZero();
  return follow<Symmetry>(c, wanted, x);
}

using Solve = bool (*)(const double*, const SceneLine&, Place&) noexcept;
constexpr auto solvers =
    polynomial_detail::by_symmetry_and_degree([]<class Symmetry>(Symmetry) -> Solve { return solve<Symmetry>; });

}  // namespace

void RayPolynomial::to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                            const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
  const Solve solve = solvers[data_->loop()];
  const Domain& domain = data_->domain;
  const auto [along_x, along_y] = polynomial_detail::sections(domain);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3<double> direction(-rays.dx[i], -rays.dy[i], -rays.dz[i]);
    const Vec3<double> point(rays.x[i], rays.y[i], rays.z[i] - domain.reference_z);
    const SceneLine line = polynomial_detail::scene_line(direction, point);
    Place x;
    Data::Room<double> room;
    const double* coefficients = data_->coefficients(wavelengths.at(i), room);
    const double length = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
    const bool found = std::abs(length - 1) < 1e-3 && coefficients && solve(coefficients, line, x);
    if (!found) x.setZero();
    lines.film_x[i] = x[0] * domain.film_radius;
    lines.film_y[i] = x[1] * domain.film_radius;
    lines.pupil_x[i] = x[2] * along_x.pupil_radius + along_x.pupil_shift * lines.film_x[i];
    lines.pupil_y[i] = x[3] * along_y.pupil_radius + along_y.pupil_shift * lines.film_y[i];
    fates[i] = found ? RayFate::transmitted : RayFate::outside_fit;
  }
}

}  // namespace petzval
