// SPDX-License-Identifier: Apache-2.0
// Samples of many pupils, compiled once for each instruction set: plain loops over blocks, which the compiler runs on
// its lanes. Names are local, and no other library is called, as in lib/trace/lanes.hpp.
#include "film_pupil_table_loops.hpp"

#include <type_traits>

#include "core/loop_math.hpp"
#include "core/simd.hpp"
#include "lens/look_up.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Where a film point stands in the table; nowhere: at the table's beginning.
template <class R>
struct Place {
  R t, s;          // s: of a cell
  R cosine, sine;  // which way the point lies; of a cell: the signs of its y and x
  std::int32_t known, begin;
  std::int32_t fold = 0;  // of a bladed iris
};

// Inlined, or a call would take a copy of the table, which compilers make with wide registers and without emptying
// them: code for narrow ones then waits for each.
template <class R>
PETZVAL_INLINE Place<R> place_of(const StripTable<R>& table, R film_x, R film_y, std::int32_t sound,
                                 std::int32_t wavelength) noexcept {
  const auto last = static_cast<std::int32_t>(table.count) - 1;
  const R r2 = film_x * film_x + film_y * film_y;
  const R r = core_detail::square_root(r2);
  const std::int32_t known = (r <= table.lit_radius) & (wavelength >= 0) & sound;
  const std::int32_t turn = known & (r2 > axis_r2<R>);
  const R per_length = R(1) / (turn ? r : R(1));
  const R place = known ? r * table.strips_per_mm : R(0);
  const auto at = static_cast<std::int32_t>(place);
  const std::int32_t inner = at < last ? at : last;
  const std::int32_t strip =
      known ? (inner + wavelength * (last + 1)) * static_cast<std::int32_t>(StripLayout::size) : 0;
  return {place - static_cast<R>(inner),     R(0),  turn ? film_y * per_length : R(1),
          turn ? film_x * per_length : R(0), known, strip};
}

template <class R>
PETZVAL_INLINE Place<R> place_of(const CellTable<R>& table, R film_x, R film_y, std::int32_t sound,
                                 std::int32_t wavelength) noexcept {
  const auto rows = static_cast<std::int32_t>(table.rows), columns = static_cast<std::int32_t>(table.columns);
  const R x = film_x < R(0) ? -film_x : film_x, y = film_y < R(0) ? -film_y : film_y;
  constexpr R end = R(1) + R(1e-6);  // the edge itself, rounded, still belongs to the film
  const R row = y * table.rows_per_mm;
  const std::int32_t in_rows =
      (x * x + y * y <= table.film_radius * table.film_radius) & (row <= end * static_cast<R>(rows)) & sound;
  const auto above = static_cast<std::int32_t>(in_rows ? row : R(0));
  const std::int32_t i = above < rows - 1 ? above : rows - 1;
  const R s = (in_rows ? row : R(0)) - static_cast<R>(i);
  const R width = table.half_widths[i] + s * (table.half_widths[i + 1] - table.half_widths[i]);
  const std::int32_t known = in_rows & (x <= end * width) & (wavelength >= 0);
  const R column = known ? x / (width > R(0) ? width : R(1)) * static_cast<R>(columns) : R(0);
  const auto right = static_cast<std::int32_t>(column);
  const std::int32_t j = right < columns - 1 ? right : columns - 1;
  const std::int32_t cell =
      known ? ((wavelength * rows + i) * columns + j) * static_cast<std::int32_t>(CellLayout::size) : 0;
  return {column - static_cast<R>(j), s, film_y < R(0) ? R(-1) : R(1), film_x < R(0) ? R(-1) : R(1), known, cell};
}

