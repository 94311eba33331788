// SPDX-License-Identifier: Apache-2.0
// Samples of many pupils, compiled once for each instruction set: plain loops over blocks, which the compiler runs on
// its lanes. Names are local, and no other library is called, as in lib/trace/lanes.hpp.
#include "film_pupil_table_loops.hpp"

#include <type_traits>

#include "core/loop_math.hpp"

namespace petzval::inline v0::pupil_table_detail {
namespace {

/// Where a film point stands in the table, and which way it lies; nowhere: at the table's beginning.
template <class R>
struct Place {
  R t, cosine, sine;
  std::int32_t known, strip;
};

template <class R>
inline Place<R> place_of(const StripTable<R>& table, R film_x, R film_y, std::int32_t sound,
                         std::int32_t wavelength) noexcept {
  const auto last = static_cast<std::int32_t>(table.count) - 1;
  const R r2 = film_x * film_x + film_y * film_y;
  const R r = core_detail::square_root(r2);
  const std::int32_t known = (r <= table.lit_radius) & (wavelength >= 0) & sound;
  const std::int32_t turn = (table.turned ? 1 : 0) & known & (r2 > R(0));
  const R per_length = R(1) / (turn ? r : R(1));
  const R place = known ? r * table.strips_per_mm : R(0);
  const auto at = static_cast<std::int32_t>(place);
  const std::int32_t inner = at < last ? at : last;
  const std::int32_t strip =
      known ? (inner + wavelength * (last + 1)) * static_cast<std::int32_t>(StripLayout::size) : 0;
  return {place - static_cast<R>(inner), turn ? film_y * per_length : R(1), turn ? film_x * per_length : R(0), known,
          strip};
}

inline std::int32_t index(std::size_t place) noexcept { return static_cast<std::int32_t>(place); }

/// A corner of the polygon at the fraction t of a strip.
template <class R>
inline Point<R> corner_of(const R* all, std::int32_t strip, std::int32_t k, R t) noexcept {
  const std::int32_t c = strip + index(StripLayout::sectors) + index(StripLayout::sector) * k;
  return {all[c] + t * all[c + 2], all[c + 1] + t * all[c + 3]};
}

template <bool obscured, class R>
inline Sector<R> sector_of(const R* all, std::int32_t strip, std::int32_t k, R t) noexcept {
  Sector<R> sector{corner_of(all, strip, k, t), corner_of(all, strip, k + 1, t), R(0), R(0)};
  if constexpr (obscured) {
    const std::int32_t o = strip + index(StripLayout::obscured) + 4 * k;
    sector.obscured_from = all[o] + t * all[o + 2];
    sector.obscured = all[o + 1] + t * all[o + 3];
  }
  return sector;
}

/// One block, in loops without branches. Slots beyond `count` hold zeros.
template <std::size_t block, bool obscured, class R>
void sample_block(const StripTable<R>& table, const R* film_x, const R* film_y, const R* u, const R* v,
                  const std::int32_t* wavelength, R* x, R* y, R* area) noexcept {
  using L = StripLayout;
  constexpr auto corners = static_cast<std::int32_t>(polygon_corners);
  const StripTable<R> own_table = table;  // which nothing that is written overlaps
  const R* all = own_table.strips;
  R t[block], cosine[block], sine[block], target[block], whole[block], outer[block], behind[block], beyond[block];
  std::int32_t strip[block], sector[block];

  for (std::size_t i = 0; i < block; ++i) {
    // Comparisons with what is not a number are false.
    const R sound = (film_x[i] + film_y[i] + u[i] + v[i]) * R(0);
    const auto [part, cos, sin, known, at] = place_of(own_table, film_x[i], film_y[i], sound >= R(0), wavelength[i]);
    t[i] = part;
    cosine[i] = cos;
    sine[i] = sin;
    strip[i] = at;
    const R from = core_detail::clamped(u[i]) - turn_of(sin, cos);
    const R fraction = from < R(0) ? from + R(1) : from;
    target[i] = fraction < R(1) ? fraction : fraction - R(1);
    whole[i] = known ? R(1) : R(0);
    outer[i] = core_detail::clamped(v[i]);
  }
  const auto sector_at = [&](std::size_t i, std::int32_t k) {
    return strip[i] + index(L::sectors) + index(L::sector) * k;
  };
  const auto area_at = [&](std::size_t i, std::int32_t at) {
    const R cubic = obscured ? all[at + 3] : R(0);  // triangles are quadratic in t
    return all[at] + t[i] * (all[at + 1] + t[i] * (all[at + 2] + t[i] * cubic));
  };
  const auto area_before = [&](std::size_t i, std::int32_t k) { return area_at(i, sector_at(i, k) + 4); };
  const R early = table.corrections > 0 ? R(0) : R(0.5);
  for (std::size_t i = 0; i < block; ++i) {
    whole[i] = whole[i] * area_at(i, strip[i] + index(L::whole));
    const auto k = static_cast<std::int32_t>(target[i] * R(polygon_corners) - early);
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
    const std::int32_t k = sector[i], m = strip[i] + index(L::middle_y);
    const Sector<R> own = sector_of<obscured>(all, strip[i], k, t[i]);
    const R own_area = own.area();
    // From the sector's first corner, or back from its second.
    const R along = core_detail::clamped(behind[i] / (own_area > R(0) ? own_area : R(1)) + beyond[i]);
    const Point<R> p = own.at(core_detail::square_root(own.squared_way(outer[i])), along);
    const R py = all[m] + t[i] * all[m + 1] + p.y;
    const R some = whole[i] > R(0) ? R(1) : R(0);
    x[i] = some * (cosine[i] * p.x + sine[i] * py);
    y[i] = some * (cosine[i] * py - sine[i] * p.x);
    area[i] = some * whole[i];
  }
}

/// One block of places, whether their pupils contain them: sectors are found by halving.
template <std::size_t block, class R>
void contains_block(const StripTable<R>& table, const R* film_x, const R* film_y, const R* x, const R* y,
                    const std::int32_t* wavelength, std::uint8_t* within) noexcept {
  using L = StripLayout;
  constexpr auto corners = static_cast<std::int32_t>(polygon_corners);
  const StripTable<R> own_table = table;
  const R* all = own_table.strips;
  R t[block], qx[block], qy[block];
  std::int32_t strip[block], sector[block], half[block], known[block];
  for (std::size_t i = 0; i < block; ++i) {
    const auto [part, cosine, sine, lit, at] = place_of(own_table, film_x[i], film_y[i], 1, wavelength[i]);
    t[i] = part;
    strip[i] = at;
    known[i] = lit;
    qx[i] = cosine * x[i] - sine * y[i];
    qy[i] = sine * x[i] + cosine * y[i];
  }
  const auto corner = [&](std::size_t i, std::int32_t k) { return corner_of(all, strip[i], k, t[i]); };
  // Half turns count from the first corner.
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t m = strip[i] + index(L::middle_y);
    qy[i] -= all[m] + t[i] * all[m + 1];
    half[i] = turn(corner(i, 0), Point<R>{qx[i], qy[i]}) < R(0);
    sector[i] = 0;
  }
  for (std::int32_t step = corners / 2; step > 0; step /= 2) {
    for (std::size_t i = 0; i < block; ++i) {
      const Point<R> c = corner(i, sector[i] + step);
      const std::int32_t corner_half = turn(corner(i, 0), c) < R(0), behind = turn(c, Point<R>{qx[i], qy[i]}) >= R(0);
      sector[i] += (corner_half < half[i]) | ((corner_half == half[i]) & behind) ? step : 0;
    }
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const Sector<R> own = sector_of<true>(all, strip[i], sector[i], t[i]);
    const Point<R> q{qx[i], qy[i]};
    const R behind = turn(own.a, q), before = turn(q, own.b), whole = turn(own.a, own.b);
    const R way = (behind + before) / (whole > R(0) ? whole : R(1)), squared = way * way;
    const std::int32_t inside = known[i] & (behind >= R(0)) & (before >= R(0)) & (whole > R(0)) & (squared <= R(1));
    const std::int32_t dark = (squared >= own.obscured_from) & (squared < own.obscured_from + own.obscured);
    within[i] = static_cast<std::uint8_t>(inside & (1 - dark));
  }
}

/// A block, and what a few rays are put in: they fill the widest registers.
constexpr std::size_t whole_block = 64, small_block = 16;

template <std::size_t rays>
using Block = std::integral_constant<std::size_t, rays>;

/// Calls body(block, begin, n, four arrays of inputs, wavelengths) for each block of n; slots beyond n hold zeros.
template <class R, class Body>
inline void by_blocks(const StripTable<R>& table, std::size_t count, const R* const (&in)[4],
                      const RayWavelengths& wavelengths, const Body& body) noexcept {
  const auto known = [&](std::size_t w) { return w < table.wavelengths ? static_cast<std::int32_t>(w) : -1; };
  std::int32_t w[whole_block];
  for (std::size_t i = 0; i < whole_block; ++i) w[i] = known(wavelengths.all.position(table.primary));
  const auto find_wavelengths = [&](std::size_t begin, std::size_t n) {
    for (std::size_t i = 0; wavelengths.each && i < n; ++i) w[i] = known(wavelengths.each[begin + i]);
  };
  std::size_t begin = 0;
  const auto whole = [&](auto block) {
    for (; begin + block <= count; begin += block) {
      find_wavelengths(begin, block);
      const R* const here[4] = {in[0] + begin, in[1] + begin, in[2] + begin, in[3] + begin};
      body(block, begin, block, here, w);
    }
  };
  whole(Block<whole_block>());
  whole(Block<small_block>());
  const std::size_t n = count - begin;
  if (n == 0) return;
  find_wavelengths(begin, n);
  R filled[4][small_block] = {};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < n; ++i) filled[k][i] = in[k][begin + i];
  }
  const R* const part[4] = {filled[0], filled[1], filled[2], filled[3]};
  body(Block<small_block>(), begin, n, part, w);
}

