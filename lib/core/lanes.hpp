// SPDX-License-Identifier: Apache-2.0
// A scalar of kernels that holds one number for each lane of a register: numbers and masks with the interface of
// core/scalar.hpp. Included, like core/simd.hpp, by sources that are compiled for one instruction set each.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "core/look_up.hpp"
#include "core/simd.hpp"

namespace petzval::core_detail {
namespace {

/// A mask: the lanes in which a comparison holds.
template <class R>
struct Mask {
#if defined(__AVX512F__)
  using Bits = std::uint16_t;
#else
  using Bits = typename Native<R>::Bits;
#endif
  Bits bits;

  friend PETZVAL_INLINE Mask operator&(Mask a, Mask b) noexcept { return {static_cast<Bits>(a.bits & b.bits)}; }
  friend PETZVAL_INLINE Mask operator|(Mask a, Mask b) noexcept { return {static_cast<Bits>(a.bits | b.bits)}; }
  /// a and not b.
  friend PETZVAL_INLINE Mask without(Mask a, Mask b) noexcept { return {static_cast<Bits>(a.bits & ~b.bits)}; }
};

/// One number for each of `width` lanes.
template <class R>
struct Lanes {
  using Scalar = R;
  using Values = typename Native<R>::Values;
  static constexpr int width = lane_count<R>;
  Values v;

  Lanes() = default;
  PETZVAL_INLINE Lanes(Values values) noexcept : v(values) {}
  PETZVAL_INLINE Lanes(R value) noexcept : v(value - Values{}) {}

  friend PETZVAL_INLINE Lanes operator+(Lanes a, Lanes b) noexcept { return a.v + b.v; }
  friend PETZVAL_INLINE Lanes operator-(Lanes a, Lanes b) noexcept { return a.v - b.v; }
  friend PETZVAL_INLINE Lanes operator*(Lanes a, Lanes b) noexcept { return a.v * b.v; }
  friend PETZVAL_INLINE Lanes operator/(Lanes a, Lanes b) noexcept { return a.v / b.v; }
  friend PETZVAL_INLINE Lanes operator-(Lanes a) noexcept { return -a.v; }

#if defined(__AVX512F__)
  template <int predicate>
  static PETZVAL_INLINE Mask<R> compare(Lanes a, Lanes b) noexcept {
    if constexpr (sizeof(R) == 4) {
      return {_mm512_cmp_ps_mask(a.v, b.v, predicate)};
    } else {
      return {_mm512_cmp_pd_mask(a.v, b.v, predicate)};
    }
  }
  friend PETZVAL_INLINE Mask<R> operator<(Lanes a, Lanes b) noexcept { return compare<_CMP_LT_OQ>(a, b); }
  friend PETZVAL_INLINE Mask<R> operator<=(Lanes a, Lanes b) noexcept { return compare<_CMP_LE_OQ>(a, b); }
  friend PETZVAL_INLINE Mask<R> operator>(Lanes a, Lanes b) noexcept { return compare<_CMP_GT_OQ>(a, b); }
  friend PETZVAL_INLINE Mask<R> operator>=(Lanes a, Lanes b) noexcept { return compare<_CMP_GE_OQ>(a, b); }
#else
  friend PETZVAL_INLINE Mask<R> operator<(Lanes a, Lanes b) noexcept { return {a.v < b.v}; }
  friend PETZVAL_INLINE Mask<R> operator<=(Lanes a, Lanes b) noexcept { return {a.v <= b.v}; }
  friend PETZVAL_INLINE Mask<R> operator>(Lanes a, Lanes b) noexcept { return {a.v > b.v}; }
  friend PETZVAL_INLINE Mask<R> operator>=(Lanes a, Lanes b) noexcept { return {a.v >= b.v}; }
#endif
};

template <class R>
PETZVAL_INLINE Lanes<R> select(Mask<R> mask, Lanes<R> a, Lanes<R> b) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) {
    return Lanes<R>(_mm512_mask_blend_ps(mask.bits, b.v, a.v));
  } else {
    return Lanes<R>(_mm512_mask_blend_pd(static_cast<__mmask8>(mask.bits), b.v, a.v));
  }
#else
  return Lanes<R>(mask.bits ? a.v : b.v);
#endif
}