template <class R>
PETZVAL_INLINE Place<R> place_of(const BladedTable<R>& table, R film_x, R film_y, std::int32_t sound,
                                 std::int32_t wavelength) noexcept {
  const auto rows = static_cast<std::int32_t>(table.rows), columns = static_cast<std::int32_t>(table.columns);
  const R r2 = film_x * film_x + film_y * film_y;
  const R r = core_detail::square_root(r2);
  const std::int32_t known = (r <= table.lit_radius) & (wavelength >= 0) & sound;
  const std::int32_t off_axis = known & (r2 > axis_r2<R>);
  const R per_length = R(1) / (off_axis ? r : R(1));
  const R cosine = off_axis ? film_y * per_length : R(1), sine = off_axis ? film_x * per_length : R(0);
  const R row = known ? r * table.rows_per_mm : R(0);
  const auto above = static_cast<std::int32_t>(row);
  const std::int32_t i = above < rows - 1 ? above : rows - 1;
  // From the nearest corner of the iris, in blades; counted from one turn before the first.
  const R turn = table.blades * (turn_of(sine, cosine) + R(1)) + table.first_blade;
  auto blade = static_cast<std::int32_t>(turn + R(0.5));
  const R beside = turn - static_cast<R>(blade), mirrored = core_detail::sign_of(beside);
  const auto blades = static_cast<std::int32_t>(table.blades);
  blade -= blade >= blades ? blades : 0;
  blade -= blade >= blades ? blades : 0;
  const R column = R(2) * mirrored * beside * static_cast<R>(columns);
  const auto across = static_cast<std::int32_t>(column);
  const std::int32_t j = across < columns - 1 ? across : columns - 1;
  const std::int32_t cell =
      known ? ((wavelength * rows + i) * columns + j) * static_cast<std::int32_t>(BladedLayout::size) : 0;
  return {column - static_cast<R>(j),           row - static_cast<R>(i), cosine, sine, known, cell,
          2 * blade + (mirrored < R(0) ? 1 : 0)};
}

/// Corners of the polygons.
template <class Table>
PETZVAL_INLINE std::int32_t corners_of(const Table&) noexcept {
  return static_cast<std::int32_t>(polygon_corners);
}
template <class R>
PETZVAL_INLINE std::int32_t corners_of(const BladedTable<R>& table) noexcept {
  return static_cast<std::int32_t>(table.corners);
}

/// A place in the plane, given as the table has it: from the middle.
template <class R>
inline Point<R> turned(const StripTable<R>&, const Point<R>& middle, R cosine, R sine, std::int32_t,
                       const Point<R>& p) noexcept {
  const R y = middle.y + p.y;
  return {cosine * p.x + sine * y, cosine * y - sine * p.x};
}
template <class R>
inline Point<R> turned(const CellTable<R>&, const Point<R>& middle, R sign_y, R sign_x, std::int32_t,
                       const Point<R>& p) noexcept {
  return {sign_x * (middle.x + p.x), sign_y * (middle.y + p.y)};
}
template <class R>
inline Point<R> turned(const BladedTable<R>& table, const Point<R>& middle, R cosine, R sine, std::int32_t fold,
                       const Point<R>& p) noexcept {
  const R* by = table.folds + static_cast<std::int32_t>(BladedLayout::fold) * fold;
  return {sine * middle.y + (by[0] * p.x + by[1] * p.y), cosine * middle.y + (by[2] * p.x + by[3] * p.y)};
}
/// A place of the plane as the table has it: from the middle.
template <class R>
inline Point<R> turned_back(const StripTable<R>&, const Point<R>& middle, R cosine, R sine, std::int32_t,
                            const Point<R>& p) noexcept {
  return {cosine * p.x - sine * p.y - middle.x, sine * p.x + cosine * p.y - middle.y};
}
template <class R>
inline Point<R> turned_back(const CellTable<R>&, const Point<R>& middle, R sign_y, R sign_x, std::int32_t,
                            const Point<R>& p) noexcept {
  return {sign_x * p.x - middle.x, sign_y * p.y - middle.y};
}
template <class R>
inline Point<R> turned_back(const BladedTable<R>& table, const Point<R>& middle, R cosine, R sine, std::int32_t fold,
                            const Point<R>& p) noexcept {
  const R* by = table.folds + static_cast<std::int32_t>(BladedLayout::fold) * fold;
  const R x = p.x - sine * middle.y, y = p.y - cosine * middle.y;
  return {by[0] * x + by[2] * y, by[1] * x + by[3] * y};
}

inline std::int32_t index(std::size_t place) noexcept { return static_cast<std::int32_t>(place); }

/// The numbers of a table. They are read by places that are 32 bits wide: lanes gather by those.
template <class R>
inline const R* numbers(const StripTable<R>& table) noexcept {
  return table.strips;
}
template <class R>
inline const R* numbers(const CellTable<R>& table) noexcept {
  return table.cells;
}
template <class R>
inline const R* numbers(const BladedTable<R>& table) noexcept {
  return table.cells;
}

