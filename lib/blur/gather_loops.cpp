// SPDX-License-Identifier: Apache-2.0
#include "gather_loops.hpp"

#include <utility>

#include "core/lanes.hpp"
#include "packed_colour.hpp"
#include "pixel_steps.hpp"
#include "ray_rows.hpp"

namespace petzval::blur_detail {
namespace {

using Numbers = core_detail::Lanes<float>;
using Mask = core_detail::Mask<float>;
using PixelIndices = core_detail::Native<float>::Bits;  // 32-bit integers
using Values = core_detail::Native<float>::Values;
constexpr int width = Numbers::width;

template <>
struct WholePixel<Numbers> {
  static PETZVAL_INLINE Numbers below(Numbers x) noexcept {
    // The addition rounds to 1/256; conversions truncate towards 0.
    constexpr int rounding_offset = 1 << 15;
    const PixelIndices whole =
        __builtin_convertvector((x + Numbers(static_cast<float>(rounding_offset))).v, PixelIndices) - rounding_offset;
    return Numbers(__builtin_convertvector(whole, core_detail::Native<float>::Values));
  }
};

using core_detail::load;
PETZVAL_INLINE float sum_of(Numbers numbers) noexcept {
  float sum = 0;
  for (int i = 0; i < width; ++i) sum += numbers.v[i];
  return sum;
}
PETZVAL_INLINE Numbers only(Mask mask, Numbers numbers) noexcept { return select(mask, numbers, Numbers(0.0f)); }

PETZVAL_INLINE Mask first_lanes(std::size_t count) noexcept {
  Numbers lane;
  for (int i = 0; i < width; ++i) lane.v[i] = static_cast<float>(i);
  return lane < Numbers(static_cast<float>(count));
}

/// Loads every side-th number.
template <int side, int... lanes>
PETZVAL_INLINE Numbers load_every(const float* from, std::integer_sequence<int, lanes...> all) noexcept {
  if constexpr (side == 1) {
    return load(from);
  } else {
    const Numbers a = load_every<side / 2>(from, all), b = load_every<side / 2>(from + side / 2 * width, all);
    return Numbers(__builtin_shufflevector(a.v, b.v, (2 * lanes)...));
  }
}

/// Loads pixels `side` columns apart, one per lane.
template <int side>
struct Apart {
  std::ptrdiff_t offset;

  PETZVAL_INLINE Numbers operator()(const float* plane) const noexcept {
    return load_every<side>(plane + offset, std::make_integer_sequence<int, width>{});
  }
};
using AdjacentPixels = Apart<1>;

/// Loads a pixel for each active lane, and 0 for the other lanes, whose rays have ended.
struct Anywhere {
  PixelIndices offsets;
  Mask lanes;

  PETZVAL_INLINE Numbers operator()(const float* plane) const noexcept {
    return core_detail::gather(plane, offsets, lanes);
  }
};

/// The results of the rays in the lanes.
template <bool opaque, int colours>
struct GatherState {
  Numbers colour[colours], missed{0.0f}, unknown{0.0f}, open{0.0f};
  Mask seeking;  ///< lanes whose rays have not ended
  // For transparent surfaces:
  Numbers alpha{0.0f};
  Numbers through{1.0f};  ///< remaining fraction of a ray
  Numbers below{1e30f};   ///< prevents a second hit on the same surface in the next pixel

  /// Inverse depth of the nearest surface in the previous pixel that the ray passed in front of.
  Numbers front{no_surface};

  /// Keeps the sums.
  PETZVAL_INLINE void begin_ray(Mask lanes) noexcept {
    seeking = lanes, front = Numbers(no_surface);
    if constexpr (!opaque) through = Numbers(1.0f), below = Numbers(1e30f);
  }
  PETZVAL_INLINE GatherState() noexcept : GatherState(first_lanes(0)) {}
  PETZVAL_INLINE explicit GatherState(Mask lanes) noexcept : seeking(lanes) {
    for (Numbers& c : colour) c = Numbers(0.0f);
  }
};

/// The colours of the pixels that `at` loads from a layer.
template <int colours>
struct Colours {
  Numbers of[colours];

