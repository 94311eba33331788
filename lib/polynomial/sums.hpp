// SPDX-License-Identifier: Apache-2.0
// s and o of a line (chart.hpp) and its transmittance as sums of terms, for each symmetry of a lens; n = (degree - 1) /
// 2 is the number of factors of a term. In an unnamed namespace, for objects of several instruction sets
// (lib/README.md).
#pragma once

#include <array>

#include "chart.hpp"
#include "core/scalar.hpp"
#include "horner.hpp"
#include "loops.hpp"

namespace petzval::polynomial_detail {
namespace {

using kernel::all_of, kernel::select;

/// Scales a line from mm to the domain.
template <class V>
PETZVAL_INLINE Four<V> in_domain(const Scales<kernel::Storage<V>>& scales, const Four<V>& line) noexcept {
  const auto& [film_x, film_y, pupil_x, pupil_y] = line;
  return {film_x * scales.per_film_radius, film_y * scales.per_film_radius,
          (pupil_x - scales.along_x.pupil_shift * film_x) * scales.along_x.per_pupil_radius,
          (pupil_y - scales.along_y.pupil_shift * film_y) * scales.along_y.per_pupil_radius};
}

/// Scales a line from the domain to mm.
template <class V>
PETZVAL_INLINE Four<V> out_of_domain(const Scales<kernel::Storage<V>>& scales, const Four<V>& at) noexcept {
  const V film_x = at[0] / scales.per_film_radius, film_y = at[1] / scales.per_film_radius;
  return {film_x, film_y, at[2] / scales.along_x.per_pupil_radius + scales.along_x.pupil_shift * film_x,
          at[3] / scales.along_y.per_pupil_radius + scales.along_y.pupil_shift * film_y};
}

/// True if the squares of the film and the pupil point are at most `square`.
template <class V>
PETZVAL_INLINE kernel::Mask<V> within(const Four<V>& x, double square) noexcept {
  const V limit(static_cast<kernel::Storage<V>>(square));
  return all_of(sum_of_products(x[0], x[0], x[1], x[1]) <= limit, sum_of_products(x[2], x[2], x[3], x[3]) <= limit);
}

/// s = A f + B p and o = C f + D p, with A to D polynomials of f.f, f.p and p.p.
template <int n>
struct OfRevolution {
  static constexpr int terms = term_count(n, 3), coefficients = 4 * terms, invariant_terms = terms;
  static constexpr std::size_t sections = 1, sum_count = 4, outputs = 6;

  template <class V>
  struct Variables {
    V u, v, w;
  };
  template <class V>
  static PETZVAL_INLINE Variables<V> variables(const Four<V>& at) noexcept {
    const auto& [fx, fy, px, py] = at;
    return {sum_of_products(fx, fx, fy, fy), sum_of_products(fx, px, fy, py), sum_of_products(px, px, py, py)};
  }
  /// A, B, C and D.
  /// @param c as in horner()
  template <class C, class V>
  static PETZVAL_INLINE Four<V> sums(const C& c, const Variables<V>& at) noexcept {
    const auto& [u, v, w] = at;
    return {horner<n>(c, w, v, u), horner<n>(c + terms, w, v, u), horner<n>(c + 2 * terms, w, v, u),
            horner<n>(c + 3 * terms, w, v, u)};
  }
  /// A polynomial that does not change if the line rotates about the axis.
  template <class C, class V>
  static PETZVAL_INLINE V invariant(const C& c, const Variables<V>& at) noexcept {
    return horner<n>(c, at.w, at.v, at.u);
  }

  template <class V>
  static PETZVAL_INLINE Four<V> line(const Four<V>& sums, const Four<V>& at) noexcept {
    const auto& [a, b, by_film, by_pupil] = sums;
    const auto& [fx, fy, px, py] = at;
    return {sum_of_products(a, fx, b, px), sum_of_products(a, fy, b, py), sum_of_products(by_film, fx, by_pupil, px),
            sum_of_products(by_film, fy, by_pupil, py)};
  }
};

/// For a lens that is symmetric about x = 0 and about y = 0. Components along x are odd in (fx, px) and even in (fy,
/// py): fx or px times the sum of a polynomial in the four squares and of fy py times such a polynomial with one factor
/// less. Components along y are the same with x and y exchanged.
template <int n>
struct OfMirrors {
  static constexpr int even = term_count(n, 4), terms = even + term_count(n - 1, 4), coefficients = 8 * terms;
  static constexpr int invariant_terms = terms + term_count(n - 1, 4) + term_count(n - 2, 4);
  static constexpr std::size_t sections = 2, sum_count = 4, outputs = 6;

