// SPDX-License-Identifier: Apache-2.0
// Newton's method for the inverse of a polynomial, over a scalar V (core/scalar.hpp): one line in double, or as many
// lines as a register holds. In an unnamed namespace, for objects of several instruction sets (lib/README.md).
#pragma once

#include <array>
#include <cmath>

#include "core/scalar.hpp"
#include "sums.hpp"

namespace petzval::polynomial_detail {
namespace {

using kernel::absolute, kernel::any, kernel::any_of, kernel::without;
using std::sqrt;

/// Derivatives of s and o, [row][column], with respect to f and p.
template <class V>
using Slopes = std::array<Four<V>, 4>;

/// s and o at a point, with their derivatives.
template <class V>
struct At {
  Four<V> value;
  Slopes<V> slope;
};

/// Value of a polynomial and its derivatives with respect to the last N variables, in their order. Most multiplications
/// of Horner's rule are by the last variable, and there only one derivative must be computed.
template <std::size_t N, class V>
struct Gradient {
  V value;
  std::array<V, N> by;

  Gradient() = default;
  PETZVAL_INLINE Gradient(double constant) noexcept : value(constant) { by.fill(V(0.0)); }
};

/// A variable followed by N - 1 others.
template <std::size_t N, class V>
struct Variable {
  V value;

  friend PETZVAL_INLINE Gradient<N, V> operator*(const Variable& x, const Gradient<N, V>& p) noexcept {
    Gradient<N, V> product;
    product.value = x.value * p.value;
    product.by[0] = x.value * p.by[0] + p.value;
    for (std::size_t k = 1; k < N; ++k) product.by[k] = x.value * p.by[k];
    return product;
  }
  friend PETZVAL_INLINE Gradient<N, V> operator*(const Variable& x, double p) noexcept {
    Gradient<N, V> product;
    product.value = x.value * V(p);
    product.by[0] = V(p);
    for (std::size_t k = 1; k < N; ++k) product.by[k] = V(0.0);
    return product;
  }
};

/// Adds a sum without the first variable.
template <std::size_t N, class V>
PETZVAL_INLINE Gradient<N, V> operator+(const Gradient<N, V>& p, const Gradient<N - 1, V>& q) noexcept {
  Gradient<N, V> sum;
  sum.value = p.value + q.value;
  sum.by[0] = p.by[0];
  for (std::size_t k = 1; k < N; ++k) sum.by[k] = p.by[k] + q.by[k - 1];
  return sum;
}
template <std::size_t N, class V>
PETZVAL_INLINE Gradient<N, V> operator+(const Gradient<N, V>& p, double q) noexcept {
  Gradient<N, V> sum = p;
  sum.value = sum.value + V(q);
  return sum;
}

/// s and o at (f, p) with their derivatives: A f + B p, through the derivatives of A and B with respect to u, v and w.
/// Flattened, because compilers do not inline this much code otherwise.
template <int n, class V>
[[gnu::flatten]] At<V> evaluate(OfRevolution<n>, const double* c, const Four<V>& x) noexcept {
  At<V> at;
  Four<V>& value = at.value;
  Slopes<V>& slope = at.slope;
  const Variable<1, V> u{x[0] * x[0] + x[1] * x[1]};
  const Variable<2, V> v{x[0] * x[2] + x[1] * x[3]};
  const Variable<3, V> w{x[2] * x[2] + x[3] * x[3]};
  const V two(2.0);
  constexpr int terms = OfRevolution<n>::terms;
  const auto put = [&](std::size_t row, const Gradient<3, V>& by_film, const Gradient<3, V>& by_pupil) {
    const auto along = [&](const Gradient<3, V>& p, std::size_t k) {
      return k < 2 ? p.by[2] * (two * x[k]) + p.by[1] * x[k + 2] : p.by[1] * x[k - 2] + p.by[0] * (two * x[k]);
    };
    for (std::size_t k = 0; k < 4; ++k) {
      const V film_slope = along(by_film, k), pupil_slope = along(by_pupil, k);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        slope[row + axis][k] = film_slope * x[axis] + pupil_slope * x[axis + 2];
      }
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
      value[row + axis] = by_film.value * x[axis] + by_pupil.value * x[axis + 2];
      slope[row + axis][axis] = slope[row + axis][axis] + by_film.value;
      slope[row + axis][axis + 2] = slope[row + axis][axis + 2] + by_pupil.value;
    }
  };
  put(0, horner<n>(c, w, v, u), horner<n>(c + terms, w, v, u));
  put(2, horner<n>(c + 2 * terms, w, v, u), horner<n>(c + 3 * terms, w, v, u));
  return at;
}

/// The same, with derivatives of A and B with respect to the squares of fx, fy, px and py and to the product of film
/// and pupil coordinates along the other axis.
template <int n, class V>
[[gnu::flatten]] At<V> evaluate(OfMirrors<n>, const double* c, const Four<V>& x) noexcept {
  using Mirrors = OfMirrors<n>;
  At<V> at;
  Four<V>& value = at.value;
  Slopes<V>& slope = at.slope;
  for (const std::size_t axis : {0, 1}) {
    const std::size_t other = 1 - axis;
    const V film = x[axis], pupil = x[axis + 2], other_film = x[other], other_pupil = x[other + 2];
    const Variable<1, V> film2{film * film};
    const Variable<2, V> pupil2{pupil * pupil};
    const Variable<3, V> other_film2{other_film * other_film};
    const Variable<4, V> other_pupil2{other_pupil * other_pupil};
    for (const std::size_t row : {axis, axis + 2}) {
      value[row] = V(0.0);
      slope[row].fill(V(0.0));
      for (const std::size_t factor : {axis, axis + 2}) {  // film or pupil point
        const double* own = c + ((row - axis) * 2 + factor) * Mirrors::terms;
        const Gradient<4, V> even = horner<n>(own, other_pupil2, other_film2, pupil2, film2);
        const Gradient<4, V> odd = horner<n - 1>(own + Mirrors::even, other_pupil2, other_film2, pupil2, film2);
        const V sum = other_film * other_pupil * odd.value + even.value, two(2.0);
        const auto by = [&](std::size_t k) { return other_film * other_pupil * odd.by[k] + even.by[k]; };
        const auto add = [&](std::size_t column, const V& more) { slope[row][column] = slope[row][column] + more; };
        value[row] = value[row] + x[factor] * sum;
        add(factor, sum);
        add(axis, x[factor] * two * film * by(3));
        add(axis + 2, x[factor] * two * pupil * by(2));
        add(other, x[factor] * (two * other_film * by(1) + other_pupil * odd.value));
        add(other + 2, x[factor] * (two * other_pupil * by(0) + other_film * odd.value));
      }
    }
  }
  return at;
}

/// Solves a linear system by elimination; the pivot is the largest element of each column.
template <class V>
PETZVAL_INLINE Four<V> solution(Slopes<V> a, Four<V> b) noexcept {
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = k + 1; i < 4; ++i) {
      const auto larger = absolute(a[k][k]) < absolute(a[i][k]);
      const auto exchange = [&](V& x, V& y) {
        const V first = select(larger, y, x);
        y = select(larger, x, y);
        x = first;
      };
      for (std::size_t j = k; j < 4; ++j) exchange(a[k][j], a[i][j]);
      exchange(b[k], b[i]);
    }
    const V per_pivot = V(1.0) / a[k][k];
    for (std::size_t i = k + 1; i < 4; ++i) {
      const V factor = a[i][k] * per_pivot;
      for (std::size_t j = k + 1; j < 4; ++j) a[i][j] = a[i][j] - factor * a[k][j];
      b[i] = b[i] - factor * b[k];
    }
  }
  for (std::size_t k = 4; k-- > 0;) {
    for (std::size_t j = k + 1; j < 4; ++j) b[k] = b[k] - a[k][j] * b[j];
    b[k] = b[k] / a[k][k];
  }
  return b;
}