template <class R>
PETZVAL_INLINE bool any(Mask<R> mask) noexcept {
#if defined(__AVX512F__)
  return mask.bits != 0;
#elif defined(__AVX2__)
  return _mm256_movemask_epi8(reinterpret_cast<__m256i>(mask.bits)) != 0;
#elif defined(__x86_64__)
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(mask.bits)) != 0;
#else
  std::int64_t word[2];
  __builtin_memcpy(word, &mask.bits, sizeof word);
  return (word[0] | word[1]) != 0;
#endif
}

template <class R>
PETZVAL_INLINE Mask<R> all_of(Mask<R> a, Mask<R> b) noexcept {
  return a & b;
}
template <class R>
PETZVAL_INLINE Mask<R> all_of(Mask<R> a, Mask<R> b, Mask<R> c) noexcept {
  return a & b & c;
}
/// The same with a mask in memory; otherwise compilers move the mask through integer registers.
template <class R>
PETZVAL_INLINE Mask<R> also(const Mask<R>& in_memory, Mask<R> b) noexcept {
#if defined(__AVX512F__)
  return {_kand_mask16(in_memory.bits, b.bits)};
#else
  return in_memory & b;
#endif
}
template <class R>
PETZVAL_INLINE Mask<R> any_of(Mask<R> a, Mask<R> b) noexcept {
  return a | b;
}

/// IEEE square root.
template <class R>
PETZVAL_INLINE Lanes<R> sqrt(Lanes<R> x) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) {
    return Lanes<R>(_mm512_maskz_sqrt_ps(0xffff, x.v));
  } else {
    return Lanes<R>(_mm512_maskz_sqrt_pd(0xff, x.v));
  }
#elif defined(__AVX2__)
  if constexpr (sizeof(R) == 4) {
    return Lanes<R>(_mm256_sqrt_ps(x.v));
  } else {
    return Lanes<R>(_mm256_sqrt_pd(x.v));
  }
#elif defined(__x86_64__)
  if constexpr (sizeof(R) == 4) {
    return Lanes<R>(_mm_sqrt_ps(x.v));
  } else {
    return Lanes<R>(_mm_sqrt_pd(x.v));
  }
#else
  for (int i = 0; i < Lanes<R>::width; ++i) {
    if constexpr (sizeof(R) == 4) {
      x.v[i] = __builtin_sqrtf(x.v[i]);
    } else {
      x.v[i] = __builtin_sqrt(x.v[i]);
    }
  }
  return x;
#endif
}

/// True if every lane of a mask, made by comparisons, is set.
template <class R>
PETZVAL_INLINE bool every(Mask<R> mask) noexcept {
#if defined(__AVX512F__)
  return mask.bits == (1u << Lanes<R>::width) - 1;
#else
  return !any(Mask<R>{~mask.bits});
#endif
}

/// Square root with the precision of the arithmetic: approximate and then refined if that is faster. The approximation
/// is NaN at 0.
template <class R>
PETZVAL_INLINE Lanes<R> root(Lanes<R> x) noexcept {
#if PETZVAL_FAST && defined(__AVX512F__)
  const Lanes<R> half(R(0.5));
  if constexpr (sizeof(R) == 4) {
    const Lanes<R> y(_mm512_maskz_rsqrt14_ps(0xffff, x.v));
    const Lanes<R> s = x * y;
    return s + half * y * (x - s * s);
  } else {
    const Lanes<R> y(_mm512_maskz_rsqrt14_pd(0xff, x.v));
    const Lanes<R> s = x * y, h = half * y;
    const Lanes<R> e = half - s * h;
    const Lanes<R> closer = s + s * e;
    return closer + (h + h * e) * (x - closer * closer);
  }
#else
  return sqrt(x);
#endif
}