  template <class V>
  using Variables = Four<V>;
  template <class V>
  static PETZVAL_INLINE Variables<V> variables(const Four<V>& at) noexcept {
    return at;
  }
  /// s and o themselves. Not inlined: the code is long.
  template <class C, class V>
  static __attribute__((noinline)) Four<V> sums(const C& c, const Four<V>& at) noexcept {
    const auto& [fx, fy, px, py] = at;
    const V fx2 = fx * fx, fy2 = fy * fy, px2 = px * px, py2 = py * py, across_x = fx * px, across_y = fy * py;
    const auto x = [&](const C& of) { return even_sum(of, across_y, py2, fy2, px2, fx2); };
    const auto y = [&](const C& of) { return even_sum(of, across_x, px2, fx2, py2, fy2); };
    const C o = c + 4 * terms;
    return {sum_of_products(fx, x(c), px, x(c + 2 * terms)), sum_of_products(fy, y(c + terms), py, y(c + 3 * terms)),
            sum_of_products(fx, x(o), px, x(o + 2 * terms)), sum_of_products(fy, y(o + terms), py, y(o + 3 * terms))};
  }
  /// A polynomial that does not change in a mirror: even in (fx, px) and even in (fy, py).
  template <class C, class V>
  static PETZVAL_INLINE V invariant(const C& c, const Four<V>& at) noexcept {
    const auto& [fx, fy, px, py] = at;
    const V fx2 = fx * fx, fy2 = fy * fy, px2 = px * px, py2 = py * py, across_x = fx * px, across_y = fy * py;
    return across_x * OfMirrors<n - 1>::even_sum(c + terms, across_y, py2, fy2, px2, fx2) +
           even_sum(c, across_y, py2, fy2, px2, fx2);
  }

  template <class V>
  static PETZVAL_INLINE Four<V> line(const Four<V>& sums, const Four<V>&) noexcept {
    return sums;
  }

  /// @param across product of film and pupil coordinates along the other axis
  template <class C, class V>
  static PETZVAL_INLINE V even_sum(const C& c, const V& across, const V& other_pupil2, const V& other_film2,
                                   const V& pupil2, const V& film2) noexcept {
    const V sum = horner<n>(c, other_pupil2, other_film2, pupil2, film2);
    if constexpr (n == 0) {
      return sum;
    } else {
      return across * horner<n - 1>(c + even, other_pupil2, other_film2, pupil2, film2) + sum;
    }
  }
};

/// A transmittance with the symmetry of a lens.
template <class Symmetry>
struct Transmittance {
  static constexpr int coefficients = Symmetry::invariant_terms;
  static constexpr std::size_t sum_count = 1, outputs = 1;

  template <class V>
  using Variables = typename Symmetry::template Variables<V>;
  template <class V>
  static PETZVAL_INLINE Variables<V> variables(const Four<V>& at) noexcept {
    return Symmetry::variables(at);
  }
  template <class C, class V>
  static PETZVAL_INLINE std::array<V, 1> sums(const C& c, const Variables<V>& at) noexcept {
    return {Symmetry::invariant(c, at)};
  }
};

/// A ray or a transmittance, and the mask of lanes in the domain of a fit.
template <class V, std::size_t outputs = 6>
struct Mapped {
  kernel::Mask<V> inside;
  std::array<V, outputs> out;
};

/// Maps a line (mm) to a ray (lens frame); to the reference point along the axis if the line is not inside. There is no
/// branch after the sums: compilers fuse a product with a sum only within a block of code. The
/// transmittance of a line outside the domain is the value at the edge.
/// @param sums sums of terms, called with the variables of Symmetry and the mask `inside`, from which it removes lanes
///   without a fit
template <class Symmetry, class V, class Sums>
PETZVAL_INLINE Mapped<V, Symmetry::outputs> map(const Scales<kernel::Storage<V>>& scales, const Four<V>& line,
                                                const Sums& sums) noexcept {
  using R = kernel::Storage<V>;
  Four<V> at = in_domain(scales, line);
  kernel::Mask<V> inside = within(at, within_domain);
  if constexpr (Symmetry::outputs == 1) {
    const V least(R(-1)), most(R(1));
    for (V& x : at) x = select(x > least, x, least), x = select(x < most, x, most);
    return {inside, sums(Symmetry::variables(at), inside)};
  } else {
    const V axis(R(0));
    Four<V> chart = Symmetry::line(sums(Symmetry::variables(at), inside), at);
    for (V& component : chart) component = select(inside, component, axis);
    LocalRay<V> ray = out_of_chart(chart);
    ray[2] = ray[2] + scales.reference_z;
    return {inside, ray};
  }
}

/// Maps a line by a fit.
template <class Symmetry, class V>
PETZVAL_INLINE Mapped<V, Symmetry::outputs> map(const Scales<kernel::Storage<V>>& scales, const Four<V>& line,
                                                const kernel::Storage<V>* coefficients) noexcept {
  return map<Symmetry>(scales, line,
                       [&](const auto& variables, auto&) { return Symmetry::sums(coefficients, variables); });
}

/// Calls a function with each symmetry, for the degrees 3, 5, 7, 9 and 11; Data::loop() is the index.
template <class Of>
constexpr auto by_symmetry_and_degree(Of of) {
  return std::array{of(OfRevolution<1>{}), of(OfRevolution<2>{}), of(OfRevolution<3>{}), of(OfRevolution<4>{}),
                    of(OfRevolution<5>{}), of(OfMirrors<1>{}),    of(OfMirrors<2>{}),    of(OfMirrors<3>{}),
                    of(OfMirrors<4>{}),    of(OfMirrors<5>{})};
}

/// Calls a function with the transmittances: of revolution by rising degree, then with mirror symmetry.
template <class Of>
constexpr auto by_transmittance(Of of) {
  return std::array{of(Transmittance<OfRevolution<1>>{}), of(Transmittance<OfRevolution<2>>{}),
                    of(Transmittance<OfRevolution<3>>{}), of(Transmittance<OfRevolution<4>>{}),
                    of(Transmittance<OfMirrors<1>>{}),    of(Transmittance<OfMirrors<2>>{})};
}

}  // namespace
}  // namespace petzval::polynomial_detail
