// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

// Lost rays are detected by comparisons with NaN and infinity, which these options allow the compiler to drop.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST)
#error "petzval needs IEEE comparisons: compile without -ffast-math and -ffinite-math-only (/fp:fast)"
#endif

/// The interface between the kernels and their scalars.
///
/// A kernel is written once over a scalar `T`: float, double, SIMD lanes, or a number with derivatives such as `Dual`.
/// It needs arithmetic, comparison, `sqrt` by argument-dependent look-up, and the names below. Branches never depend on
/// ray data except through `select`, `any` and masks.
namespace petzval::kernel {

namespace detail {
template <class T>
struct StorageOf {
  using type = T;
};
template <class T>
  requires requires { typename T::Scalar; }
struct StorageOf<T> {
  using type = typename T::Scalar;
};
}  // namespace detail

/// The plain floating-point type in which the constants of a lens are stored for the scalar `T`.
template <class T>
using Storage = typename detail::StorageOf<T>::type;

/// Result of comparing two scalars: bool, or a lane mask.
template <class T>
using Mask = decltype(T() < T());

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559,
              "the kernels need IEEE numbers");

/// mask ? a : b, lane by lane. Both sides are always computed, so neither may trap.
template <class T>
constexpr T select(bool mask, const T& a, const T& b) noexcept {
  return mask ? a : b;
}

constexpr bool any(bool mask) noexcept { return mask; }

/// True in the lanes in which every condition holds.
template <class... Masks>
constexpr bool all_of(bool first, Masks... rest) noexcept {
  return (first && ... && rest);
}

/// True in the lanes in which either condition holds.
constexpr bool any_of(bool a, bool b) noexcept { return a || b; }

/// True in the lanes in which `a` holds and `b` does not.
constexpr bool without(bool a, bool b) noexcept { return a && !b; }

/// Tables of numbers of type R, read at an index for each lane of the scalar `T`. lane_table.hpp has the form for
/// lanes.
template <class T>
struct Table {
  using Index = std::int32_t;

  /// The whole part of a number that is not negative, and the number of an index.
  static Index whole(const T& x) noexcept {
    if constexpr (requires { x.a; }) {
      return static_cast<Index>(x.a);
    } else {
      return static_cast<Index>(x);
    }
  }
  static T number(Index i) noexcept { return T(static_cast<Storage<T>>(i)); }
  /// n adjacent numbers of a table, from an index on.
  template <int n, class R>
  static std::array<T, n> rows(const R* from, Index at) noexcept {
    std::array<T, n> result;
    for (int k = 0; k < n; ++k) result[static_cast<std::size_t>(k)] = T(from[at + k]);
    return result;
  }
};

/// |x|, without the branch on the derivative at zero that a library function may contain.
template <class T>
T absolute(const T& x) noexcept {
  return select(x < Storage<T>(0), T(-x), x);
}

/// False for NaN and infinities: a comparison with either is false.
template <class T>
Mask<T> finite(const T& x) noexcept {
  return absolute(x) <= std::numeric_limits<Storage<T>>::max();
}

/// a / b. Numbers with derivatives often compute a * (1 / b), which adds a rounding. Here the value is the plain
/// quotient, so that a ray traced with derivatives equals the plain ray bit by bit.
template <class T>
T quotient(const T& a, const T& b) noexcept {
  if constexpr (requires {
                  a.a;
                  a.v;
                }) {
    const auto value = a.a / b.a;
    return T(value, (a.v - b.v * value) * (1 / b.a));
  } else {
    return a / b;
  }
}

/// The square root of x if x > 0, else 0. Keeps unused lanes and their derivatives finite.
template <class T>
T safe_sqrt(const T& x) noexcept {
  using std::sqrt;
  const auto positive = x > Storage<T>(0);
  return select(positive, T(sqrt(select(positive, x, T(1)))), T(0));
}

}  // namespace petzval::kernel
