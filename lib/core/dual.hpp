// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <compare>

#include "core/simd.hpp"

namespace petzval::kernel {

/// Derivatives of a number with respect to two variables.
struct Gradient {
  double x = 0, y = 0;

  double& operator[](int i) noexcept { return i == 0 ? x : y; }
  double operator[](int i) const noexcept { return i == 0 ? x : y; }
  PETZVAL_INLINE friend Gradient operator+(const Gradient& a, const Gradient& b) noexcept {
    return {a.x + b.x, a.y + b.y};
  }
  PETZVAL_INLINE friend Gradient operator-(const Gradient& a, const Gradient& b) noexcept {
    return {a.x - b.x, a.y - b.y};
  }
  PETZVAL_INLINE friend Gradient operator-(const Gradient& a) noexcept { return {-a.x, -a.y}; }
  PETZVAL_INLINE friend Gradient operator*(const Gradient& a, double s) noexcept { return {a.x * s, a.y * s}; }
  PETZVAL_INLINE friend Gradient operator*(double s, const Gradient& a) noexcept { return a * s; }
};

/// A number with its derivatives with respect to two variables: a scalar type of the kernels. Comparisons use only the
/// values.
struct Dual {
  using Scalar = double;

  double a = 0;  ///< value
  Gradient v{};  ///< derivatives

  constexpr Dual() noexcept = default;
  constexpr explicit Dual(double value) noexcept : a(value) {}
  constexpr Dual(double value, const Gradient& gradient) noexcept : a(value), v(gradient) {}
  /// The independent variable 0 or 1.
  Dual(double value, int variable) noexcept : a(value) { v[variable] = 1; }

  PETZVAL_INLINE friend Dual operator-(const Dual& f) noexcept { return {-f.a, -f.v}; }
  PETZVAL_INLINE friend Dual operator+(const Dual& f, const Dual& g) noexcept { return {f.a + g.a, f.v + g.v}; }
  PETZVAL_INLINE friend Dual operator+(const Dual& f, double s) noexcept { return {f.a + s, f.v}; }
  PETZVAL_INLINE friend Dual operator+(double s, const Dual& f) noexcept { return f + s; }
  PETZVAL_INLINE friend Dual operator-(const Dual& f, const Dual& g) noexcept { return {f.a - g.a, f.v - g.v}; }
  PETZVAL_INLINE friend Dual operator-(const Dual& f, double s) noexcept { return {f.a - s, f.v}; }
  PETZVAL_INLINE friend Dual operator-(double s, const Dual& f) noexcept { return {s - f.a, -f.v}; }
  PETZVAL_INLINE friend Dual operator*(const Dual& f, const Dual& g) noexcept {
    return {f.a * g.a, f.a * g.v + f.v * g.a};
  }
  PETZVAL_INLINE friend Dual operator*(const Dual& f, double s) noexcept { return {f.a * s, f.v * s}; }
  PETZVAL_INLINE friend Dual operator*(double s, const Dual& f) noexcept { return f * s; }
  PETZVAL_INLINE friend Dual operator/(const Dual& f, const Dual& g) noexcept {
    const double inverse = 1 / g.a, value = f.a * inverse;
    return {value, (f.v - value * g.v) * inverse};
  }
  PETZVAL_INLINE friend Dual operator/(const Dual& f, double s) noexcept { return f * (1 / s); }
  PETZVAL_INLINE friend Dual operator/(double s, const Dual& g) noexcept { return {s / g.a, g.v * (-s / (g.a * g.a))}; }
  Dual& operator+=(const auto& g) noexcept { return *this = *this + g; }
  Dual& operator-=(const auto& g) noexcept { return *this = *this - g; }
  Dual& operator*=(const auto& g) noexcept { return *this = *this * g; }

  PETZVAL_INLINE friend bool operator==(const Dual& f, const Dual& g) noexcept { return f.a == g.a; }
  PETZVAL_INLINE friend bool operator==(const Dual& f, double s) noexcept { return f.a == s; }
  PETZVAL_INLINE friend auto operator<=>(const Dual& f, const Dual& g) noexcept { return f.a <=> g.a; }
  PETZVAL_INLINE friend auto operator<=>(const Dual& f, double s) noexcept { return f.a <=> s; }

  PETZVAL_INLINE friend Dual abs(const Dual& f) noexcept { return std::signbit(f.a) ? -f : f; }
  PETZVAL_INLINE friend Dual sqrt(const Dual& f) noexcept {
    const double root = std::sqrt(f.a);
    return {root, f.v * (1 / (2 * root))};
  }
};

}  // namespace petzval::kernel
