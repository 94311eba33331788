// SPDX-License-Identifier: Apache-2.0
// kernel::Table for lanes: numbers of a table at an index for each lane. Included by sources that are compiled for one
// instruction set each, like core/lanes.hpp.
#pragma once

#include <array>
#include <utility>

#include "core/lanes.hpp"
#include "core/scalar.hpp"

namespace petzval::core_detail {
namespace {

#if defined(__x86_64__)
/// A register of groups of sixteen bytes.
/// @param load function; load(g) is group g
template <class R, class Load>
PETZVAL_INLINE typename Native<R>::Values of_groups(const Load& load) noexcept {
#if defined(__AVX512F__)
  __m512 result = _mm512_castps128_ps512(load(0));
  result = _mm512_insertf32x4(result, load(1), 1);
  result = _mm512_insertf32x4(result, load(2), 2);
  result = _mm512_insertf32x4(result, load(3), 3);
#elif defined(__AVX2__)
  const __m256 result = _mm256_insertf128_ps(_mm256_castps128_ps256(load(0)), load(1), 1);
#else
  const __m128 result = load(0);
#endif
  return reinterpret_cast<typename Native<R>::Values>(result);
}

/// In each sixteen bytes, numbers first and second of a, then numbers first and second of b, of four floats; or one
/// number of each, of two doubles.
template <int first, int second, class Values>
PETZVAL_INLINE Values pick(Values a, Values b) noexcept {
  constexpr int width = sizeof(Values) / sizeof(a[0]), group = 16 / sizeof(a[0]);
  return [&]<int... i>(std::integer_sequence<int, i...>) {
    constexpr auto from = [](int l) {
      const int k = l % group, source = k < group / 2 ? 0 : width;
      return source + l - k + (group == 2 || k % 2 == 0 ? first : second);
    };
    return __builtin_shufflevector(a, b, from(i)...);
  }
  (std::make_integer_sequence<int, width>());
}
#endif

}  // namespace
}  // namespace petzval::core_detail

namespace petzval::kernel {

template <class R>
struct Table<core_detail::Lanes<R>> {
  using V = core_detail::Lanes<R>;
  using Index = typename core_detail::Native<R>::Bits;

  static PETZVAL_INLINE Index whole(V x) noexcept {
#if defined(__x86_64__) && !defined(__AVX512DQ__)
    if constexpr (sizeof(R) == 8) {  // there is no conversion to 64 bits
#if defined(__AVX2__)
      return reinterpret_cast<Index>(_mm256_cvtepi32_epi64(_mm256_cvttpd_epi32(x.v)));
#else
      return reinterpret_cast<Index>(_mm_unpacklo_epi32(_mm_cvttpd_epi32(x.v), _mm_setzero_si128()));
#endif
    } else {
      return __builtin_convertvector(x.v, Index);
    }
#else
    return __builtin_convertvector(x.v, Index);
#endif
  }
  static PETZVAL_INLINE V number(Index i) noexcept {
    if constexpr (sizeof(R) == 8) {  // the bits of 2^52 + i
      const V power(R(4503599627370496.0));
      return V(reinterpret_cast<typename V::Values>(i | reinterpret_cast<Index>(power.v))) - power;
    } else {
      return V(__builtin_convertvector(i, typename V::Values));
    }
  }
  /// Reads up to sixteen bytes for each lane and transposes them, which is faster than one gather for each number.
  template <int n>
  static PETZVAL_INLINE std::array<V, n> rows(const R* from, Index at) noexcept {
    std::array<V, n> result;
    V* const to = result.data();
#if defined(__x86_64__)
    static_assert(n <= 2 || n % 4 == 0);
    using core_detail::of_groups, core_detail::pick;
    const auto row = [&](int lane, int k) { return _mm_loadu_ps(reinterpret_cast<const float*>(from + at[lane] + k)); };
    if constexpr (n > 1 && sizeof(R) == 8) {
      for (int k = 0; k < n; k += 2) {
        const auto a = of_groups<R>([&](int g) { return row(2 * g, k); });
        const auto b = of_groups<R>([&](int g) { return row(2 * g + 1, k); });
        to[k] = V(pick<0, 0>(a, b)), to[k + 1] = V(pick<1, 1>(a, b));
      }
      return result;
    } else if constexpr (n == 2) {
      const auto two = [&](int lane) {
        return of_groups<R>([&](int g) {
          const R* const first = from + at[4 * g + lane];
          const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first));
          const R* const second = from + at[4 * g + lane + 1];
          return _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(second));
        });
      };
      const auto a = two(0), b = two(2);
      to[0] = V(pick<0, 2>(a, b)), to[1] = V(pick<1, 3>(a, b));
      return result;
    } else if constexpr (n > 2) {
      for (int k = 0; k < n; k += 4) {
        const auto of = [&](int l) { return of_groups<R>([&](int g) { return row(4 * g + l, k); }); };
        const auto a = of(0), b = of(1), c = of(2), d = of(3);
        const auto ab = pick<0, 1>(a, b), more_ab = pick<2, 3>(a, b);
        const auto cd = pick<0, 1>(c, d), more_cd = pick<2, 3>(c, d);
        to[k] = V(pick<0, 2>(ab, cd)), to[k + 1] = V(pick<1, 3>(ab, cd));
        to[k + 2] = V(pick<0, 2>(more_ab, more_cd)), to[k + 3] = V(pick<1, 3>(more_ab, more_cd));
      }
      return result;
    }
#endif
    for (int k = 0; k < n; ++k) {
      R values[V::width];
      for (int l = 0; l < V::width; ++l) values[l] = from[at[l] + k];
      to[k] = core_detail::load(values);
    }
    return result;
  }
};

}  // namespace petzval::kernel