template <class R>
void contains(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* x, const R* y,
              const RayWavelengths& wavelengths, std::uint8_t* within) noexcept {
  by_blocks(table, count, {film_x, film_y, x, y}, wavelengths,
            [&](auto block, std::size_t begin, std::size_t n, const R* const* in, const std::int32_t* w) {
              constexpr std::size_t rays = decltype(block)::value;
              std::uint8_t out[rays];
              contains_block<rays>(table, in[0], in[1], in[2], in[3], w, n == rays ? within + begin : out);
              for (std::size_t i = 0; n < rays && i < n; ++i) within[begin + i] = out[i];
            });
}

template <bool obscured, class R>
void sample_blocks(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u,
                   const R* v, const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  by_blocks(table, count, {film_x, film_y, u, v}, wavelengths,
            [&](auto block, std::size_t begin, std::size_t n, const R* const* in, const std::int32_t* w) {
              constexpr std::size_t rays = decltype(block)::value;
              if (n == rays) {
                sample_block<rays, obscured>(table, in[0], in[1], in[2], in[3], w, x + begin, y + begin, areas + begin);
                return;
              }
              R out[3][rays];
              sample_block<rays, obscured>(table, in[0], in[1], in[2], in[3], w, out[0], out[1], out[2]);
              for (std::size_t i = 0; i < n; ++i) {
                x[begin + i] = out[0][i], y[begin + i] = out[1][i], areas[begin + i] = out[2][i];
              }
            });
}

template <class R>
void sample(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u, const R* v,
            const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const auto blocks = table.obscured ? sample_blocks<true, R> : sample_blocks<false, R>;
  blocks(table, count, film_x, film_y, u, v, wavelengths, x, y, areas);
}

}  // namespace

const FilmPupilLoops PETZVAL_LOOPS{sample<float>, sample<double>, contains<float>, contains<double>};

}  // namespace petzval::inline v0::pupil_table_detail
