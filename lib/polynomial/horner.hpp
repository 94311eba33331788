// SPDX-License-Identifier: Apache-2.0
// Polynomials in the three invariants as straight-line code: compilers do not unroll Horner loops over triangles of
// coefficients, but they do unroll a recursion over the degree. In an unnamed namespace, for objects of several
// instruction sets (lib/README.md).
#pragma once

#include "core/simd.hpp"

namespace petzval::inline v0::polynomial_detail {
namespace {

/// Coefficients of the terms u^i v^j w^k, i + j + k <= n.
constexpr int term_count(int n) { return (n + 1) * (n + 2) * (n + 3) / 6; }

/// c[0] + c[1] u + ... + c[n] u^n.
template <int n, class R, class T>
PETZVAL_INLINE auto along_u(const R* c, const T& u) noexcept {
  if constexpr (n == 0) {
    return c[0];
  } else {
    return u * along_u<n - 1>(c + 1, u) + c[0];
  }
}

/// The terms without w.
template <int n, class R, class T>
PETZVAL_INLINE auto along_v(const R* c, const T& u, const T& v) noexcept {
  if constexpr (n == 0) {
    return c[0];
  } else {
    return v * along_v<n - 1>(c + n + 1, u, v) + along_u<n>(c, u);
  }
}

/// All terms, in the order of RayPolynomial::terms: those without w, then w times those with one factor less, ...; in
/// each group those without v first. T: float, double, lanes or a dual number; R: the plain type of its constants.
template <int n, class R, class T>
PETZVAL_INLINE auto horner(const R* c, const T& u, const T& v, const T& w) noexcept {
  if constexpr (n == 0) {
    return c[0];
  } else {
    return w * horner<n - 1>(c + (n + 1) * (n + 2) / 2, u, v, w) + along_v<n>(c, u, v);
  }
}

}  // namespace
}  // namespace petzval::inline v0::polynomial_detail