/// kernel::safe_sqrt with the precision of root().
template <class R>
PETZVAL_INLINE Lanes<R> safe_sqrt(Lanes<R> x) noexcept {
  const Lanes<R> none(R(0));
  const Mask<R> positive = x > none;
  return select(positive, root(select(positive, x, Lanes<R>(R(1)))), none);
}

/// a / b with the precision of root(). NaN if b or its reciprocal is 0.
template <class R>
PETZVAL_INLINE Lanes<R> quotient(Lanes<R> a, Lanes<R> b) noexcept {
#if PETZVAL_FAST && defined(__AVX512F__)
  const Lanes<R> one(R(1));
  Lanes<R> y;
  if constexpr (sizeof(R) == 4) {
    y = Lanes<R>(_mm512_maskz_rcp14_ps(0xffff, b.v));
  } else {
    y = Lanes<R>(_mm512_maskz_rcp14_pd(0xff, b.v));
    y = y + y * (one - b * y);
  }
  y = y + y * (one - b * y);
  const Lanes<R> q = a * y;
  return q + y * (a - b * q);
#else
  return a / b;
#endif
}

/// 1 / b within 1e-7, for approximations.
template <class R>
PETZVAL_INLINE Lanes<R> near_reciprocal(Lanes<R> b) noexcept {
  const Lanes<R> one(R(1));
#if PETZVAL_FAST && defined(__AVX512F__)
  Lanes<R> y;
  if constexpr (sizeof(R) == 4) {
    y = Lanes<R>(_mm512_maskz_rcp14_ps(0xffff, b.v));
  } else {
    y = Lanes<R>(_mm512_maskz_rcp14_pd(0xff, b.v));
  }
  return y + y * (one - b * y);
#else
  return one / b;
#endif
}

/// A second root to be computed together with root(). Under AVX2 it starts from the approximation of floats, so that
/// the two roots do not compete for the only divider. Defined where has_root() is true.
template <class R>
PETZVAL_INLINE Lanes<R> second_root(Lanes<R> x) noexcept {
#if PETZVAL_FAST && defined(__AVX2__) && !defined(__AVX512F__)
  const Lanes<R> half(R(0.5));
  if constexpr (sizeof(R) == 4) {
    const Lanes<R> y(_mm256_rsqrt_ps(x.v));
    const Lanes<R> s = x * y;
    return s + half * y * (x - s * s);
  } else {
    const Lanes<R> y(_mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(x.v))));
    const Lanes<R> s = x * y, h = half * y;
    const Lanes<R> e = half - s * h;
    const Lanes<R> closer = s + s * e, h_closer = h + h * e;
    const Lanes<R> f = half - closer * h_closer;
    const Lanes<R> close = closer + closer * f;
    return close + (h_closer + h_closer * f) * (x - close * close);
  }
#else
  return root(x);
#endif
}

/// True where root() and second_root() are defined.
template <class R>
PETZVAL_INLINE Mask<R> has_root(Lanes<R> x) noexcept {
#if PETZVAL_FAST && defined(__AVX2__)
  return x > Lanes<R>(R(1e-37));  // the approximations are infinite below the normal numbers of float
#else
  return x >= Lanes<R>(R(0));
#endif
}

/// Adds a small number to a counter, in the lanes of a mask.
template <int by, class R>
PETZVAL_INLINE void count(typename Native<R>::Bits& counter, Mask<R> mask) noexcept {
#if defined(__AVX512F__)
  using Bits = typename Native<R>::Bits;
  const auto c = reinterpret_cast<__m512i>(counter);
  if constexpr (sizeof(R) == 4) {
    counter = reinterpret_cast<Bits>(_mm512_mask_add_epi32(c, mask.bits, c, _mm512_set1_epi32(by)));
  } else {
    counter =
        reinterpret_cast<Bits>(_mm512_mask_add_epi64(c, static_cast<__mmask8>(mask.bits), c, _mm512_set1_epi64(by)));
  }
#else
  for (int i = 0; i < by; ++i) counter -= mask.bits;
#endif
}