  template <class At>
  PETZVAL_INLINE Colours(const LayerWindow& window, const At& at, std::ptrdiff_t layer) noexcept {
    constexpr auto upper = static_cast<std::int32_t>(PackedColour::upper),
                   lower = static_cast<std::int32_t>(PackedColour::lower);
    const auto bits = [&](int p) { return reinterpret_cast<PixelIndices>(at(window.colour[p] + layer).v); };
    const auto numbers = [](PixelIndices b) { return Numbers(reinterpret_cast<Values>(b)); };
    const auto blue = [&](PixelIndices r, PixelIndices g) {
      return numbers((r & lower) << PackedColour::first_half | (g & lower) << PackedColour::second_half);
    };
    if constexpr (colours == 3) {
      const PixelIndices r = bits(0), g = bits(1);
      of[0] = numbers(r & upper), of[1] = numbers(g & upper), of[2] = blue(r, g);
    } else {
      of[0] = window.channel < 2 ? numbers(bits(window.channel) & upper) : blue(bits(0), bits(1));
    }
  }
};

PETZVAL_INLINE Numbers larger(Numbers a, Numbers b) noexcept { return select(a > b, a, b); }

/// The value of Found::front for a pixel that a ray passes in front of.
PETZVAL_INLINE Numbers in_front(Numbers w) noexcept { return select(w >= Numbers(0.0f), w, Numbers(no_surface)); }

/// Lets the lanes of `hit` meet a layer in the pixels that `at` loads. Removes lanes from `here` if their rays end.
template <bool opaque, int colours, class At>
PETZVAL_INLINE void take(const LayerWindow& window, const At& at, std::ptrdiff_t layer, Numbers low, Numbers weight,
                         Mask hit, Mask& here, GatherState<opaque, colours>& found) noexcept {
  const Numbers contribution = opaque ? weight : weight * found.through;
  const Colours<colours> colour(window, at, layer);
  for (int c = 0; c < colours; ++c) found.colour[c] = found.colour[c] + only(hit, contribution * colour.of[c]);
  Mask ended = hit;
  if constexpr (!opaque) {
    const Numbers alpha = at(window.alpha + layer);
    found.alpha = found.alpha + only(hit, contribution * alpha);
    found.through = select(hit, found.through * (Numbers(1.0f) - alpha), found.through);
    found.below = select(hit, low, found.below);
    ended = all_of(hit, found.through <= Numbers(1e-3f));
  }
  found.seeking = without(found.seeking, ended), here = without(here, ended);
}

/// One step of rays without a hit so far: lanes of `here` pass the pixels that `at` loads, between the inverse depths
/// low and high.
///
/// A ray that passed in front of a surface in the previous pixel and is behind a surface in this pixel went between the
/// centres of both pixels. If the inverse depths of both surfaces differ by less than `gap`, the layers contain no
/// surface between them, and the ray meets the farther surface. (At the edge of a small object the ray passes the
/// object; on one surface both colours are nearly equal.)
/// @param before the pixels of the previous step
template <bool opaque, int colours, class At>
PETZVAL_INLINE void meet(const LayerWindow& window, const At& at, const At& before, Numbers low, Numbers high,
                         Numbers gap, Numbers weight, Mask here, GatherState<opaque, colours>& found) noexcept {
  const float* depth = window.depth;
  std::ptrdiff_t layer = 0;
  [[maybe_unused]] const Numbers below = found.below;
  const Numbers passed = found.front, none(no_surface);
  Numbers front = none, joined_to = passed + gap;
  for (int l = 0; l < window.layers; ++l, depth += window.layer_stride, layer += window.layer_stride) {
    const Numbers w = at(depth);
    Mask hit = all_of(w >= low, w <= high, here), joined = all_of(w > high, w <= joined_to, here);
    if constexpr (!opaque) hit = all_of(hit, w < below), joined = all_of(joined, w < below);
    if (any(joined)) {
      joined_to = select(joined, none, joined_to);  // at most once per step
      const float* depth_before = window.depth;
      std::ptrdiff_t layer_before = 0;
      for (int k = 0; k < window.layers && any(joined); ++k) {
        const Numbers v = before(depth_before);
        const Mask met = all_of(v >= passed, v <= passed, joined);
        take(window, before, layer_before, low, weight, met, here, found);
        joined = without(joined, met);
        depth_before += window.layer_stride, layer_before += window.layer_stride;
      }
    }
    if (any(hit)) take(window, at, layer, low, weight, hit, here, found);
    front = larger(front, select(w < low, in_front(w), none));
    // Later layers are farther away: a ray in front of this layer cannot reach them in this step.
    if (!any(all_of(here, w >= low))) break;
  }
  found.front = front;
}

/// Rays without a hit end in the void if the first layer is empty at the depth of the farthest surface.
template <bool opaque, int colours, class At>
PETZVAL_INLINE void end_in_void(const LayerWindow& window, const At& end, Numbers weight, Mask here,
                                GatherState<opaque, colours>& found) noexcept {
  const Mask empty = all_of(here, end(window.depth) < Numbers(0.0f));
  found.open = found.open + only(empty, weight);
  found.seeking = without(found.seeking, empty);
}

/// Other rays slipped behind a surface. The best guess for such a ray is the last surface that it passed.
template <bool opaque, int colours, class At>
PETZVAL_INLINE void guess(const LayerWindow& window, const At& at, Numbers low, Numbers weight, Mask here,
                          GatherState<opaque, colours>& found) noexcept {
  const float* depth = window.depth;
  std::ptrdiff_t layer = 0;
  const Numbers none(0.0f);
  for (int l = 0; l < window.layers; ++l, depth += window.layer_stride, layer += window.layer_stride) {
    const Numbers w = at(depth);
    const Mask before = all_of(here, w < low, w >= none);
    if (any(before)) {
      const Colours<colours> colour(window, at, layer);
      for (int c = 0; c < colours; ++c) found.colour[c] = found.colour[c] + only(before, weight * colour.of[c]);
      if constexpr (!opaque) found.alpha = found.alpha + only(before, weight * at(window.alpha + layer));
      found.missed = found.missed + only(before, weight);
      found.seeking = without(found.seeking, before), here = without(here, before);
    }
    if (!any(here)) return;
  }
}

/// The rest of a ray that met a surface with alpha below 1, even with alpha 0, ends in the void.
template <bool opaque, int colours>
PETZVAL_INLINE void end_partly(GatherState<opaque, colours>& found) noexcept {
  if constexpr (!opaque) found.seeking = all_of(found.seeking, found.below >= Numbers(1e30f));
}

template <bool opaque, int colours>
PETZVAL_INLINE void give_up(Numbers weight, GatherState<opaque, colours>& found) noexcept {
  const Numbers rest = only(found.seeking, weight);
  found.missed = found.missed + rest, found.unknown = found.unknown + rest;
}

/// Stores the results of adjacent pixels.
template <bool opaque, int colours>
PETZVAL_INLINE void keep(TileSums& sums, int pixel, const GatherState<opaque, colours>& found,
                         Numbers weight) noexcept {
  for (int c = 0; c < colours; ++c) store(sums.colour[c] + pixel, found.colour[c]);
  store(sums.total + pixel, weight);
  if constexpr (!opaque) store(sums.alpha + pixel, found.alpha);
  store(sums.open + pixel, found.open);
  store(sums.missed + pixel, found.missed);
  store(sums.unknown + pixel, found.unknown);
}

/// Follows one ray of pixels `side` columns apart, starting at the step `from`.
template <int side, bool opaque, int colours>
PETZVAL_INLINE std::uint64_t follow_ray(const LayerWindow& window, const Step* begin, const Step* from, const Step* end,
                                        std::ptrdiff_t last, Numbers gap, Numbers weight, Mask lanes,
                                        GatherState<opaque, colours>& found) noexcept {
  found.begin_ray(lanes);
  // In the previous step, all pixels passed in front of the first layer.
  if (from != begin) found.front = in_front(Apart<side>{from[-1].offset}(window.depth));
  std::uint64_t made = 0;
  for (const Step* step = from; step != end && any(found.seeking); ++step, ++made) {
    meet(window, Apart<side>{step->offset}, Apart<side>{step[step == begin ? 0 : -1].offset}, Numbers(step->low),
         Numbers(step->high), gap, weight, found.seeking, found);
  }
  if (!any(found.seeking)) return made;
  end_partly(found);
  end_in_void(window, Apart<side>{last}, weight, found.seeking, found);
  for (const Step* step = end; step-- != begin && any(found.seeking);) {
    guess(window, Apart<side>{step->offset}, Numbers(step->low), weight, found.seeking, found);
  }
  give_up(weight, found);
  return made;
}

/// Follows the rays of `at_once` rows of pixels `side` columns apart. In most cases all pixels meet the first layer in
/// the same step and need no masks.
template <int side, bool opaque, int colours, int at_once>
std::uint64_t follow_rows(const TileJob& job, const SameRays& rays, int row, int column) noexcept {
  LayerWindow windows[at_once];
  for (int r = 0; r < at_once; ++r) windows[r] = job.window.from((row + r) * side, column * side);
  const Mask lanes = first_lanes(static_cast<std::size_t>(job.columns - column));
  const bool full = opaque && every(lanes);
  GatherState<opaque, colours> found[at_once];
  Numbers total(0.0f);
  const Numbers gap(job.gap);
  std::uint64_t made = 0;
  for (std::size_t i = 0; i < rays.count; ++i) {
    const Step *const begin = rays.steps + rays.first[i], *const end = rays.steps + rays.first[i + 1], *step = begin;
    const Numbers weight(rays.weights[i]);
    total = total + weight;
    bool met = false;
    for (; full && step != end; ++step) {
      const Numbers low(step->low), high(step->high);
      Mask all = lanes, reached = first_lanes(0);
      for (int r = 0; r < at_once; ++r) {
        const Numbers w = Apart<side>{step->offset}(windows[r].depth);
        const Mask here = w >= low;
        reached = reached | here, all = all_of(all, here, w <= high);
      }
      if (every(all)) {
        for (int r = 0; r < at_once; ++r) {
          const Colours<colours> colour(windows[r], Apart<side>{step->offset}, 0);
          for (int c = 0; c < colours; ++c) found[r].colour[c] = found[r].colour[c] + weight * colour.of[c];
        }
        met = true;
        break;
      }
      if (any(reached)) break;
    }
    made += static_cast<std::uint64_t>(at_once) * static_cast<std::uint64_t>(step - begin + met);
    if (met) continue;
    for (int r = 0; r < at_once; ++r)
      made += follow_ray<side>(windows[r], begin, step, end, rays.ends[i], gap, weight, lanes, found[r]);
  }
  for (int r = 0; r < at_once; ++r) {
    keep(*job.sums, job.first_sum + (row + r) * TileSums::columns + column, found[r], total);
  }
  return made;
}

template <int side, bool opaque, int colours>
std::uint64_t follow_sets(const TileJob& job, const SameRays& rays) noexcept {
  constexpr int at_once = width == 16 ? 4 : 2;
  std::uint64_t made = 0;
  for (int column = 0; column < job.columns; column += width) {
    int row = 0;
    for (; row + at_once <= job.rows; row += at_once) {
      made += follow_rows<side, opaque, colours, at_once>(job, rays, row, column);
    }
    for (; row < job.rows; ++row) made += follow_rows<side, opaque, colours, 1>(job, rays, row, column);
  }
  return made * static_cast<std::uint64_t>(width);
}

template <bool opaque, int colours>
std::uint64_t follow_same(const TileJob& job, const SameRays& rays) noexcept {
  switch (job.side) {
    case 1: return follow_sets<1, opaque, colours>(job, rays);
    case 2: return follow_sets<2, opaque, colours>(job, rays);
    default: return follow_sets<4, opaque, colours>(job, rays);
  }
}

Limits limits(const float* const* corners, std::size_t corner_count, std::size_t stride, std::size_t count, float w,
              float v) noexcept {
  const auto smaller = [](Numbers a, Numbers b) { return select(a < b, a, b); };
  const auto larger = [](Numbers a, Numbers b) { return select(a > b, a, b); };
  Numbers least_x(1e9f), most_x(-1e9f), least_y(1e9f), most_y(-1e9f);
  for (std::size_t c = 0; c < corner_count; ++c) {
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(width)) {
      // The last lanes repeat earlier rays, or are masked if there are fewer rays than lanes.
      const std::size_t from = i + static_cast<std::size_t>(width) <= count ? i
                               : count < static_cast<std::size_t>(width)    ? 0
                                                                            : count - static_cast<std::size_t>(width);
      const Mask lanes = first_lanes(count - from);
      const float* const rows = corners[c] + from;
      const Numbers x = load(rows + at_x * stride), y = load(rows + at_y * stride),
                    run_x = load(rows + slope_x * stride), run_y = load(rows + slope_y * stride);
      for (const float depth : {w, v}) {
        const Numbers at(depth), px = x + at * run_x, py = y + at * run_y;
        least_x = select(lanes, smaller(least_x, px), least_x), most_x = select(lanes, larger(most_x, px), most_x);
        least_y = select(lanes, smaller(least_y, py), least_y), most_y = select(lanes, larger(most_y, py), most_y);
      }
    }
  }
  Limits result{1e9f, -1e9f, 1e9f, -1e9f};
  for (int i = 0; i < width; ++i) {
    result.left = least_x.v[i] < result.left ? least_x.v[i] : result.left;
    result.right = most_x.v[i] > result.right ? most_x.v[i] : result.right;
    result.top = least_y.v[i] < result.top ? least_y.v[i] : result.top;
    result.bottom = most_y.v[i] > result.bottom ? most_y.v[i] : result.bottom;
  }
  return result;
}

/// Offsets for differences of columns and rows.
PETZVAL_INLINE PixelIndices offsets_of(Numbers column, Numbers row, std::ptrdiff_t stride) noexcept {
  return __builtin_convertvector(row.v, PixelIndices) * static_cast<std::int32_t>(stride) +
         __builtin_convertvector(column.v, PixelIndices);
}

/// Offsets of the pixels that lines pass at an inverse depth.
PETZVAL_INLINE PixelIndices pixels_at(const Numbers (&line)[row_count], Numbers w, std::ptrdiff_t stride) noexcept {
  const Numbers half(0.5f);
  return offsets_of(WholePixel<Numbers>::below(line[at_x] + line[slope_x] * w + half),
                    WholePixel<Numbers>::below(line[at_y] + line[slope_y] * w + half), stride);
}

/// Follows the rays of the lanes to their ends.
/// @param load calls visit(at, before, here) for all given lanes, where `at` and `before` load the planes at two lists
///   of offsets
/// @return the number of steps of the longest ray
template <bool opaque, int colours, class Load>
PETZVAL_INLINE std::uint64_t follow(const LayerWindow& window, const DifferentRays& rays, float gap,
                                    const Numbers (&line)[row_count], const Load& load,
                                    GatherState<opaque, colours>& found) noexcept {
  const PixelSteps<Numbers> steps(line[at_x], line[at_y], line[slope_x], line[slope_y], Numbers(rays.from),
                                  Numbers(rays.to), Numbers(rays.end), Numbers(rays.most));
  const Numbers seen = line[weight], zero(0.0f), one(1.0f);
  const auto pixels_of = [&](Numbers n) {
    const auto pixel = steps.pixel(n);
    return offsets_of(pixel.column, pixel.row, window.stride);
  };
  std::uint64_t made = 0;
  Numbers n = zero, high = steps.low(-one);
  PixelIndices pixels = pixels_of(n), pixels_before = pixels;
  for (Mask here = found.seeking; any(here); here = all_of(found.seeking, n <= steps.last()), ++made) {
    const Numbers low = larger(steps.low(n), zero);
    load(pixels, pixels_before, here, [&](const auto& at, const auto& before, Mask lanes) {
      meet(window, at, before, low, high, Numbers(gap), seen, lanes, found);
    });
    n = n + one, high = low, pixels_before = pixels, pixels = pixels_of(n);
  }
  if (!any(found.seeking)) return made;
  end_partly(found);
  const PixelIndices ends = pixels_at(line, Numbers(rays.end), window.stride);
  load(ends, ends, found.seeking,
       [&](const auto& at, const auto&, Mask lanes) { end_in_void(window, at, seen, lanes, found); });
  n = steps.last();
  for (Mask here = found.seeking; any(here); here = all_of(found.seeking, n >= zero)) {
    const Numbers low = larger(steps.low(n), zero);
    pixels = pixels_of(n);
    load(pixels, pixels, here,
         [&](const auto& at, const auto&, Mask lanes) { guess(window, at, low, seen, lanes, found); });
    n = n - one;
  }
  give_up(seen, found);
  return made;
}

/// The lanes equal to a number.
PETZVAL_INLINE Mask lanes_of(PixelIndices numbers, std::int32_t number) noexcept {
#if defined(__AVX512F__)
  return {_mm512_cmpeq_epi32_mask(reinterpret_cast<__m512i>(numbers), _mm512_set1_epi32(number))};
#else
  return {numbers == number};
#endif
}

/// Pixels of adjacent lanes. In most cases all lanes have equal offsets from their own pixels, and one load suffices.
template <class Visit>
PETZVAL_INLINE void load_adjacent(PixelIndices offsets, PixelIndices before, Mask lanes, const Visit& visit) noexcept {
  const std::int32_t first = offsets[0], first_before = before[0];
  const Mask equal_offsets = all_of(lanes_of(offsets, first), lanes_of(before, first_before));
  if (!any(without(lanes, equal_offsets))) return visit(AdjacentPixels{first}, AdjacentPixels{first_before}, lanes);
  PixelIndices own;
  for (int i = 0; i < width; ++i) own[i] = i;
  visit(Anywhere{offsets + own, lanes}, Anywhere{before + own, lanes}, lanes);
}

template <bool opaque, int colours>
std::uint64_t follow_coherent(const TileJob& job, const DifferentRays& rays) noexcept {
  std::uint64_t made = 0;
  Numbers lane;
  for (int i = 0; i < width; ++i) lane.v[i] = static_cast<float>(i) + 0.5f;
  const std::size_t numbers = row_count * rays.row_stride;
  float *const left = rays.scratch, *const rise = rays.scratch + numbers;  // values of a row, and change per column
  for (int row = 0; row < job.rows; ++row) {
    const float down = (static_cast<float>(row) + 0.5f) / static_cast<float>(job.rows);
    const float per_column = 1 / static_cast<float>(job.columns);
    for (std::size_t i = 0; i < numbers; ++i) {
      left[i] = rays.corners[0][i] + down * (rays.corners[2][i] - rays.corners[0][i]);
      rise[i] = (rays.corners[1][i] + down * (rays.corners[3][i] - rays.corners[1][i]) - left[i]) * per_column;
    }
    for (int column = 0; column < job.columns; column += width) {
      const Numbers lane_column = lane + Numbers(static_cast<float>(column));
      const LayerWindow window = job.window.from(row, column);
      const Mask lanes = first_lanes(static_cast<std::size_t>(job.columns - column));
      GatherState<opaque, colours> found;
      Numbers total(0.0f);
      for (std::size_t i = 0; i < rays.count; ++i) {
        Numbers line[row_count];
        for (std::size_t r = 0; r < row_count; ++r) {
          const std::size_t at = r * rays.row_stride + i;
          line[r] = Numbers(left[at]) + lane_column * Numbers(rise[at]);
        }
        found.begin_ray(lanes);
        const auto load_pixels = [&](PixelIndices offsets, PixelIndices before, Mask here, const auto& visit) {
          load_adjacent(offsets, before, here, visit);
        };
        made += follow(window, rays, job.gap, line, load_pixels, found);
        total = total + line[weight];
      }
      keep(*job.sums, row * TileSums::columns + column, found, total);
    }
  }
  return made * static_cast<std::uint64_t>(width);
}

template <bool opaque, int colours>
std::uint64_t follow_general(const TileJob& job, const DifferentRays& rays) noexcept {
  TileSums& sums = *job.sums;
  std::uint64_t made = 0;
  const auto sets = static_cast<std::size_t>(rays.side * rays.side);
  for (std::size_t set = 0; set < sets; ++set) {
    for (std::size_t begin = 0; begin < rays.count; begin += static_cast<std::size_t>(width)) {
      const Mask lanes = first_lanes(rays.count - begin);
      Numbers corner[4][row_count];
      for (int c = 0; c < 4; ++c) {
        for (std::size_t r = 0; r < row_count; ++r) {
          corner[c][r] = only(lanes, load(rays.corners[c] + r * rays.row_stride + set * rays.count + begin));
        }
      }
      for (int row = 0; row < job.rows; ++row) {
        const Numbers down((static_cast<float>(row) + 0.5f) / static_cast<float>(job.rows));
        for (int column = 0; column < job.columns; ++column) {
          if (set_of(job.left + column, job.top + row, rays.side) != set) continue;
          const Numbers across((static_cast<float>(column) + 0.5f) / static_cast<float>(job.columns));
          Numbers line[row_count];
          for (std::size_t r = 0; r < row_count; ++r) {
            const Numbers from = corner[0][r] + down * (corner[2][r] - corner[0][r]),
                          to = corner[1][r] + down * (corner[3][r] - corner[1][r]);
            line[r] = from + across * (to - from);
          }
          const LayerWindow window = job.window.from(row, column);
          GatherState<opaque, colours> found(lanes);
          const auto load_pixels = [&](PixelIndices offsets, PixelIndices before, Mask here, const auto& visit) {
            visit(Anywhere{offsets, here}, Anywhere{before, here}, here);
          };
          made += follow(window, rays, job.gap, line, load_pixels, found);
          const int pixel = row * TileSums::columns + column;
          for (int c = 0; c < colours; ++c) sums.colour[c][pixel] += sum_of(found.colour[c]);
          if constexpr (!opaque) sums.alpha[pixel] += sum_of(found.alpha);
          sums.total[pixel] += sum_of(line[weight]);
          sums.open[pixel] += sum_of(found.open);
          sums.missed[pixel] += sum_of(found.missed);
          sums.unknown[pixel] += sum_of(found.unknown);
        }
      }
    }
  }
  return made * static_cast<std::uint64_t>(width);
}

void transmit(const LayerWindow& window, const DifferentRays& rays, float gap, const Limits& pixels,
              float* fractions) noexcept {
  const Numbers none(no_surface), one(1.0f), to(rays.to);
  const auto within = [](Numbers x, float least, float most) {
    const Numbers above = larger(x, Numbers(least));
    return select(above > Numbers(most), Numbers(most), above);
  };
  for (std::size_t i = 0; i < rays.count; i += static_cast<std::size_t>(width)) {
    const auto row = [&](Row r) { return load(rays.corners[0] + r * rays.row_stride + i); };
    const PixelSteps<Numbers> steps(row(at_x), row(at_y), row(slope_x), row(slope_y), Numbers(rays.from), to,
                                    Numbers(rays.end), Numbers(rays.most));
    Numbers through = one, front = none, front_alpha(0.0f), n(0.0f), high = steps.low(-one);
    for (Mask here = first_lanes(rays.count - i); any(here);
         here = all_of(here, n <= steps.last(), through > Numbers(1e-3f))) {
      const auto pixel = steps.pixel(n);
      const Anywhere at{offsets_of(within(pixel.column, pixels.left, pixels.right),
                                   within(pixel.row, pixels.top, pixels.bottom), window.stride),
                        here};
      const Numbers low = steps.low(n), joined_alpha = front_alpha;
      Numbers joined_to = front + Numbers(gap);
      front = none;
      Mask behind = here;  // lanes whose rays are behind the layers so far
      for (int l = 0; l < window.layers; ++l) {
        const Numbers met = at(window.depth + l * window.layer_stride);
        behind = all_of(behind, met > to);
        if (!any(behind)) break;
        const Numbers alpha = window.alpha ? at(window.alpha + l * window.layer_stride) : one;
        const Mask in_front = all_of(behind, met < low);
        front = select(in_front, met, front), front_alpha = select(in_front, alpha, front_alpha);
        behind = without(behind, in_front);
        const Mask hit = all_of(behind, met <= high), joined = all_of(behind, met > high, met <= joined_to);
        through = through * (one - select(hit, alpha, select(joined, joined_alpha, Numbers(0.0f))));
        joined_to = select(joined, none, joined_to);
      }
      n = n + one, high = low;
    }
    store(fractions + i, through);
  }
}

#define PETZVAL_FOLLOW(name, Rays)                                                                     \
  std::uint64_t name(const TileJob& job, const Rays& rays) noexcept {                                  \
    if (job.opaque) {                                                                                  \
      return job.colours == 3 ? follow_##name<true, 3>(job, rays) : follow_##name<true, 1>(job, rays); \
    }                                                                                                  \
    return job.colours == 3 ? follow_##name<false, 3>(job, rays) : follow_##name<false, 1>(job, rays); \
  }
PETZVAL_FOLLOW(same, SameRays)
PETZVAL_FOLLOW(coherent, DifferentRays)
PETZVAL_FOLLOW(general, DifferentRays)

}  // namespace

extern const GatherLoops PETZVAL_LOOPS;
const GatherLoops PETZVAL_LOOPS{same, coherent, general, limits, transmit};

}  // namespace petzval::blur_detail
