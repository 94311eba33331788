// SPDX-License-Identifier: Apache-2.0
// Samples of many pupils, compiled once for each instruction set: plain loops over blocks, which the compiler runs on
// its lanes. Names are local, and no other library is called, as in lib/trace/lanes.hpp.
#include "pupil_map_loops.hpp"

namespace petzval::detail {
namespace {

constexpr std::size_t block = 64;

inline float root(float x) noexcept { return __builtin_sqrtf(x); }
inline double root(double x) noexcept { return __builtin_sqrt(x); }

template <class R>
inline R clamped(R x) noexcept {
  x = x > R(0) ? x : R(0);
  return x < R(1) ? x : R(1);
}

/// One block, in loops without branches. Slots beyond `count` hold zeros.
template <bool gapped, class R>
void sample_block(const StripTable<R>& table, const R* film_x, const R* film_y, const R* u, const R* v,
                  const std::int32_t* wavelength, R* x, R* y, R* area) noexcept {
  using L = StripLayout;
  const auto index = [](std::size_t place) { return static_cast<std::int32_t>(place); };
  constexpr auto corners = static_cast<std::int32_t>(star_corners), size = static_cast<std::int32_t>(L::size);
  const R* all = table.strips;
  const auto last = static_cast<std::int32_t>(table.count) - 1;
  const R radius = table.lit_radius, strips_per_mm = table.strips_per_mm;
  const std::int32_t turned = table.turned ? 1 : 0;
  R t[block], cosine[block], sine[block], target[block], whole[block], outer[block], behind[block], beyond[block];
  std::int32_t strip[block], sector[block];

  for (std::size_t i = 0; i < block; ++i) {
    const R r2 = film_x[i] * film_x[i] + film_y[i] * film_y[i];
    const R r = root(r2);
    // Comparisons with what is not a number are false.
    const R sound = (film_x[i] + film_y[i] + u[i] + v[i]) * R(0);
    const std::int32_t known = (r <= radius) & (wavelength[i] >= 0) & (sound >= R(0));
    const std::int32_t turn = turned & known & (r2 > R(0));
    const R fx = turn ? film_x[i] : R(0), fy = turn ? film_y[i] : R(1), length = turn ? r : R(1);
    cosine[i] = fy / length;
    sine[i] = fx / length;
    const R place = known ? r * strips_per_mm : R(0);
    const auto at = static_cast<std::int32_t>(place);
    const std::int32_t inner = at < last ? at : last;
    t[i] = place - static_cast<R>(inner);
    strip[i] = known ? (inner + wavelength[i] * (last + 1)) * size : 0;
    const R from = clamped(known ? u[i] : R(0)) - turn_of(fx, fy);
    const R fraction = from < R(0) ? from + R(1) : from;
    target[i] = fraction < R(1) ? fraction : fraction - R(1);
    whole[i] = known ? R(1) : R(0);
    outer[i] = clamped(known ? v[i] : R(0));
  }
  const auto sector_at = [&](std::size_t i, std::int32_t k) {
    return strip[i] + index(L::sectors) + index(L::sector) * k;
  };
  const auto area_at = [&](std::size_t i, std::int32_t at) {
    const R cubic = gapped ? all[at + 3] : R(0);  // triangles are quadratic in t
    return all[at] + t[i] * (all[at + 1] + t[i] * (all[at + 2] + t[i] * cubic));
  };
  const auto area_before = [&](std::size_t i, std::int32_t k) { return area_at(i, sector_at(i, k) + 4); };
  const R early = table.corrections > 0 ? R(0) : R(0.5);
  for (std::size_t i = 0; i < block; ++i) {
    whole[i] = whole[i] * area_at(i, strip[i] + index(L::whole));
    const auto k = static_cast<std::int32_t>(target[i] * R(star_corners) - early);
    sector[i] = k < corners ? k : corners - 1;
    target[i] = target[i] * whole[i];
  }
  // Sectors have nearly equal shares: the right one is this or the next, or else near.
  for (int step = 0; step < table.corrections; ++step) {
    for (std::size_t i = 0; i < block; ++i) {
      const std::int32_t k = sector[i];
      const std::int32_t back = (target[i] < area_before(i, k)) & (k > 0);
      const std::int32_t on = (target[i] > area_before(i, k + 1)) & (k < corners - 1);
      sector[i] = k + on - back;
    }
  }
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t k = sector[i];
    behind[i] = target[i] - area_before(i, k + 1);
    sector[i] = k + ((behind[i] >= R(0)) & (k < corners - 1));
    beyond[i] = sector[i] == k ? R(1) : R(0);
  }
  // The results overlap nothing that is read here.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t k = sector[i], a = sector_at(i, k), b = a + index(L::sector), m = strip[i] + index(L::middle_y);
    const R ax = all[a] + t[i] * all[a + 2], ay = all[a + 1] + t[i] * all[a + 3];
    const R bx = all[b] + t[i] * all[b + 2], by = all[b + 1] + t[i] * all[b + 3];
    R gap_from(0), gap(0);
    if constexpr (gapped) {
      const std::int32_t g = strip[i] + index(L::gaps) + 4 * k;
      gap_from = all[g] + t[i] * all[g + 2];
      gap = all[g + 1] + t[i] * all[g + 3];
    }
    const R rest = R(1) - gap;
    const R own = R(0.5) * (bx * ay - ax * by) * rest;
    // From the sector's first corner, or back from its second.
    const R along = clamped(behind[i] / (own > R(0) ? own : R(1)) + beyond[i]);
    const R within = rest * outer[i];
    const R out = root(within < gap_from ? within : within + gap);
    const R px = out * (ax + along * (bx - ax));
    const R py = all[m] + t[i] * all[m + 1] + out * (ay + along * (by - ay));
    const R some = whole[i] > R(0) ? R(1) : R(0);
    x[i] = some * (cosine[i] * px + sine[i] * py);
    y[i] = some * (cosine[i] * py - sine[i] * px);
    area[i] = some * whole[i];
  }
}

template <bool gapped, class R>
void sample_blocks(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u,
                   const R* v, const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const auto known = [&](std::size_t w) { return w < table.wavelengths ? static_cast<std::int32_t>(w) : -1; };
  std::int32_t w[block];
  for (std::size_t i = 0; i < block; ++i) w[i] = known(wavelengths.all);
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    if (wavelengths.each) {
      for (std::size_t i = 0; i < n; ++i) w[i] = known(wavelengths.each[begin + i]);
    }
    if (n == block) {
      sample_block<gapped>(table, film_x + begin, film_y + begin, u + begin, v + begin, w, x + begin, y + begin,
                           areas + begin);
      continue;
    }
    R in[4][block] = {}, out[3][block];
    for (std::size_t i = 0; i < n; ++i) {
      in[0][i] = film_x[begin + i], in[1][i] = film_y[begin + i];
      in[2][i] = u[begin + i], in[3][i] = v[begin + i];
    }
    sample_block<gapped>(table, in[0], in[1], in[2], in[3], w, out[0], out[1], out[2]);
    for (std::size_t i = 0; i < n; ++i) {
      x[begin + i] = out[0][i], y[begin + i] = out[1][i], areas[begin + i] = out[2][i];
    }
  }
}

template <class R>
void sample(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u, const R* v,
            const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const auto blocks = table.gapped ? sample_blocks<true, R> : sample_blocks<false, R>;
  blocks(table, count, film_x, film_y, u, v, wavelengths, x, y, areas);
}

}  // namespace

const PupilMapLoops PETZVAL_LOOPS{sample<float>, sample<double>};

}  // namespace petzval::detail