/// A number of a cell.
template <class R>
inline R in_cell(const R* all, std::int32_t at, R t, R s) noexcept {
  return all[at] + t * all[at + 1] + s * (all[at + 2] + t * all[at + 3]);
}

/// A corner of the polygon, from its middle.
template <class R>
inline Point<R> corner_of(StripLayout, const R* all, std::int32_t begin, std::int32_t k, R t, R) noexcept {
  const std::int32_t c = begin + index(StripLayout::sectors) + index(StripLayout::sector) * k;
  return {all[c] + t * all[c + 2], all[c + 1] + t * all[c + 3]};
}
template <class R>
inline Point<R> corner_of(CellLayout, const R* all, std::int32_t begin, std::int32_t k, R t, R s) noexcept {
  const std::int32_t c = begin + index(CellLayout::sectors) + index(CellLayout::sector) * k;
  return {in_cell(all, c, t, s), in_cell(all, c + 4, t, s)};
}

template <class R>
inline Point<R> middle_of(StripLayout, const R* all, std::int32_t begin, R t, R) noexcept {
  const std::int32_t m = begin + index(StripLayout::middle_y);
  return {R(0), all[m] + t * all[m + 1]};
}
template <class R>
inline Point<R> middle_of(CellLayout, const R* all, std::int32_t begin, R t, R s) noexcept {
  return {in_cell(all, begin + index(CellLayout::middle_x), t, s),
          in_cell(all, begin + index(CellLayout::middle_y), t, s)};
}

template <bool obscured, class R>
inline R area_at(StripLayout, const R* all, std::int32_t at, R t, R) noexcept {
  const R cubic = obscured ? all[at + 3] : R(0);  // triangles are quadratic in t
  return all[at] + t * (all[at + 1] + t * (all[at + 2] + t * cubic));
}
template <bool obscured, class R>
inline R area_at(CellLayout, const R* all, std::int32_t at, R t, R s) noexcept {
  const R one = all[at] + t * (all[at + 1] + t * all[at + 2]);
  const R by_s = all[at + 3] + t * (all[at + 4] + t * all[at + 5]);
  const R by_s2 = all[at + 6] + t * (all[at + 7] + t * all[at + 8]);
  return one + s * (by_s + s * by_s2);
}
/// Area of the sectors before one.
template <bool obscured, class Layout, class R>
inline R area_before(Layout layout, const R* all, std::int32_t begin, std::int32_t k, R t, R s) noexcept {
  return area_at<obscured>(layout, all,
                           begin + index(Layout::sectors) + index(Layout::sector) * k + index(Layout::area), t, s);
}

/// The share of the half at +x, of a polygon with a whole area.
template <class R>
inline R right_share(const R* all, std::int32_t begin, R t, R s, R whole) noexcept {
  return area_before<false>(CellLayout{}, all, begin, index(polygon_corners / 2), t, s) / (whole > R(0) ? whole : R(1));
}

/// Of a number from -1 to 2, from 0 to 1, in a form without branches.
template <class R>
PETZVAL_INLINE R fraction_of(R x) noexcept {
  const R from_0 = x + R(0.5) * (R(1) - core_detail::sign_of(x));
  return from_0 - R(0.5) * (R(1) - core_detail::sign_of(R(1) - from_0));
}

/// u from where the polygon of the table begins, in the direction of its corners.
template <class R>
PETZVAL_INLINE R share_of(const StripTable<R>&, const R*, std::int32_t, R, R, R, R cosine, R sine, std::int32_t,
                          R u) noexcept {
  const R from = u - turn_of(sine, cosine);
  return fraction_of(from);
}
template <class R>
PETZVAL_INLINE R share_of(const CellTable<R>&, const R* all, std::int32_t begin, R t, R s, R whole, R sign_y, R sign_x,
                          std::int32_t, R u) noexcept {
  const R across = (R(1) - sign_x) / R(2) + sign_x * u;
  const R from = (R(1) - sign_y) / R(2) * right_share(all, begin, t, s, whole) + sign_y * across;
  return fraction_of(from);
}

