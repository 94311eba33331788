// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set, without fused operations: see petzval_loops in cmake/module.cmake. Each lane is a
// place, and sums run over the points in their order, so that a result depends on its place alone.
#include "moving_least_squares_loops.hpp"

#include "moving_least_squares_lanes.hpp"

namespace petzval::camera_detail {
namespace {

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
  L least(R(3e38));
  Moments<R> m;
  const auto look = [&](std::size_t i, L r2) {
    const auto nearer = r2 < least;
    least = smaller(r2, least);
    // Few points are the nearest so far of any lane, and for neighbours in a picture they are the same ones. (Doubles
    // are often single places anywhere: nobody could predict the branch.)
    if (sizeof(R) == 4 && !any(nearer)) return;
    if constexpr (affine) {
      m.centre_x = select(nearer, of_point(job.x, i), m.centre_x);
      m.centre_y = select(nearer, of_point(job.y, i), m.centre_y);
    }
    m.centre_value = select(nearer, of_point(job.value, i), m.centre_value);
  };
  for (std::size_t i = 0; i < keep; ++i) look(i, kept[i] = distance2(i));
  for (std::size_t i = keep; i < job.points; ++i) look(i, distance2(i));

  const auto add = [&](std::size_t i, L r2) {
    // At the point itself the ratio is 0 / 0, which counts as 1.
    const L w = of_point(job.alpha, i) * falling<kind>(job, smaller(least / r2, L(1)));
    const L f = of_point(job.value, i) - m.centre_value;
    m.w = m.w + w;
    m.wf = m.wf + w * f;
    if constexpr (affine) {
      const L px = of_point(job.x, i) - m.centre_x, py = of_point(job.y, i) - m.centre_y, ax = w * px, ay = w * py;
      m.wx = m.wx + ax;
      m.wy = m.wy + ay;
      m.wxx = m.wxx + ax * px;
      m.wxy = m.wxy + ax * py;
      m.wyy = m.wyy + ay * py;
      m.wxf = m.wxf + ax * f;
      m.wyf = m.wyf + ay * f;
    }
  };
  for (std::size_t i = 0; i < keep; ++i) add(i, kept[i]);
  for (std::size_t i = keep; i < job.points; ++i) add(i, distance2(i));
  return value_of<affine>(job, m, x, y);
}

template <bool affine, Power kind, class R>
void fill(const LeastSquaresJob<R>& job) noexcept {
  using L = Lanes<R>;
  constexpr std::size_t width = L::width;
  const auto fill_some = [&](std::size_t i, std::size_t some) {
    L x(0), y(0);
    __builtin_memcpy(&x.v, job.at_x + i, some * sizeof(R));
    __builtin_memcpy(&y.v, job.at_y + i, some * sizeof(R));
    const L result = limited(job, value_at<affine, kind>(job, scaled(job, x), scaled(job, y)));
    __builtin_memcpy(job.out + i, &result.v, some * sizeof(R));
  };
  std::size_t i = 0;
  for (; i + width <= job.count; i += width) fill_some(i, width);
  if (i < job.count) fill_some(i, job.count - i);
}

template <class R>
void run(const LeastSquaresJob<R>& job) noexcept {
  by_kind(job, [&]<bool affine, Power kind>() { fill<affine, kind>(job); });
}

}  // namespace

extern const LeastSquaresLoops PETZVAL_LOOPS;
const LeastSquaresLoops PETZVAL_LOOPS{run<float>, run<double>};

}  // namespace petzval::camera_detail
