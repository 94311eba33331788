// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set, without fused operations; see petzval_loops in cmake/module.cmake. Sums run over
// the points in their order, so that a position has the same result in every batch.
#include "moving_least_squares_loops.hpp"

#include "falling_power.hpp"

namespace petzval::camera_detail {
namespace {

constexpr std::size_t block = 64;  // number of points whose weights are computed together

/// Sums of weights, and of coordinates and values relative to the nearest point. The nearest point itself adds 0,
/// however large its weight, so that no digits cancel near a point.
struct Moments {
  double x = 0, y = 0, value = 0;  ///< coordinates and value of the nearest point
  double w = 0, wf = 0, wx = 0, wy = 0, wxx = 0, wxy = 0, wyy = 0, wxf = 0, wyf = 0;
};

/// Height of the plane above its mean at a position (x, y) relative to the nearest point.
///
/// C: second moments about the mean; b: cross moments with the values; both divided by tr C. Rounding errors dominate
/// the smaller moment of points on a line. Therefore C (C^2 + thin^2)^-1 replaces C^-1; for 2 x 2 it is
///     (thin^2 C + det C (tr C - C)) / (det^2 C + thin^2 tr C^2 + thin^4).
/// For points on a line the result has the slope along the line and no slope across, for any direction of the line.
double rise_of(const LeastSquaresJob& job, const Moments& m, double x, double y) noexcept {
  constexpr double regularisation = 1e-10, regularisation2 = regularisation * regularisation;
  const double trace = m.wxx + m.wyy;
  if (!(trace > 1e-290)) return 0;
  const double mean_x = m.wx / m.w, mean_y = m.wy / m.w;
  const double xx = (m.wxx - m.wx * mean_x) / trace, xy = (m.wxy - m.wx * mean_y) / trace;
  const double yy = (m.wyy - m.wy * mean_y) / trace;
  const double bx = (m.wxf - m.wf * mean_x) / trace, by = (m.wyf - m.wf * mean_y) / trace;
  const double det = xx * yy - xy * xy, tr = xx + yy;
  const double along_x = xx * bx + xy * by, along_y = xy * bx + yy * by;
  const double slope_x = regularisation2 * along_x + det * (tr * bx - along_x);
  const double slope_y = regularisation2 * along_y + det * (tr * by - along_y);
  const double from_x = x - mean_x, from_y = y - mean_y;
  const double rise =
      (slope_x * from_x + slope_y * from_y) / (det * det + regularisation2 * (tr * tr - (det + det) + regularisation2));
  if (job.plane == 1) return rise;
  // The same for planes that rise only along the line.
  const double ex = job.along_x, ey = job.along_y;
  const double moment = ex * (ex * xx + ey * xy) + ey * (ex * xy + ey * yy);
  const double along = moment > regularisation ? (ex * bx + ey * by) / moment * (ex * from_x + ey * from_y) : 0;
  return job.plane * rise + (1 - job.plane) * along;
}

/// Value at a position, all scaled.
double value_at(const LeastSquaresJob& job, double x, double y) noexcept {
  double r2[block], weights[block];
  const auto distances = [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const double dx = x - job.x[begin + i], dy = y - job.y[begin + i];
      r2[i] = dx * dx + dy * dy + job.soft2[begin + i];
    }
  };
  const auto blocks = [&](const auto& work) {
    for (std::size_t begin = 0; begin < job.points; begin += block) {
      work(begin, job.points - begin < block ? job.points - begin : block);
    }
  };
  double least = 3e300;
  std::size_t nearest = 0;
  blocks([&](std::size_t begin, std::size_t count) {
    distances(begin, count);
    for (std::size_t i = 0; i < count; ++i) {
      if (r2[i] < least) least = r2[i], nearest = begin + i;
    }
  });
  Moments m{job.x[nearest], job.y[nearest], job.value[nearest]};
  blocks([&](std::size_t begin, std::size_t count) {
    if (job.points > block) distances(begin, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double ratio = r2[i] > least ? least / r2[i] : 1;  // at the point, 0 / 0 is replaced by 1
      weights[i] = job.alpha[begin + i] * falling(job.power, ratio);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double w = weights[i], f = job.value[begin + i] - m.value;
      m.w += w;
      m.wf += w * f;
      if (!job.affine) continue;
      const double px = job.x[begin + i] - m.x, py = job.y[begin + i] - m.y, ax = w * px, ay = w * py;
      m.wx += ax;
      m.wy += ay;
      m.wxx += ax * px;
      m.wxy += ax * py;
      m.wyy += ay * py;
      m.wxf += ax * f;
      m.wyf += ay * f;
    }
  });
  const double mean = m.wf / m.w;
  return m.value + (job.affine ? mean + rise_of(job, m, x - m.x, y - m.y) : mean);
}

/// A coordinate, scaled and clamped to reach. The comparisons replace NaN by a limit.
double scaled(const LeastSquaresJob& job, double coordinate) noexcept {
  const double x = coordinate * job.to_scaled, below = x < job.reach ? x : job.reach;
  return below > -job.reach ? below : -job.reach;
}

void values(const LeastSquaresJob& job, std::size_t count, const double* x, const double* y, double* out) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const double value = value_at(job, scaled(job, x[i]), scaled(job, y[i]));
    const double above = value > job.low ? value : job.low;
    out[i] = (above < job.high ? above : job.high) * job.from_scaled;
  }
}

}  // namespace

extern const LeastSquaresLoops PETZVAL_LOOPS;
const LeastSquaresLoops PETZVAL_LOOPS{values};

}  // namespace petzval::camera_detail