template <class R>
PETZVAL_INLINE R share_of(const BladedTable<R>& table, const R* all, std::int32_t begin, R t, R s, R whole, R, R,
                          std::int32_t fold, R u) noexcept {
  const R* by = table.folds + static_cast<std::int32_t>(BladedLayout::fold) * fold;
  const R before = area_before<false>(CellLayout{}, all, begin, static_cast<std::int32_t>(by[4]), t, s);
  return fraction_of(before / (whole > R(0) ? whole : R(1)) + by[5] * u);
}

/// In sectors, where a share of the area is expected to end.
template <class R>
inline R expected_sector(const StripTable<R>&, const R*, std::int32_t, R, R, R, R share) noexcept {
  return share * R(polygon_corners);
}
template <class R>
inline R expected_sector(const CellTable<R>&, const R* all, std::int32_t begin, R t, R s, R whole, R share) noexcept {
  return sectors_in_halves(share, right_share(all, begin, t, s, whole));
}
template <class R>
inline R expected_sector(const BladedTable<R>&, const R* all, std::int32_t begin, R, R, R, R share) noexcept {
  constexpr auto steps = static_cast<std::int32_t>(BladedLayout::guide_steps);
  const R place = share * static_cast<R>(steps);
  const auto below = static_cast<std::int32_t>(place);
  const std::int32_t k = below < steps - 1 ? below : steps - 1;
  const std::int32_t at = begin + static_cast<std::int32_t>(BladedLayout::guide) + k;
  return all[at] + (place - static_cast<R>(k)) * (all[at + 1] - all[at]);
}

template <bool obscured, class Layout, class R>
inline Sector<R> sector_of(Layout layout, const R* all, std::int32_t begin, std::int32_t k, R t, R s) noexcept {
  Sector<R> sector{corner_of(layout, all, begin, k, t, s), corner_of(layout, all, begin, k + 1, t, s), R(0), R(0)};
  if constexpr (obscured) {
    const std::int32_t o = begin + index(Layout::obscured) + 4 * k;
    sector.obscured_from = all[o] + t * all[o + 2];
    sector.obscured = all[o + 1] + t * all[o + 3];
  }
  return sector;
}

/// One block, in loops without branches. Slots beyond `count` hold zeros.
template <std::size_t block, bool obscured, class Table, class R>
PETZVAL_INLINE void sample_block(const Table& table, const R* film_x, const R* film_y, const R* u, const R* v,
                                 const std::int32_t* wavelength, R* x, R* y, R* area) noexcept {
  using L = typename Table::Layout;
  const Table own_table = table;  // which nothing that is written overlaps
  const std::int32_t corners = corners_of(own_table);
  const R* all = numbers(own_table);
  constexpr L layout;
  R t[block], s[block], cosine[block], sine[block], target[block], whole[block], outer[block], behind[block],
      beyond[block];
  std::int32_t begin[block], sector[block], fold[block];

  for (std::size_t i = 0; i < block; ++i) {
    // Comparisons with what is not a number are false.
    const R sound = (film_x[i] + film_y[i] + u[i] + v[i]) * R(0);
    const auto [along, across, cos, sin, known, at, way] =
        place_of(own_table, film_x[i], film_y[i], sound >= R(0), wavelength[i]);
    t[i] = along;
    s[i] = across;
    cosine[i] = cos;
    sine[i] = sin;
    begin[i] = at;
    fold[i] = way;
    target[i] = core_detail::clamped(u[i]);
    whole[i] = known ? R(1) : R(0);
    outer[i] = core_detail::clamped(v[i]);
  }
  const auto before = [&](std::size_t i, std::int32_t k) {
    return area_before<obscured>(layout, all, begin[i], k, t[i], s[i]);
  };
  const R early = table.corrections > 0 ? R(0) : R(0.5), last = static_cast<R>(corners - 1);
  for (std::size_t i = 0; i < block; ++i) {
    whole[i] = whole[i] * area_at<obscured>(layout, all, begin[i] + index(L::whole), t[i], s[i]);
    // Areas between nodes may turn over: a share is then anything, and a sector any of the polygon's.
    target[i] = core_detail::clamped(
        share_of(own_table, all, begin[i], t[i], s[i], whole[i], cosine[i], sine[i], fold[i], target[i]));
    const R expected = expected_sector(own_table, all, begin[i], t[i], s[i], whole[i], target[i]) - early;
    const R above = expected > R(0) ? expected : R(0);
    sector[i] = static_cast<std::int32_t>(above < last ? above : last);
    target[i] = target[i] * whole[i];
  }
  // Sectors have nearly equal shares: the right one is this or the next, or else near.
  for (int step = 0; step < table.corrections; ++step) {
    const std::int32_t first = sector[0];
    for (std::size_t i = 0; i < block; ++i) {
      const std::int32_t k = sector[i];
      const std::int32_t back = (target[i] < before(i, k)) & (k > 0);
      const std::int32_t on = (target[i] > before(i, k + 1)) & (k < corners - 1);
      sector[i] = k + on - back;
    }
    if (block == 1 && sector[0] == first) break;  // of many, some always move
  }
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t k = sector[i];
    behind[i] = target[i] - before(i, k + 1);
    const std::int32_t next = (behind[i] >= R(0)) & (k < corners - 1);
    sector[i] = k + next;
    beyond[i] = static_cast<R>(1 - next);
  }
  // The results overlap nothing that is read here.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const Sector<R> own = sector_of<obscured>(layout, all, begin[i], sector[i], t[i], s[i]);
    const R own_area = own.area();
    // From the sector's first corner, or back from its second.
    const R along = core_detail::clamped(behind[i] / (own_area > R(0) ? own_area : R(1)) + beyond[i]);
    const Point<R> p = own.at(core_detail::square_root(own.squared_way(outer[i])), along);
    const Point<R> middle = middle_of(layout, all, begin[i], t[i], s[i]);
    const Point<R> place = turned(own_table, middle, cosine[i], sine[i], fold[i], p);
    const R some = whole[i] > R(0) ? R(1) : R(0);
    x[i] = some * place.x;
    y[i] = some * place.y;
    area[i] = some * whole[i];
  }
}

