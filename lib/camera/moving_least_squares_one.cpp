// SPDX-License-Identifier: Apache-2.0
// A single place: lanes are points while nothing is summed up, and sums run as in the loops over places, so that the
// bits are the same.
#define PETZVAL_FAST 0
#include <algorithm>

#include "moving_least_squares_lanes.hpp"

namespace petzval::camera_detail {
namespace {

using L = Lanes<double>;
using Two = double __attribute__((vector_size(16)));

template <bool affine, Power kind>
double value_at(const LeastSquaresJob<double>& job, L x, L y) noexcept {
  constexpr std::size_t width = L::width;
  const auto for_points = [&](const auto& work) {
    std::size_t i = 0;
    do work(std::min(i, job.points - width));
    while ((i += width) < job.points);
  };
  const auto read = [](const double* from, std::size_t i) {
    L to;
    __builtin_memcpy(&to.v, from + i, sizeof to.v);
    return to;
  };
  double distances2[most_points_of_one], weights[most_points_of_one];
  L least_by_lane(3e38);
  for_points([&](std::size_t i) {
    const L dx = x - read(job.x, i), dy = y - read(job.y, i), d2 = dx * dx + dy * dy;
    const L r2 = job.soft ? d2 + read(job.soft2, i) : d2;
    least_by_lane = smaller(r2, least_by_lane);
    __builtin_memcpy(distances2 + i, &r2.v, sizeof r2.v);
  });
  double least = least_by_lane.v[0];
  for (std::size_t l = 1; l < width; ++l) least = std::min(least, double(least_by_lane.v[l]));
  std::size_t nearest = 0;
  while (distances2[nearest] != least) ++nearest;
  for_points([&](std::size_t i) {
    const L ratio = smaller(L(least) / read(distances2, i), L(1)), w = read(job.alpha, i) * falling<kind>(job, ratio);
    __builtin_memcpy(weights + i, &w.v, sizeof w.v);
  });

  const Two centre{job.x[nearest], job.y[nearest]};
  const double centre_value = job.value[nearest];
  double w_sum = 0, wf = 0, wxy = 0;
  Two first{0, 0}, second{0, 0}, mixed{0, 0};
  for (std::size_t i = 0; i < job.points; ++i) {
    const double w = weights[i], f = job.value[i] - centre_value;
    w_sum += w;
    wf += w * f;
    if constexpr (affine) {
      const Two p = Two{job.x[i], job.y[i]} - centre, a = w * p;
      first += a;
      second += a * p;
      wxy += a[0] * p[1];
      mixed += a * f;
    }
  }
  Moments<double> m;
  m.centre_x = L(centre[0]), m.centre_y = L(centre[1]), m.centre_value = L(centre_value);
  m.w = L(w_sum), m.wf = L(wf), m.wx = L(first[0]), m.wy = L(first[1]);
  m.wxx = L(second[0]), m.wxy = L(wxy), m.wyy = L(second[1]), m.wxf = L(mixed[0]), m.wyf = L(mixed[1]);
  return limited(job, value_of<affine>(job, m, x, y)).v[0];
}

}  // namespace

bool least_squares_takes_one(std::size_t points) noexcept { return points >= L::width && points <= most_points_of_one; }

double least_squares_of_one(const LeastSquaresJob<double>& job, double at_x, double at_y) noexcept {
  const L x = scaled(job, L(at_x)), y = scaled(job, L(at_y));
  return by_kind(job, [&]<bool affine, Power kind>() { return value_at<affine, kind>(job, x, y); });
}

}  // namespace petzval::camera_detail
