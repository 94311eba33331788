// SPDX-License-Identifier: Apache-2.0
// What the loops over places and the search at a single one share. Included, like trace/lanes.hpp, by the sources of
// one instruction set each.
#pragma once

#include <cstddef>
#include <cstdint>

#include "moving_least_squares_loops.hpp"
#include "trace/lanes.hpp"

namespace petzval::camera_detail {
namespace {

using core_detail::Native;
using trace_detail::Lanes;

/// a < b ? a : b and a > b ? a : b: b where one is not a number. (Compilers make several instructions of select.)
template <class R>
PETZVAL_INLINE Lanes<R> smaller(Lanes<R> a, Lanes<R> b) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm512_maskz_min_ps(0xffff, a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm512_maskz_min_pd(0xff, a.v, b.v));
#elif defined(__AVX2__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm256_min_ps(a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm256_min_pd(a.v, b.v));
#elif defined(__x86_64__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm_min_ps(a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm_min_pd(a.v, b.v));
#else
  return select(a < b, a, b);
#endif
}
template <class R>
PETZVAL_INLINE Lanes<R> larger(Lanes<R> a, Lanes<R> b) noexcept {
#if defined(__AVX512F__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm512_maskz_max_ps(0xffff, a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm512_maskz_max_pd(0xff, a.v, b.v));
#elif defined(__AVX2__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm256_max_ps(a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm256_max_pd(a.v, b.v));
#elif defined(__x86_64__)
  if constexpr (sizeof(R) == 4) return Lanes<R>(_mm_max_ps(a.v, b.v));
  if constexpr (sizeof(R) == 8) return Lanes<R>(_mm_max_pd(a.v, b.v));
#else
  return select(a > b, a, b);
#endif
}

/// A number of a point on all lanes.
template <class R>
PETZVAL_INLINE Lanes<R> of_point(const R* numbers, std::size_t i) noexcept {
  numbers += i * LeastSquaresJob<R>::copies;
#if defined(__AVX2__)
  return Lanes<R>(*numbers);
#else
  Lanes<R> result(0);
  __builtin_memcpy(&result.v, numbers, sizeof result.v);
  return result;
#endif
}

/// What numbers of a type need. The terms that both series leave out are below a quarter of the last bit.
template <class R>
struct Format;
template <>
struct Format<float> {
  using Bits = std::int32_t;
  static constexpr int fraction_bits = 23, log_terms = 4, exp_terms = 7;
  static constexpr Bits root_half = 0x3f3504f3;  // of 0.70710678
  static constexpr float least_power = -125, least_base = 1.2e-38F, thin = 1e-6F, least_trace = 1e-36F;
};
template <>
struct Format<double> {
  using Bits = std::int64_t;
  static constexpr int fraction_bits = 52, log_terms = 9, exp_terms = 13;
  static constexpr Bits root_half = 0x3fe6a09e667f3bcd;
  static constexpr double least_power = -1021, least_base = 2.3e-308, thin = 1e-10, least_trace = 1e-290;
};

/// base^exponent for base from 0 to 1 and exponent above 0, by logarithm and exponential to the base 2; what is below
/// the normal numbers is 0. Relative error: some (1 + |exponent log2 base|) roundings.
template <class R>
PETZVAL_INLINE Lanes<R> power(Lanes<R> base, R exponent) noexcept {
  using F = Format<R>;
  using Bits = typename Native<R>::Bits;
  using Values = typename Native<R>::Values;
  constexpr R ln2 = R(0.693147180559945309417);
  // base = 2^whole fraction, with the fraction about 1.
  const Bits bits = reinterpret_cast<Bits>(base.v);
  const Bits whole = (bits - F::root_half) >> F::fraction_bits;
  const Lanes<R> fraction(reinterpret_cast<Values>(bits - (whole << F::fraction_bits)));
  const Lanes<R> s = (fraction - Lanes<R>(1)) / (fraction + Lanes<R>(1)), s2 = s * s;
  Lanes<R> series(R(1) / (2 * F::log_terms + 1));
  for (int k = F::log_terms - 1; k >= 0; --k) series = series * s2 + Lanes<R>(R(1) / R(2 * k + 1));
  const Lanes<R> log2 = Lanes<R>(__builtin_convertvector(whole, Values)) + s * series * Lanes<R>(2 / ln2);
  const Lanes<R> wanted = log2 * Lanes<R>(exponent);
  const Lanes<R> limited = larger(wanted, Lanes<R>(F::least_power));
  // The nearest whole number: adding this rounds to it.
  const Lanes<R> rounding(R(1.5) * R(typename F::Bits(1) << F::fraction_bits));
  const Lanes<R> shifted = limited + rounding, nearest = shifted - rounding;
  const Lanes<R> rest = (limited - nearest) * Lanes<R>(ln2);
  Lanes<R> result(1);
  for (int k = F::exp_terms; k >= 1; --k) result = result * rest * Lanes<R>(R(1) / R(k)) + Lanes<R>(1);
  const Bits steps = (reinterpret_cast<Bits>(shifted.v) - reinterpret_cast<Bits>(rounding.v)) << F::fraction_bits;
  const Lanes<R> scaled(reinterpret_cast<Values>(reinterpret_cast<Bits>(result.v) + steps));
  // A base of 0 or below the normal numbers has no logarithm here.
  const auto vanishes = trace_detail::any_of(wanted < Lanes<R>(F::least_power), base < Lanes<R>(F::least_base));
  return select(vanishes, Lanes<R>(0), scaled);
}

enum class Power { even, odd, any };  // of beta

/// ratio^(beta / 2).
template <Power kind, class R>
PETZVAL_INLINE Lanes<R> falling(const LeastSquaresJob<R>& job, Lanes<R> ratio) noexcept {
  if constexpr (kind == Power::any) return power(ratio, job.half_beta);
  Lanes<R> result = kind == Power::odd ? sqrt(ratio) : ratio;
  for (int k = kind == Power::odd ? 0 : 1; k < job.wholes; ++k) result = result * ratio;
  return result;
}

/// Of weights, and of places and values about the nearest point, which adds nothing to the latter, however much it
/// weighs: nothing cancels next to it.
template <class R>
struct Moments {
  Lanes<R> centre_x{0}, centre_y{0}, centre_value{0};
  Lanes<R> w{0}, wf{0}, wx{0}, wy{0}, wxx{0}, wxy{0}, wyy{0}, wxf{0}, wyf{0};
};

/// The value at places, scaled.
template <bool affine, class R>
PETZVAL_INLINE Lanes<R> value_of(const LeastSquaresJob<R>& job, const Moments<R>& m, Lanes<R> x, Lanes<R> y) noexcept {
  using L = Lanes<R>;
  const L per_weight = L(1) / m.w, mean = m.wf * per_weight;
  if constexpr (!affine) return m.centre_value + mean;

  // The plane through the mean; C: second moments of places about it, b: with values, in parts of the trace. Points on
  // a line leave rounding errors of their smaller moment. So C (C^2 + thin^2)^-1 stands for C^-1, which for 2 x 2 is
  // (thin^2 C + det C (tr C - C)) / (det^2 C + thin^2 tr C^2 + thin^4): for points on a line it keeps the slope along
  // it alone, however the line lies.
  const L mean_x = m.wx * per_weight, mean_y = m.wy * per_weight, trace = m.wxx + m.wyy;
  const auto spread = L(Format<R>::least_trace) < trace;
  const L per_trace = L(1) / select(spread, trace, L(1)), thin2(Format<R>::thin * Format<R>::thin);
  const L xx = (m.wxx - m.wx * mean_x) * per_trace, xy = (m.wxy - m.wx * mean_y) * per_trace;
  const L yy = (m.wyy - m.wy * mean_y) * per_trace;
  const L bx = (m.wxf - m.wf * mean_x) * per_trace, by = (m.wyf - m.wf * mean_y) * per_trace;
  const L det = xx * yy - xy * xy, tr = xx + yy;
  const L per_norm = L(1) / (det * det + thin2 * (tr * tr - (det + det) + thin2));
  const L along_x = xx * bx + xy * by, along_y = xy * bx + yy * by;
  const L slope_x = thin2 * along_x + det * (tr * bx - along_x), slope_y = thin2 * along_y + det * (tr * by - along_y);
  const L from_x = x - m.centre_x - mean_x, from_y = y - m.centre_y - mean_y;
  L rise = (slope_x * from_x + slope_y * from_y) * per_norm;
  if (job.plane < R(1)) {
    // The same of planes that rise along a line alone.
    const L ex(job.along_x), ey(job.along_y), plane(job.plane);
    const L moment = ex * (ex * xx + ey * xy) + ey * (ex * xy + ey * yy);
    const auto spread_along = L(Format<R>::thin) < moment;
    const L slope = (ex * bx + ey * by) / select(spread_along, moment, L(1));
    const L along = select(spread_along, slope * (ex * from_x + ey * from_y), L(0));
    rise = plane * rise + (L(1) - plane) * along;
  }
  return m.centre_value + (mean + select(spread, rise, L(0)));
}

/// A result in the unit of the values, within its limits.
template <class R>
PETZVAL_INLINE Lanes<R> limited(const LeastSquaresJob<R>& job, Lanes<R> value) noexcept {
  return smaller(larger(value, Lanes<R>(job.low)), Lanes<R>(job.high)) * Lanes<R>(job.from_scaled);
}

/// A coordinate of places, scaled and in reach; the comparisons turn what is not a number into a limit.
template <class R>
PETZVAL_INLINE Lanes<R> scaled(const LeastSquaresJob<R>& job, Lanes<R> place) noexcept {
  return larger(smaller(place * Lanes<R>(job.to_scaled), Lanes<R>(job.reach)), Lanes<R>(-job.reach));
}

/// Calls work.operator()<affine, kind>() for those of a job.
template <class R>
auto by_kind(const LeastSquaresJob<R>& job, const auto& work) noexcept {
  const auto by_power = [&]<bool affine>() {
    if (job.wholes < 0) return work.template operator()<affine, Power::any>();
    return job.odd ? work.template operator()<affine, Power::odd>() : work.template operator()<affine, Power::even>();
  };
  return job.affine ? by_power.template operator()<true>() : by_power.template operator()<false>();
}

}  // namespace
}  // namespace petzval::camera_detail