/// One block of places, whether their pupils contain them: sectors are found by halving.
template <std::size_t block, bool obscured, class Table, class R>
void contains_block(const Table& table, const R* film_x, const R* film_y, const R* x, const R* y,
                    const std::int32_t* wavelength, std::uint8_t* within) noexcept {
  constexpr auto corners = static_cast<std::int32_t>(polygon_corners);
  const Table own_table = table;
  const std::int32_t used = corners_of(own_table);
  const R* all = numbers(own_table);
  constexpr typename Table::Layout layout;
  R t[block], s[block], qx[block], qy[block];
  std::int32_t begin[block], sector[block], half[block], known[block];
  for (std::size_t i = 0; i < block; ++i) {
    const auto [along, across, cosine, sine, lit, at, fold] =
        place_of(own_table, film_x[i], film_y[i], 1, wavelength[i]);
    t[i] = along;
    s[i] = across;
    begin[i] = at;
    known[i] = lit;
    const Point<R> middle = middle_of(layout, all, at, along, across);
    const Point<R> q = turned_back(own_table, middle, cosine, sine, fold, Point<R>{x[i], y[i]});
    qx[i] = q.x;
    qy[i] = q.y;
  }
  const auto corner = [&](std::size_t i, std::int32_t k) { return corner_of(layout, all, begin[i], k, t[i], s[i]); };
  // Half turns count from the first corner.
  for (std::size_t i = 0; i < block; ++i) {
    half[i] = turn(corner(i, 0), Point<R>{qx[i], qy[i]}) < R(0);
    sector[i] = 0;
  }
  for (std::int32_t step = corners / 2; step > 0; step /= 2) {
    for (std::size_t i = 0; i < block; ++i) {
      const Point<R> c = corner(i, sector[i] + step);
      const std::int32_t corner_half = turn(corner(i, 0), c) < R(0), behind = turn(c, Point<R>{qx[i], qy[i]}) >= R(0);
      const std::int32_t exists = sector[i] + step < used;
      sector[i] += exists & ((corner_half < half[i]) | ((corner_half == half[i]) & behind)) ? step : 0;
    }
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const Sector<R> own = sector_of<obscured>(layout, all, begin[i], sector[i], t[i], s[i]);
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
template <class Table, class R, class Body>
inline void by_blocks(const Table& table, std::size_t count, const R* const (&in)[4], const RayWavelengths& wavelengths,
                      const Body& body) noexcept {
  const auto known = [&](std::size_t w) { return w < table.wavelengths ? static_cast<std::int32_t>(w) : -1; };
  std::int32_t w[whole_block];
  for (std::size_t i = 0; i < whole_block; ++i) w[i] = known(wavelengths.all.position(table.primary));
  const auto find_wavelengths = [&](std::size_t begin, auto n) {
    if (!wavelengths.each) return;
    const std::uint16_t* const each = wavelengths.each + begin;
    const auto count_known = static_cast<std::int32_t>(table.wavelengths);
    for (std::size_t i = 0; i < n; ++i) w[i] = each[i] < count_known ? each[i] : -1;
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

template <bool obscured, class Table, class R>
void contains(const Table& table, std::size_t count, const R* film_x, const R* film_y, const R* x, const R* y,
              const RayWavelengths& wavelengths, std::uint8_t* within) noexcept {
  const R* const in[4] = {film_x, film_y, x, y};
  by_blocks(table, count, in, wavelengths,
            [&](auto block, std::size_t begin, std::size_t n, const R* const* of, const std::int32_t* w) {
              constexpr std::size_t rays = decltype(block)::value;
              std::uint8_t out[rays];
              contains_block<rays, obscured>(table, of[0], of[1], of[2], of[3], w, n == rays ? within + begin : out);
              for (std::size_t i = 0; n < rays && i < n; ++i) within[begin + i] = out[i];
            });
}

template <bool obscured, class Table, class R>
void sample_blocks(const Table& table, std::size_t count, const R* film_x, const R* film_y, const R* u, const R* v,
                   const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const R* const in[4] = {film_x, film_y, u, v};
  by_blocks(table, count, in, wavelengths,
            [&](auto block, std::size_t begin, std::size_t n, const R* const* of, const std::int32_t* w) {
              constexpr std::size_t rays = decltype(block)::value;
              if (n == rays) {
                sample_block<rays, obscured>(table, of[0], of[1], of[2], of[3], w, x + begin, y + begin, areas + begin);
                return;
              }
              R out[3][rays];
              sample_block<rays, obscured>(table, of[0], of[1], of[2], of[3], w, out[0], out[1], out[2]);
              for (std::size_t i = 0; i < n; ++i) {
                x[begin + i] = out[0][i], y[begin + i] = out[1][i], areas[begin + i] = out[2][i];
              }
            });
}

template <class R>
void sample_strips(const StripTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u,
                   const R* v, const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const auto blocks = table.obscured ? sample_blocks<true, StripTable<R>, R> : sample_blocks<false, StripTable<R>, R>;
  blocks(table, count, film_x, film_y, u, v, wavelengths, x, y, areas);
}

template <bool obscured, class Table>
PupilSample one_of(const Table& table, double film_x, double film_y, double u, double v,
                   std::int32_t wavelength) noexcept {
  PupilSample result;
  sample_block<1, obscured>(table, &film_x, &film_y, &u, &v, &wavelength, &result.x, &result.y, &result.area);
  return result;
}

PupilSample one_of_strips(const StripTable<double>& table, double film_x, double film_y, double u, double v,
                          std::int32_t wavelength) noexcept {
  return table.obscured ? one_of<true>(table, film_x, film_y, u, v, wavelength)
                        : one_of<false>(table, film_x, film_y, u, v, wavelength);
}

template <class R>
constexpr auto contains_strips = contains<true, StripTable<R>, R>;
template <class R>
constexpr auto sample_cells = sample_blocks<false, CellTable<R>, R>;
template <class R>
constexpr auto contains_cells = contains<false, CellTable<R>, R>;
template <class R>
constexpr auto sample_bladed = sample_blocks<false, BladedTable<R>, R>;
template <class R>
constexpr auto contains_bladed = contains<false, BladedTable<R>, R>;

}  // namespace

const FilmPupilLoops PETZVAL_LOOPS{.strips = {sample_strips<float>, sample_strips<double>, contains_strips<float>,
                                              contains_strips<double>, one_of_strips},
                                   .cells = {sample_cells<float>, sample_cells<double>, contains_cells<float>,
                                             contains_cells<double>, one_of<false, CellTable<double>>},
                                   .bladed = {sample_bladed<float>, sample_bladed<double>, contains_bladed<float>,
                                              contains_bladed<double>, one_of<false, BladedTable<double>>},

                                   .find_nearest = lens_detail::find_nearest};

}  // namespace petzval::pupil_table_detail
