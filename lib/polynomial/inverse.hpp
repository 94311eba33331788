// SPDX-License-Identifier: Apache-2.0
// Newton's method for the inverse of a polynomial, over a scalar V (core/scalar.hpp). In an unnamed namespace, for
// objects of several instruction sets (lib/README.md).
#pragma once

#include <array>

#include "core/scalar.hpp"
#include "sums.hpp"

namespace petzval::polynomial_detail {
namespace {

using kernel::absolute, kernel::any, kernel::any_of, kernel::without;

/// A number and its derivatives with respect to f and p.
template <class V>
struct Jet {
  V value;
  Four<V> by;
};

/// The factors A and B of s = A f + B p, or C and D of o. Not inlined: the code is long.
template <int n, class V>
__attribute__((noinline)) Jet<V> factor(OfRevolution<n>, const double* c, const Four<V>& x, std::size_t) noexcept {
  const auto at = OfRevolution<n>::variables(x);
  const auto [value, by_u, by_v, by_w] = horner_slopes<n, 4>(c, at.w, at.v, at.u);
  const V twice_u = by_u + by_u, twice_w = by_w + by_w;
  return {value,
          {twice_u * x[0] + by_v * x[2], twice_u * x[1] + by_v * x[3], by_v * x[0] + twice_w * x[2],
           by_v * x[1] + twice_w * x[3]}};
}

/// The same along one axis.
template <int n, class V>
__attribute__((noinline)) Jet<V> factor(OfMirrors<n>, const double* c, const Four<V>& x, std::size_t axis) noexcept {
  const std::size_t other = 1 - axis;
  const V film = x[axis], pupil = x[axis + 2], other_film = x[other], other_pupil = x[other + 2];
  const auto slopes = [&](const auto& of) {
    return of(other_pupil * other_pupil, other_film * other_film, pupil * pupil, film * film);
  };
  const auto even = slopes([&](const auto&... at) { return horner_slopes<n, 5>(c, at...); });
  const auto odd = slopes([&](const auto&... at) { return horner_slopes<n - 1, 5>(c + OfMirrors<n>::even, at...); });
  const V across = other_film * other_pupil;
  const auto sum = [&](std::size_t k) { return across * odd[k] + even[k]; };
  Jet<V> result;
  result.value = sum(0);
  result.by[axis] = V(2) * film * sum(1);
  result.by[axis + 2] = V(2) * pupil * sum(2);
  result.by[other] = V(2) * other_film * sum(3) + other_pupil * odd[0];
  result.by[other + 2] = V(2) * other_pupil * sum(4) + other_film * odd[0];
  return result;
}

/// s and o at a point, and their derivatives with respect to each of its coordinates.
template <class V>
struct At {
  Four<V> value;
  std::array<Four<V>, 4> by;
};

template <class Symmetry, class V>
At<V> evaluate(Symmetry symmetry, const double* c, const Four<V>& x) noexcept {
  At<V> at;
  Jet<V> film, pupil;
  for (std::size_t row = 0; row < 4; ++row) {
    const std::size_t axis = row % 2;
    if (axis < Symmetry::sections) {  // else the factors of the other axis
      const double* const own = c + (row / 2 * 2 * Symmetry::sections + axis) * Symmetry::terms;
      film = factor(symmetry, own, x, axis);
      pupil = factor(symmetry, own + Symmetry::sections * Symmetry::terms, x, axis);
    }
    at.value[row] = film.value * x[axis] + pupil.value * x[axis + 2];
    for (std::size_t k = 0; k < 4; ++k) at.by[k][row] = film.by[k] * x[axis] + pupil.by[k] * x[axis + 2];
    at.by[axis][row] = at.by[axis][row] + film.value;
    at.by[axis + 2][row] = at.by[axis + 2][row] + pupil.value;
  }
  return at;
}

template <class V>
PETZVAL_INLINE V determinant(const Four<V>& a, const Four<V>& b, const Four<V>& c, const Four<V>& d) noexcept {
  const auto minors = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    return (a[i] * b[j] - a[j] * b[i]) * (c[k] * d[l] - c[l] * d[k]);
  };
  return (minors(0, 1, 2, 3) - minors(0, 2, 1, 3)) + (minors(0, 3, 1, 2) + minors(1, 2, 0, 3)) +
         (minors(2, 3, 0, 1) - minors(1, 3, 0, 2));
}

/// Solves a linear system, given by columns, by Cramer's rule.
template <class V>
PETZVAL_INLINE Four<V> solution(const std::array<Four<V>, 4>& columns, const Four<V>& right) noexcept {
  const auto& [a, b, c, d] = columns;
  const V per_determinant = V(1) / determinant(a, b, c, d);
  return {determinant(right, b, c, d) * per_determinant, determinant(a, right, c, d) * per_determinant,
          determinant(a, b, right, d) * per_determinant, determinant(a, b, c, right) * per_determinant};
}

/// Film height, along one axis, at which the line through the centre of the pupil has a given slope (in the chart); the
/// smallest if there are several. The search ends at the height at which slopes stop growing: the lit film may end
/// there, and outside the fitted range a polynomial bends back.
/// @param c coefficients of the even powers of the height
template <int n, class V>
PETZVAL_INLINE V chief_height(const double* c, const V& slope) noexcept {
  constexpr int steps = 32, halvings = 7;
  const V sign(c[0] < 0 ? -1 : 1), length = absolute(slope);
  const auto at = [&](const V& height) { return sign * height * horner<n>(c, height * height); };
  V low(0), high(0), before(0);
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
  return select(slope < V(0), -sign, sign) * high;
}

/// The film point whose line through the centre of the pupil has approximately the direction of a given line.
template <int n, class V>
PETZVAL_INLINE Four<V> chief(OfRevolution<n>, const double* c, const Four<V>& line) noexcept {
  const V length = sqrt(line[0] * line[0] + line[1] * line[1]), none(0);
  const V scale = select(length > none, chief_height<n>(c, length) / length, none);
  return {scale * line[0], scale * line[1], none, none};
}

/// The same for mirror symmetry, from both sections independently; the combined point may lie outside the film.
template <int n, class V>
PETZVAL_INLINE Four<V> chief(OfMirrors<n>, const double* c, const Four<V>& line) noexcept {
  const V x = chief_height<n>(c, line[0]), y = chief_height<n>(c + OfMirrors<n>::terms, line[1]);
  const V square = x * x + y * y, one(1), none(0);
  const V scale = select(square > one, one / sqrt(square), one);
  return {scale * x, scale * y, none, none};
}

/// Newton's iteration with full steps, in some lanes, from a point with known value and derivatives. It fails if a step
/// is longer than half of the previous step, because the iteration may then reach another branch of the polynomial, or
/// if the iteration moves far from the domain. Returns the lanes that converged, inside or outside the domain.
template <class Symmetry, class V>
kernel::Mask<V> converge(Symmetry symmetry, const double* c, const Four<V>& target, kernel::Mask<V> active, At<V> at,
                         Four<V>& x) noexcept {
  constexpr double divergence_square = 2, converged_step = 1e-7, rounding = 1e-9;  // the square of a step is its error
  constexpr int max_iterations = 12;  // iterations that converge take three or four steps
  auto done = without(active, active);
  V last(1e300);
  for (int i = 1;; ++i) {
    Four<V> rest;
    for (std::size_t k = 0; k < 4; ++k) rest[k] = target[k] - at.value[k];
    const Four<V> move = solution(at.by, rest);
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

/// Moves from the line of x to the line `target`, in some lanes, over intermediate lines in steps for which the
/// iteration converges: one step in most cases, several for a fisheye. Returns the lanes that arrive in the domain.
template <class Symmetry, class V>
kernel::Mask<V> follow(Symmetry symmetry, const double* c, const Four<V>& target, kernel::Mask<V> open,
                       Four<V>& x) noexcept {
  const V none(0), shortest_step(1.0 / 64);
  const auto started = open;
  At<V> at = evaluate(symmetry, c, x);
  const Four<V> first = at.value;
  V left(1), step(1);
  for (;;) {
    const V next = select(left > step, left - step, none);
    Four<V> line, there = x;
    for (std::size_t k = 0; k < 4; ++k) line[k] = target[k] + next * (first[k] - target[k]);
    const auto reached = converge(symmetry, c, line, open, at, there);
    for (std::size_t k = 0; k < 4; ++k) x[k] = select(reached, there[k], x[k]);
    left = select(reached, next, left);
    step = step * select(reached, V(2), V(0.5));
    open = all_of(open, left > none, step >= shortest_step);
    if (!any(open)) return all_of(without(started, left > none), within(x, within_domain));
    at = evaluate(symmetry, c, x);
  }
}

/// Maps a ray that travels towards the lens (lens frame) to a line (mm); to the axis if no line in the domain is found.
/// Starts at a line of similar direction and, if this fails, at the axis, because the first start may lie outside the
/// fitted region.
template <class Symmetry, class V>
PETZVAL_INLINE Mapped<V, 4> to_film(Symmetry symmetry, const Scales<double>& scales, const double* c,
                                    const std::array<V, 6>& ray) noexcept {
  constexpr double tolerance = 1e-3;
  const auto& [x, y, z, dx, dy, dz] = ray;
  const Four<V> line = into_chart<V>({x, y, z - V(scales.reference_z), -dx, -dy, -dz});
  const V none(0);
  const auto sound =
      all_of(absolute(dx * dx + dy * dy + dz * dz - V(1)) < V(tolerance), V(scales.per_film_radius) > none);
  Four<V> at = chief(symmetry, c, line);
  auto lit = follow(symmetry, c, line, sound, at);
  const auto dark = without(sound, lit);
  if (any(dark)) {
    Four<V> again{none, none, none, none};
    lit = any_of(lit, follow(symmetry, c, line, dark, again));
    for (std::size_t k = 0; k < 4; ++k) at[k] = select(dark, again[k], at[k]);
  }
  at = out_of_domain(scales, at);
  for (V& number : at) number = select(lit, number, none);
  return {lit, at};
}

}  // namespace
}  // namespace petzval::polynomial_detail
