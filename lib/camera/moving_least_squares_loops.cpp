// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set, without fused operations; see petzval_loops in cmake/module.cmake. A lane holds a
// position; sums run over the points in their order, so that a position has the same result in every batch.
#include "moving_least_squares_loops.hpp"

#include <algorithm>

#include "core/lanes.hpp"
#include "falling_power.hpp"

namespace petzval::camera_detail {
namespace {

using core_detail::load;
using V = core_detail::Lanes<double>;

/// Sums of weights, and of coordinates and values relative to the nearest point. The nearest point itself adds 0,
/// however large its weight, so that no digits cancel near a point.
struct Moments {
  V x, y, value;  ///< coordinates and value of the nearest point
  V w = 0.0, wf = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, wyy = 0.0, wxf = 0.0, wyf = 0.0;
};

/// Height of the plane above its mean at a position (x, y) relative to the nearest point.
///
/// C: second moments about the mean; b: cross moments with the values; both divided by tr C. Rounding errors dominate
/// the smaller moment of points on a line. Therefore C (C^2 + thin^2)^-1 replaces C^-1; for 2 x 2 it is
///     (thin^2 C + det C (tr C - C)) / (det^2 C + thin^2 tr C^2 + thin^4).
/// For points on a line the result has the slope along the line and no slope across, for any direction of the line.
V rise_of(const LeastSquaresJob& job, const Moments& m, V x, V y) noexcept {
  const V regularisation = 1e-10, regularisation2 = regularisation * regularisation;
  const V trace = m.wxx + m.wyy;
  const V mean_x = m.wx / m.w, mean_y = m.wy / m.w;
  const V xx = (m.wxx - m.wx * mean_x) / trace, xy = (m.wxy - m.wx * mean_y) / trace;
  const V yy = (m.wyy - m.wy * mean_y) / trace;
  const V bx = (m.wxf - m.wf * mean_x) / trace, by = (m.wyf - m.wf * mean_y) / trace;
  const V det = xx * yy - xy * xy, tr = xx + yy;
  const V along_x = xx * bx + xy * by, along_y = xy * bx + yy * by;
  const V slope_x = regularisation2 * along_x + det * (tr * bx - along_x);
  const V slope_y = regularisation2 * along_y + det * (tr * by - along_y);
  const V from_x = x - mean_x, from_y = y - mean_y;
  V rise =
      (slope_x * from_x + slope_y * from_y) / (det * det + regularisation2 * (tr * tr - (det + det) + regularisation2));
  if (job.plane != 1) {
    // The same for planes that rise only along the line.
    const V ex = job.along_x, ey = job.along_y;
    const V moment = ex * (ex * xx + ey * xy) + ey * (ex * xy + ey * yy);
    const V along = (ex * bx + ey * by) / moment * (ex * from_x + ey * from_y);
    rise = V(job.plane) * rise + V(1 - job.plane) * select(moment > regularisation, along, V(0.0));
  }
  return select(trace > V(1e-290), rise, V(0.0));
}

/// Values at positions, all scaled.
V value_at(const LeastSquaresJob& job, V x, V y) noexcept {
  const auto squared_distance = [&](std::size_t i) {
    const V dx = x - V(job.x[i]), dy = y - V(job.y[i]);
    return dx * dx + dy * dy + V(job.soft2[i]);
  };
  V least = 3e300;
  Moments m{job.x[0], job.y[0], job.value[0]};
  for (std::size_t i = 0; i < job.points; ++i) {
    const V r2 = squared_distance(i);
    const auto nearer = r2 < least;
    least = select(nearer, r2, least);
    m.x = select(nearer, V(job.x[i]), m.x), m.y = select(nearer, V(job.y[i]), m.y);
    m.value = select(nearer, V(job.value[i]), m.value);
  }
  for (std::size_t i = 0; i < job.points; ++i) {
    const V r2 = squared_distance(i);
    const V ratio = select(r2 > least, least / r2, V(1.0));  // at the point, 0 / 0 is replaced by 1
    const V w = V(job.alpha[i]) * falling(job.power, ratio), f = V(job.value[i]) - m.value;
    m.w = m.w + w;
    m.wf = m.wf + w * f;
    if (!job.affine) continue;
    const V px = V(job.x[i]) - m.x, py = V(job.y[i]) - m.y, ax = w * px, ay = w * py;
    m.wx = m.wx + ax;
    m.wy = m.wy + ay;
    m.wxx = m.wxx + ax * px;
    m.wxy = m.wxy + ax * py;
    m.wyy = m.wyy + ay * py;
    m.wxf = m.wxf + ax * f;
    m.wyf = m.wyf + ay * f;
  }
  const V mean = m.wf / m.w;
  return m.value + (job.affine ? mean + rise_of(job, m, x - m.x, y - m.y) : mean);
}

/// A coordinate, scaled and clamped to reach. The comparisons replace NaN by a limit.
V scaled(const LeastSquaresJob& job, V coordinate) noexcept {
  const V reach = job.reach, x = coordinate * V(job.to_scaled), below = select(x < reach, x, reach);
  return select(below > -reach, below, -reach);
}

void values(const LeastSquaresJob& job, std::size_t count, const double* x, const double* y, double* out) noexcept {
  constexpr std::size_t lanes = V::width;
  double last_x[lanes] = {}, last_y[lanes] = {}, last_out[lanes];
  for (std::size_t i = 0; i < count; i += lanes) {
    const std::size_t held = std::min(lanes, count - i);
    const bool full = held == lanes;
    if (!full) std::copy_n(x + i, held, last_x), std::copy_n(y + i, held, last_y);
    const V value = value_at(job, scaled(job, load(full ? x + i : last_x)), scaled(job, load(full ? y + i : last_y)));
    const V above = select(value > V(job.low), value, V(job.low));
    store(full ? out + i : last_out, select(above < V(job.high), above, V(job.high)) * V(job.from_scaled));
    if (!full) std::copy_n(last_out, held, out + i);
  }
}

}  // namespace

extern const LeastSquaresLoops PETZVAL_LOOPS;
const LeastSquaresLoops PETZVAL_LOOPS{values};

}  // namespace petzval::camera_detail
