// SPDX-License-Identifier: Apache-2.0
// Polynomials in several variables as straight-line code: compilers do not unroll Horner loops over triangles of
// coefficients, but they do unroll a recursion over degree and variables. In an unnamed namespace, for objects of
// several instruction sets (lib/README.md).
#pragma once

#include <array>
#include <cstddef>

#include "core/simd.hpp"

namespace petzval::polynomial_detail {
namespace {

/// Number of products of at most n factors from some variables.
constexpr int term_count(int n, int variables) {
  int count = 1;
  for (int k = 1; k <= variables; ++k) count = count * (n + k) / k;
  return count;
}

template <int n, class C>
PETZVAL_INLINE auto horner(const C& c) noexcept {
  return c[0];
}

/// Evaluates a polynomial of all products of at most n variables.
///
/// Order of coefficients: first the terms without the first variable, then the terms with it, as a polynomial with one
/// factor less; the same order within each group. Powers of the last variable change fastest.
///
/// T: float, double, lanes or a dual number. C: pointer to constants, or a type that is read like a pointer.
template <int n, class C, class T, class... Rest>
PETZVAL_INLINE auto horner(const C& c, const T& first, const Rest&... rest) noexcept {
  if constexpr (n == 0) {
    return c[0];
  } else {
    return first * horner<n - 1>(c + term_count(n, sizeof...(rest)), first, rest...) + horner<n>(c, rest...);
  }
}

/// The same value, followed by N - 1 derivatives with respect to the variables, from the last to the first. Most
/// multiplications are by the last variable, and there only one derivative must be computed.
template <int n, std::size_t N, class T, class... Rest>
PETZVAL_INLINE std::array<T, N> horner_slopes(const double* c, const T& first, const Rest&... rest) noexcept {
  constexpr std::size_t last = 1 + sizeof...(rest);
  std::array<T, N> p{};
  if constexpr (n > 0 && last > 1) {
    p = horner_slopes<n, N>(c, rest...);
  } else {
    p[0] = T(c[0]);
  }
  if constexpr (n > 0) {
    const auto factor = horner_slopes<n - 1, N>(c + term_count(n, sizeof...(rest)), first, rest...);
    p[0] = first * factor[0] + p[0];
    p[last] = factor[0];
    if constexpr (n > 1) {  // else the factor is a constant
      for (std::size_t k = 1; k < last; ++k) p[k] = first * factor[k] + p[k];
      p[last] = first * factor[last] + factor[0];
    }
  }
  return p;
}

}  // namespace
}  // namespace petzval::polynomial_detail