/// Replaces a counter by another one, in the lanes of a mask.
template <class R>
PETZVAL_INLINE void keep(typename Native<R>::Bits& counter, Mask<R> mask, typename Native<R>::Bits other) noexcept {
#if defined(__AVX512F__)
  using Bits = typename Native<R>::Bits;
  const auto c = reinterpret_cast<__m512i>(counter), o = reinterpret_cast<__m512i>(other);
  if constexpr (sizeof(R) == 4) {
    counter = reinterpret_cast<Bits>(_mm512_mask_blend_epi32(mask.bits, c, o));
  } else {
    counter = reinterpret_cast<Bits>(_mm512_mask_blend_epi64(static_cast<__mmask8>(mask.bits), c, o));
  }
#else
  counter = mask.bits ? other : counter;
#endif
}

/// Unaligned load.
template <class R>
PETZVAL_INLINE Lanes<R> load(const R* from) noexcept {
  typename Lanes<R>::Values v;
  __builtin_memcpy(&v, from, sizeof v);
  return Lanes<R>(v);
}
template <class R>
PETZVAL_INLINE void store(R* to, Lanes<R> x) noexcept {
  __builtin_memcpy(to, &x.v, sizeof x.v);
}

/// sum_of_products() of numbers in registers.
template <class R>
PETZVAL_INLINE Lanes<R> sum_of_products(Lanes<R> a, Lanes<R> b, Lanes<R> c, Lanes<R> d) noexcept {
  return sum_of_products(a.v, b.v, c.v, d.v);
}

/// Loads from[index] in the lanes of a mask; the other lanes are 0.
PETZVAL_INLINE Lanes<float> gather(const float* from, Native<float>::Bits indices, Mask<float> mask) noexcept {
#if defined(__AVX512F__)
  return Lanes<float>(
      _mm512_mask_i32gather_ps(_mm512_setzero_ps(), mask.bits, reinterpret_cast<__m512i>(indices), from, 4));
#elif defined(__AVX2__)
  return Lanes<float>(_mm256_mask_i32gather_ps(_mm256_setzero_ps(), from, reinterpret_cast<__m256i>(indices),
                                               reinterpret_cast<__m256>(mask.bits), 4));
#else
  Lanes<float> result(0.0f);
  for (int l = 0; l < Lanes<float>::width; ++l) {
    if (mask.bits[l]) result.v[l] = from[indices[l]];
  }
  return result;
#endif
}

/// Number of lanes of a mask.
template <class R>
PETZVAL_INLINE int lanes_in(Mask<R> mask) noexcept {
#if defined(__AVX512F__)
  return __builtin_popcount(mask.bits);
#else
  int count = 0;
  for (int l = 0; l < Lanes<R>::width; ++l) count -= static_cast<int>(mask.bits[l]);
  return count;
#endif
}

/// Stores the lanes of a mask contiguously. The function may write a full vector.
template <class R>
PETZVAL_INLINE void pack(R* to, Mask<R> mask, Lanes<R> x) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) {
    store(to, Lanes<R>(_mm512_maskz_compress_ps(mask.bits, x.v)));
  } else {
    store(to, Lanes<R>(_mm512_maskz_compress_pd(static_cast<__mmask8>(mask.bits), x.v)));
  }
#else
  for (int l = 0, n = 0; l < Lanes<R>::width; ++l) {
    to[n] = x.v[l];
    n -= static_cast<int>(mask.bits[l]);
  }
#endif
}

/// Reads lanes that were stored by pack(); the other lanes come from `others`.
template <class R>
PETZVAL_INLINE Lanes<R> unpack(const R* from, Mask<R> mask, Lanes<R> others) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) {
    return Lanes<R>(_mm512_mask_expand_ps(others.v, mask.bits, load(from).v));
  } else {
    return Lanes<R>(_mm512_mask_expand_pd(others.v, static_cast<__mmask8>(mask.bits), load(from).v));
  }
#else
  for (int l = 0, n = 0; l < Lanes<R>::width; ++l) {
    if (mask.bits[l]) others.v[l] = from[n++];
  }
  return others;
#endif
}

}  // namespace
}  // namespace petzval::core_detail
