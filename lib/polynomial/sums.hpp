// SPDX-License-Identifier: Apache-2.0
// s and o of a line (chart.hpp) as sums of terms, for each symmetry of a lens; n = (degree - 1) / 2 is the number of
// factors of a term. In an unnamed namespace, for objects of several instruction sets (lib/README.md).
#pragma once

#include <array>

#include "horner.hpp"

namespace petzval::polynomial_detail {
namespace {

using core_detail::sum_of_products;

/// Film and pupil point, scaled to the domain.
template <class T>
struct FilmAndPupil {
  T fx, fy, px, py;

  PETZVAL_INLINE T film_square() const noexcept { return sum_of_products(fx, fx, fy, fy); }
  PETZVAL_INLINE T pupil_square() const noexcept { return sum_of_products(px, px, py, py); }
};

/// Scales a line from mm to the domain. R: plain type of T. Scaling: Scales<R>.
template <class R, class T, class Scaling>
PETZVAL_INLINE FilmAndPupil<T> in_domain(const Scaling& scales, const FilmAndPupil<T>& line) noexcept {
  const auto& [film_x, film_y, pupil_x, pupil_y] = line;
  return {film_x * scales.per_film_radius, film_y * scales.per_film_radius,
          (pupil_x - scales.along_x.pupil_shift * film_x) * scales.along_x.per_pupil_radius,
          (pupil_y - scales.along_y.pupil_shift * film_y) * scales.along_y.per_pupil_radius};
}

template <class T>
struct FourSums {
  T first, second, third, fourth;
};

template <class T>
struct ChartLine {
  T sx, sy, ox, oy;
};

template <class T>
struct LocalRay {
  T x, y, z;  ///< relative to the reference point
  T dx, dy, dz;
};

/// Converts a line from the chart to a ray (chart.hpp). R: plain type of T.
template <class R, class T>
PETZVAL_INLINE LocalRay<T> out_of_chart(const ChartLine<T>& line) noexcept {
  const auto& [sx, sy, ox, oy] = line;
  const T square = sum_of_products(sx, sx, sy, sy);
  const T twice = R(2) / (square + R(1));
  const T along = twice * sum_of_products(sx, ox, sy, oy);
  return {ox - sx * along, oy - sy * along, along, twice * sx, twice * sy, twice * (square - R(1)) / R(2)};
}

/// s = A f + B p and o = C f + D p, with A to D polynomials of f.f, f.p and p.p.
template <int n>
struct OfRevolution {
  static constexpr int terms = term_count(n, 3), coefficients = 4 * terms;
  /// True: these sums have the same bits in all code, because they leave a compiler no choice of products to fuse.
  static constexpr bool same_bits = true;

  template <class T>
  struct Variables {
    T u, v, w;
  };
  template <class T>
  static PETZVAL_INLINE Variables<T> variables(const FilmAndPupil<T>& at) noexcept {
    return {at.film_square(), sum_of_products(at.fx, at.px, at.fy, at.py), at.pupil_square()};
  }
  /// A, B, C and D.
  /// @param c as in horner()
  template <class C, class T>
  static PETZVAL_INLINE FourSums<T> sums(const C& c, const Variables<T>& at) noexcept {
    const auto& [u, v, w] = at;
    return {horner<n>(c, w, v, u), horner<n>(c + terms, w, v, u), horner<n>(c + 2 * terms, w, v, u),
            horner<n>(c + 3 * terms, w, v, u)};
  }

  template <class T>
  static PETZVAL_INLINE ChartLine<T> line(const FourSums<T>& sums, const FilmAndPupil<T>& at) noexcept {
    const auto& [a, b, by_film, by_pupil] = sums;
    return {sum_of_products(a, at.fx, b, at.px), sum_of_products(a, at.fy, b, at.py),
            sum_of_products(by_film, at.fx, by_pupil, at.px), sum_of_products(by_film, at.fy, by_pupil, at.py)};
  }
};

/// For a lens that is symmetric about x = 0 and about y = 0. Components along x are odd in (fx, px) and even in (fy,
/// py): fx or px times the sum of a polynomial in the four squares and of fy py times such a polynomial with one factor
/// less. Components along y are the same with x and y exchanged.
template <int n>
struct OfMirrors {
  static constexpr int even = term_count(n, 4), terms = even + term_count(n - 1, 4), coefficients = 8 * terms;
  static constexpr bool same_bits = false;

  template <class T>
  using Variables = FilmAndPupil<T>;
  template <class T>
  static PETZVAL_INLINE Variables<T> variables(const FilmAndPupil<T>& at) noexcept {
    return at;
  }
  /// s and o themselves. Not inlined: one function per degree gives every caller the same bits.
  template <class R, class T>
  static __attribute__((noinline)) FourSums<T> sums(const R* c, const FilmAndPupil<T>& at) noexcept {
    const auto& [fx, fy, px, py] = at;
    const T fx2 = fx * fx, fy2 = fy * fy, px2 = px * px, py2 = py * py, across_x = fx * px, across_y = fy * py;
    const auto x = [&](const R* of) { return even_sum(of, across_y, py2, fy2, px2, fx2); };
    const auto y = [&](const R* of) { return even_sum(of, across_x, px2, fx2, py2, fy2); };
    const R* o = c + 4 * terms;
    return {fx * x(c) + px * x(c + 2 * terms), fy * y(c + terms) + py * y(c + 3 * terms),
            fx * x(o) + px * x(o + 2 * terms), fy * y(o + terms) + py * y(o + 3 * terms)};
  }

  template <class T>
  static PETZVAL_INLINE ChartLine<T> line(const FourSums<T>& sums, const FilmAndPupil<T>&) noexcept {
    return {sums.first, sums.second, sums.third, sums.fourth};
  }

 private:
  /// @param across product of film and pupil coordinates along the other axis
  template <class R, class T>
  static PETZVAL_INLINE T even_sum(const R* c, const T& across, const T& other_pupil2, const T& other_film2,
                                   const T& pupil2, const T& film2) noexcept {
    return across * horner<n - 1>(c + even, other_pupil2, other_film2, pupil2, film2) +
           horner<n>(c, other_pupil2, other_film2, pupil2, film2);
  }
};

/// Calls a function with each symmetry, for the degrees 3, 5, 7, 9 and 11; Data::loop() is the index.
template <class Of>
constexpr auto by_symmetry_and_degree(Of of) {
  return std::array{of(OfRevolution<1>{}), of(OfRevolution<2>{}), of(OfRevolution<3>{}), of(OfRevolution<4>{}),
                    of(OfRevolution<5>{}), of(OfMirrors<1>{}),    of(OfMirrors<2>{}),    of(OfMirrors<3>{}),
                    of(OfMirrors<4>{}),    of(OfMirrors<5>{})};
}

}  // namespace
}  // namespace petzval::polynomial_detail
