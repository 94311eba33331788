// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set, without fused operations: see petzval_loops in cmake/module.cmake. Each lane is a
// place, and sums run over the points in their order, so that a result depends on its place alone.
#include "moving_least_squares_loops.hpp"

#include <cstdint>

#include "trace/lanes.hpp"

namespace petzval::inline v0::movement_detail {
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

/// What numbers of a type need. The terms of both series are below a quarter of the last bit.
template <class R>
struct Format;
template <>
struct Format<float> {
  using Bits = std::int32_t;
  static constexpr int fraction_bits = 23, log_terms = 6, exp_terms = 8;
  static constexpr Bits root_half = 0x3f3504f3;  // of 0.70710678
  static constexpr float least_power = -125, least_base = 1.2e-38F, thin = 1e-5F, least_trace = 1e-36F;
};
template <>
struct Format<double> {
  using Bits = std::int64_t;
  static constexpr int fraction_bits = 52, log_terms = 12, exp_terms = 14;
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

enum class Power { even, odd, any };

/// ratio^(beta / 2).
template <Power kind, class R>
PETZVAL_INLINE Lanes<R> falling(const LeastSquaresJob<R>& job, Lanes<R> ratio) noexcept {
  if constexpr (kind == Power::any) return power(ratio, job.half_beta);
  Lanes<R> result = kind == Power::odd ? sqrt(ratio) : ratio;
  for (int k = kind == Power::odd ? 0 : 1; k < job.wholes; ++k) result = result * ratio;
  return result;
}

/// The value at a register of places.
template <bool affine, Power kind, class R>
PETZVAL_INLINE Lanes<R> value_at(const LeastSquaresJob<R>& job, Lanes<R> x, Lanes<R> y) noexcept {
  using L = Lanes<R>;
  const auto distance2 = [&](std::size_t i) {
    const L dx = x - of_point(job.x, i), dy = y - of_point(job.y, i), d2 = dx * dx + dy * dy;
    return job.soft ? d2 + of_point(job.soft2, i) : d2;
  };
  // Of so many points the distances are kept.
  constexpr std::size_t most_kept = 128;
  L kept[most_kept];
  const std::size_t keep = job.points < most_kept ? job.points : most_kept;
  L least(R(3e38)), centre_x(0), centre_y(0), centre_value(0);
  const auto look = [&](std::size_t i, L r2) {
    const auto nearer = r2 < least;
    least = smaller(r2, least);
    // Few points are the nearest so far of any lane, and for neighbours in a picture they are the same ones. (Doubles
    // are often single places anywhere: nobody could predict the branch.)
    if (sizeof(R) == 4 && !any(nearer)) return;
    if constexpr (affine) {
      centre_x = select(nearer, of_point(job.x, i), centre_x);
      centre_y = select(nearer, of_point(job.y, i), centre_y);
    }
    centre_value = select(nearer, of_point(job.value, i), centre_value);
  };
  for (std::size_t i = 0; i < keep; ++i) look(i, kept[i] = distance2(i));
  for (std::size_t i = keep; i < job.points; ++i) look(i, distance2(i));

  // Moments about the nearest point. It adds nothing to them, however much it weighs: nothing cancels next to it.
  L w_sum(0), wx(0), wy(0), wxx(0), wxy(0), wyy(0), wf(0), wxf(0), wyf(0);
  const auto add = [&](std::size_t i, L r2) {
    // At the point itself the ratio is 0 / 0, which counts as 1.
    const L w = of_point(job.alpha, i) * falling<kind>(job, smaller(least / r2, L(1)));
    const L f = of_point(job.value, i) - centre_value;
    w_sum = w_sum + w;
    wf = wf + w * f;
    if constexpr (affine) {
      const L px = of_point(job.x, i) - centre_x, py = of_point(job.y, i) - centre_y, ax = w * px, ay = w * py;
      wx = wx + ax;
      wy = wy + ay;
      wxx = wxx + ax * px;
      wxy = wxy + ax * py;
      wyy = wyy + ay * py;
      wxf = wxf + ax * f;
      wyf = wyf + ay * f;
    }
  };
  for (std::size_t i = 0; i < keep; ++i) add(i, kept[i]);
  for (std::size_t i = keep; i < job.points; ++i) add(i, distance2(i));
  const L per_weight = L(1) / w_sum, mean = wf * per_weight;
  if constexpr (!affine) return centre_value + mean;

  // The plane through the mean, its slopes from the moments about it, by elimination from the longer axis. Relative
  // moments m far below `thin` are rounding errors of points on a line: m / (m^2 + thin^2) stands for 1 / m.
  const L mean_x = wx * per_weight, mean_y = wy * per_weight, trace = wxx + wyy;
  const auto spread = L(Format<R>::least_trace) < trace;
  const L per_trace = L(1) / select(spread, trace, L(1));
  const auto inverse = [&](L moment) {
    const L relative = larger(moment * per_trace, L(0));
    return relative / (relative * relative + L(Format<R>::thin * Format<R>::thin)) * per_trace;
  };
  const L xx = wxx - wx * mean_x, xy = wxy - wx * mean_y, yy = wyy - wy * mean_y;
  const L xf = wxf - wf * mean_x, yf = wyf - wf * mean_y;
  const auto upright = xx < yy;
  const L first = select(upright, yy, xx), second = select(upright, xx, yy);
  const L first_f = select(upright, yf, xf), second_f = select(upright, xf, yf);
  const L per_first = inverse(first), part = xy * per_first;
  const L second_slope = (second_f - part * first_f) * inverse(second - part * xy);
  const L first_slope = (first_f - xy * second_slope) * per_first;
  const L from_x = x - centre_x - mean_x, from_y = y - centre_y - mean_y;
  const L along = select(upright, from_y, from_x), across = select(upright, from_x, from_y);
  const L rise = first_slope * along + second_slope * across;
  return centre_value + (mean + select(spread, rise, L(0)));
}

template <bool affine, Power kind, class R>
void fill(const LeastSquaresJob<R>& job) noexcept {
  using L = Lanes<R>;
  constexpr std::size_t width = L::width;
  const auto scaled = [&](L place) {
    place = place * L(job.to_scaled);
    // The comparisons turn what is not a number into a limit.
    place = select(place < L(job.reach), place, L(job.reach));
    return select(L(-job.reach) < place, place, L(-job.reach));
  };
  const auto fill_some = [&](std::size_t i, std::size_t some) {
    L x(0), y(0);
    __builtin_memcpy(&x.v, job.at_x + i, some * sizeof(R));
    __builtin_memcpy(&y.v, job.at_y + i, some * sizeof(R));
    const L value = value_at<affine, kind>(job, scaled(x), scaled(y));
    const L result = smaller(larger(value, L(job.low)), L(job.high)) * L(job.from_scaled);
    __builtin_memcpy(job.out + i, &result.v, some * sizeof(R));
  };
  std::size_t i = 0;
  for (; i + width <= job.count; i += width) fill_some(i, width);
  if (i < job.count) fill_some(i, job.count - i);
}

template <bool affine, class R>
void fill_kind(const LeastSquaresJob<R>& job) noexcept {
  if (job.wholes < 0) return fill<affine, Power::any>(job);
  return job.odd ? fill<affine, Power::odd>(job) : fill<affine, Power::even>(job);
}

template <class R>
void run(const LeastSquaresJob<R>& job) noexcept {
  return job.affine ? fill_kind<true>(job) : fill_kind<false>(job);
}

}  // namespace

extern const LeastSquaresLoops PETZVAL_LOOPS;
const LeastSquaresLoops PETZVAL_LOOPS{run<float>, run<double>};

}  // namespace petzval::inline v0::movement_detail
