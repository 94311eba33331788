// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Scalar functions that vectorised loops call.
namespace petzval::core_detail {

// Local names: this file is compiled for several instruction sets, and the linker must not merge their functions.
namespace {

inline float square_root(float x) noexcept { return __builtin_sqrtf(x); }
inline double square_root(double x) noexcept { return __builtin_sqrt(x); }
template <class T>
inline T square_root(const T& x) noexcept {
  return sqrt(x);
}

/// x clamped to [0, 1]; 0 for NaN.
template <class R>
inline R clamped(R x) noexcept {
  x = x > R(0) ? x : R(0);
  return x < R(1) ? x : R(1);
}

}  // namespace
}  // namespace petzval::core_detail
