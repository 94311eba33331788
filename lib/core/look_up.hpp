// SPDX-License-Identifier: Apache-2.0
// Look-up in a short table, one index per lane. For sources compiled once per instruction set, like core/simd.hpp.
#pragma once

#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "core/simd.hpp"

namespace petzval::core_detail {
namespace {

/// Number of entries of the longest table that a permutation of registers can read; 0 if there is no such instruction.
#if defined(__AVX512F__)
template <class R>
inline constexpr std::size_t permuted = 2 * static_cast<std::size_t>(lane_count<R>);
#elif defined(__AVX2__)
template <class R>
inline constexpr std::size_t permuted = sizeof(R) == 4 ? 2 * static_cast<std::size_t>(lane_count<R>) : 0;
#else
template <class R>
inline constexpr std::size_t permuted = 0;
#endif

/// Looks up a table that fills `registers` registers (1 or 2); all of it is loaded. Requires permuted<R> > 0.
template <int registers, class R>
PETZVAL_INLINE typename Native<R>::Values permute(const R* table,
                                                  [[maybe_unused]] const typename Native<R>::Bits& indices) noexcept {
  typename Native<R>::Values low, high{};
  __builtin_memcpy(&low, table, sizeof low);
  if constexpr (registers == 2) __builtin_memcpy(&high, table + lane_count<R>, sizeof high);
#if defined(__AVX512F__)
  const auto at = reinterpret_cast<__m512i>(indices);
  if constexpr (sizeof(R) == 4) {
    if constexpr (registers == 1) return _mm512_maskz_permutexvar_ps(0xffff, at, low);
    return _mm512_permutex2var_ps(low, at, high);
  } else {
    if constexpr (registers == 1) return _mm512_maskz_permutexvar_pd(0xff, at, low);
    return _mm512_permutex2var_pd(low, at, high);
  }
#elif defined(__AVX2__)
  if constexpr (sizeof(R) == 4) {
    const auto at = reinterpret_cast<__m256i>(indices);
    const __m256 from_low = _mm256_permutevar8x32_ps(low, at);
    if constexpr (registers == 1) return from_low;
    const __m256 from_high = _mm256_permutevar8x32_ps(high, at);
    return _mm256_blendv_ps(from_low, from_high, _mm256_castsi256_ps(_mm256_slli_epi32(at, 28)));
  }
#endif
  return low;
}

/// Looks up a table of `count` numbers: by permutation if registers can hold the table, otherwise by gathering. For a
/// permutation one or two full registers are read, beyond `count`.
template <class R>
PETZVAL_INLINE typename Native<R>::Values look_up(const R* table, std::size_t count,
                                                  const typename Native<R>::Bits& indices) noexcept {
  constexpr int width = lane_count<R>;
  if (permuted < R >> 0 && count <= width) return permute<1>(table, indices);
  if (count <= permuted<R>) return permute<2>(table, indices);
  R values[width];
  for (int l = 0; l < width; ++l) values[l] = table[indices[l]];
  typename Native<R>::Values result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

}  // namespace
}  // namespace petzval::core_detail