/// Smallest film height, along one axis, at which the line through the centre of the pupil has the slope `length` >= 0
/// (in the chart). The search ends at the height at which slopes stop growing: the lit film may end there, and outside
/// the fitted range a polynomial bends back.
/// @param slope the slope divided by the height, as a function of the height; positive at 0
template <class V, class Slope>
PETZVAL_INLINE V chief_height(const V& length, const Slope& slope) noexcept {
  constexpr int steps = 32, halvings = 7;
  const auto at = [&](const V& height) { return height * slope(height); };
  V low(0.0), high(0.0), before(0.0);
  auto open = before <= length;
  for (int i = 1; i <= steps && any(open); ++i) {
    const V next(static_cast<double>(i) / steps), reached = at(next);
    open = without(open, reached < before);
    low = select(open, high, low), high = select(open, next, high), before = select(open, reached, before);
    open = all_of(open, reached < length);
  }
  const auto passed = before > length;
  for (int i = 0; i < halvings && any(passed); ++i) {
    const V middle = (low + high) * V(0.5);
    const auto below = at(middle) < length;
    low = select(all_of(passed, below), middle, low);
    high = select(without(passed, below), middle, high);
  }
  return high;
}

/// The film point whose line through the centre of the pupil has approximately the direction of a given line.
template <int n, class V>
PETZVAL_INLINE Four<V> chief(OfRevolution<n>, const double* c, const Four<V>& line) noexcept {
  const V length = sqrt(line[0] * line[0] + line[1] * line[1]), sign(c[0] < 0 ? -1.0 : 1.0), none(0.0);
  const V height = chief_height(length, [&](const V& h) { return sign * horner<n>(c, h * h); });
  const V scale = select(length > none, sign * height / length, none);
  return {scale * line[0], scale * line[1], none, none};
}

/// Newton's iteration with full steps, from a point with known value and derivatives. It fails if a step is longer than
/// half of the previous step, because the iteration may then reach another branch of the polynomial, or if the
/// iteration moves far from the domain. Returns the lanes that converged, inside or outside the domain.
template <class Symmetry, class V>
kernel::Mask<V> converge(Symmetry symmetry, const double* c, const Four<V>& target, At<V> at, Four<V>& x) noexcept {
  constexpr double divergence_square = 2, converged_step = 1e-7, rounding = 1e-9;  // the square of a step is its error
  constexpr int max_iterations = 12;  // iterations that converge take three or four steps
  const V none(0.0), one(1.0);
  auto active = none < one, done = one < none;
  V last(1e300);
  for (int i = 1;; ++i) {
    Four<V> rest;
    for (std::size_t k = 0; k < 4; ++k) rest[k] = target[k] - at.value[k];
    const Four<V> move = solution(at.slope, rest);
    for (std::size_t k = 0; k < 4; ++k) x[k] = select(active, x[k] + move[k], x[k]);
    const V length = sqrt((move[0] * move[0] + move[1] * move[1]) + (move[2] * move[2] + move[3] * move[3]));
    active = all_of(active, within(x, divergence_square));
    const auto halved = length < last * V(0.5);
    const auto settled = any_of(length < V(converged_step), without(length < V(rounding), halved));
    done = any_of(done, all_of(active, settled));
    active = without(all_of(active, halved), done);
    if (i == max_iterations || !any(active)) return done;
    last = length;
    at = evaluate(symmetry, c, x);
  }
}

}  // namespace
}  // namespace petzval::polynomial_detail
