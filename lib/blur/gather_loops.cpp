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
PETZVAL_INLINE Numbers only(Mask mask, Numbers numbers) noexcept { return select(mask, numbers, Numbers(0.0f)); }

PETZVAL_INLINE Mask first_lanes(std::size_t count) noexcept {
  Numbers lane;
  for (int i = 0; i < width; ++i) lane.v[i] = static_cast<float>(i);
  return lane < Numbers(static_cast<float>(count));
}

PETZVAL_INLINE int smaller_of(int a, int b) noexcept { return a < b ? a : b; }

/// Loads every side-th number of `side` rows.
template <int side, int... lanes>
PETZVAL_INLINE Numbers load_rows(const float* from, const std::ptrdiff_t* rows,
                                 std::integer_sequence<int, lanes...> all) noexcept {
  if constexpr (side == 1) {
    return load(from + *rows);
  } else {
    const Numbers a = load_rows<side / 2>(from, rows, all), b = load_rows<side / 2>(from, rows + side / 2, all);
    return Numbers(__builtin_shufflevector(a.v, b.v, (2 * lanes)...));
  }
}

/// Loads the pixels of a Register, all at the same offset.
template <int side>
struct Together {
  const std::ptrdiff_t* rows;
  std::ptrdiff_t offset;

  PETZVAL_INLINE Numbers operator()(const float* plane) const noexcept {
    return load_rows<side>(plane + offset, rows, std::make_integer_sequence<int, width>{});
  }
};

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

Limits limits(const float* const* corners, std::size_t corner_count, std::size_t stride, std::size_t count, float w,
              float v) noexcept {
  const auto smaller = [](Numbers a, Numbers b) { return select(a < b, a, b); };
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
PETZVAL_INLINE std::uint64_t follow(const LayerWindow& window, const TileRays& rays, float gap,
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

/// The lines of a tile's rays at a position in the tile, in fractions of the tile: bilinear between the corners.
class Lines {
 public:
  explicit Lines(const TileRays& rays) noexcept : padded_(rays.padded()), numbers_(rays.scratch) {
    const auto lanes = static_cast<std::size_t>(width);
    for (std::size_t r = 0; r < row_count; ++r) {
      for (std::size_t i = 0; i < rays.row_stride; i += lanes) {
        const auto corner = [&](int c) { return load(rays.corners[c] + r * rays.row_stride + i); };
        const Numbers across = corner(1) - corner(0), down = corner(2) - corner(0);
        store(numbers_ + (0 * row_count + r) * padded_ + i, corner(0));
        store(numbers_ + (1 * row_count + r) * padded_ + i, across);
        store(numbers_ + (2 * row_count + r) * padded_ + i, down);
        store(numbers_ + (3 * row_count + r) * padded_ + i, corner(3) - corner(2) - across);
        if (r != weight) continue;
        const Numbers none(0.0f), change = size_of(across) + size_of(down) + size_of(corner(3) - corner(0));
        even_weights_ &= !any(all_of(change > none, first_lanes(rays.row_stride - i)));
      }
    }
  }

  /// A row of the lines of adjacent rays at one position.
  PETZVAL_INLINE Numbers of_rays(std::size_t row, std::size_t ray, Numbers across, Numbers down) const noexcept {
    return sum([&](int c) { return load(at(c, row, ray)); }, across, down);
  }
  /// A row of the lines of one ray at the positions of the lanes.
  PETZVAL_INLINE Numbers of_ray(std::size_t row, std::size_t ray, Numbers across, Numbers down) const noexcept {
    return sum([&](int c) { return Numbers(*at(c, row, ray)); }, across, down);
  }
  PETZVAL_INLINE Numbers weight_of(std::size_t ray, Numbers across, Numbers down) const noexcept {
    return even_weights_ ? Numbers(*at(0, weight, ray)) : of_ray(weight, ray, across, down);
  }
  /// The largest change of lines of adjacent rays, at an inverse depth, over half of an area of the tile, px.
  PETZVAL_INLINE Numbers change(std::size_t ray, Numbers w, Numbers half_across, Numbers half_down) const noexcept {
    const auto along = [&](Row position, Row slope) {
      const auto by = [&](int c) { return size_of(load(at(c, position, ray)) + w * load(at(c, slope, ray))); };
      const Numbers by_both = by(3);
      return half_across * (by(1) + by_both) + half_down * (by(2) + by_both);
    };
    return larger(along(at_x, slope_x), along(at_y, slope_y));
  }

 private:
  template <class Coefficient>
  static PETZVAL_INLINE Numbers sum(const Coefficient& coefficient, Numbers across, Numbers down) noexcept {
    return coefficient(0) + across * coefficient(1) + down * (coefficient(2) + across * coefficient(3));
  }
  PETZVAL_INLINE const float* at(int coefficient, std::size_t row, std::size_t ray) const noexcept {
    return numbers_ + (static_cast<std::size_t>(coefficient) * row_count + row) * padded_ + ray;
  }

  std::size_t padded_;
  float* numbers_;
  bool even_weights_ = true;  ///< equal at all corners
};

/// An integer that was stored among numbers.
PETZVAL_INLINE std::int32_t integer_at(const float* from) noexcept {
  std::int32_t result;
  __builtin_memcpy(&result, from, sizeof result);
  return result;
}

/// The steps of the line at the middle of a block. In step n, from 0, the ray passes the pixel at offset(n) from its
/// own pixel, in the range of inverse depths from low(n) >= 0 to low(n - 1).
struct Steps {
  static constexpr int numbers_of_step = 3;
  const float* numbers;  ///< `width` offsets, lows and sure lows of adjacent rays for each step, from -1
  int count;
  bool sure;  ///< the line serves all pixels of the block

  PETZVAL_INLINE std::ptrdiff_t offset(int n) const noexcept { return integer_at(at(n, 0)); }
  PETZVAL_INLINE float low(int n) const noexcept { return *at(n, 1); }
  /// Surfaces from sure_low(n) to sure_high(n) are met in step n by the lines of all pixels, those below sure_high(n +
  /// 1) in a later step.
  PETZVAL_INLINE float sure_low(int n) const noexcept { return *at(n, 2); }
  PETZVAL_INLINE float sure_high(int n) const noexcept { return *at(n - 1, 1); }

 private:
  PETZVAL_INLINE const float* at(int n, int number) const noexcept {
    return numbers + ((n + 1) * numbers_of_step + number) * width;
  }
};

/// The steps of all rays of a set in a block.
class BlockSteps {
 public:
  explicit BlockSteps(const TileRays& rays) noexcept
      : groups_(rays.excess() + rays.padded()),
        excess_(rays.excess()),
        capacity_(TileRays::numbers_of_ray(rays.most_steps)) {}

  /// @param first the first ray of the set
  /// @param across, down the middle of the block
  PETZVAL_INLINE void make(const TileJob& job, const TileRays& rays, const Lines& lines, std::size_t first,
                           float across, float down) noexcept {
    const auto lanes = static_cast<std::size_t>(width);
    const std::ptrdiff_t stride = job.window.stride;
    for (std::size_t i = 0; i < rays.count; i += lanes) {
      Numbers line[row_count];
      const Mask used = first_lanes(rays.count - i);
      for (std::size_t r = 0; r < row_count; ++r)
        line[r] = only(used, lines.of_rays(r, first + i, Numbers(across), Numbers(down)));
      const PixelSteps<Numbers> steps(line[at_x], line[at_y], line[slope_x], line[slope_y], Numbers(rays.from),
                                      Numbers(rays.to), Numbers(rays.end), Numbers(rays.most));
      float* to = groups_ + i * capacity_;
      const auto put = [&](const auto& numbers) {
        __builtin_memcpy(to, &numbers, sizeof numbers);
        to += width;
      };
      put(__builtin_convertvector(steps.last().v, PixelIndices) + 1);
      put(pixels_at(line, Numbers(rays.end), stride));
      const Numbers excess = load(excess_ + first + i), unsure = excess * steps.length();
      const Numbers one(1.0f), none(0.0f);
      const auto put_lows = [&](Numbers low, Mask sure) {
        put(larger(low - unsure, none)), put(select(sure, larger(low + unsure, none), Numbers(1e30f)));
      };
      put(Numbers(0.0f)), put_lows(steps.low(-one), used);
      for (Numbers n(0.0f); any(n <= steps.last()); n = n + one) {
        const auto pixel = steps.pixel(n);
        put(offsets_of(pixel.column, pixel.row, stride));
        const Numbers margin = larger(excess, -one);
        put_lows(steps.low(n), all_of(pixel.beyond >= margin, pixel.beyond <= one - margin));
      }
    }
  }

  PETZVAL_INLINE Steps of(std::size_t ray, std::size_t first) const noexcept {
    return {group(ray) + 2 * width, integer_at(group(ray)), !(excess_[first + ray] > 0)};
  }
  /// Offset of the pixel at the depth of the farthest surface.
  PETZVAL_INLINE std::ptrdiff_t end(std::size_t ray) const noexcept { return integer_at(group(ray) + width); }

 private:
  PETZVAL_INLINE const float* group(std::size_t ray) const noexcept {
    const std::size_t lane = ray % static_cast<std::size_t>(width);
    return groups_ + (ray - lane) * capacity_ + lane;
  }

  float *groups_, *excess_;
  std::size_t capacity_;  ///< numbers for each ray
};

/// Pixels of one set in the lanes of a register: `side` rows of width / side pixels, each `side` pixels apart.
template <int side>
struct Register {
  static constexpr int in_row = width / side;

  LayerWindow window;         ///< at the first pixel
  std::ptrdiff_t rows[side];  ///< offsets of the rows; rows below the tile have the offset of its last row
  PixelIndices own;           ///< offsets of all pixels
  Numbers across, down;       ///< positions in the tile
  Mask lanes;                 ///< pixels in the tile
  int first;                  ///< index in TileSums

  Register() = default;
  PETZVAL_INLINE Register(const TileJob& job, int row, int column) noexcept
      : window(job.window.from(row, column)), first(row * TileSums::columns + column) {
    for (int r = 0; r < side; ++r) {
      rows[r] = row + r * side < job.rows ? r * side * window.stride : r == 0 ? 0 : rows[r - 1];
    }
    Numbers x, y;
    for (int l = 0; l < width; ++l) {
      x.v[l] = static_cast<float>(column + l % in_row * side) + 0.5f;
      y.v[l] = static_cast<float>(row + l / in_row * side) + 0.5f;
      own[l] = static_cast<std::int32_t>(rows[l / in_row]) + l % in_row * side;
    }
    const Numbers columns(static_cast<float>(job.columns)), all_rows(static_cast<float>(job.rows));
    lanes = all_of(x < columns, y < all_rows);
    across = x / columns, down = y / all_rows;
  }

  PETZVAL_INLINE Together<side> at(std::ptrdiff_t offset) const noexcept { return {rows, offset}; }

  /// Stores the results.
  template <bool opaque, int colours>
  PETZVAL_INLINE void keep(TileSums& sums, const GatherState<opaque, colours>& found, Numbers total) const noexcept {
    const auto put = [&](float* plane, Numbers numbers) {
      if constexpr (side == 1) {
        store(plane + first, numbers);
      } else {
        for (int l = 0; l < width; ++l)
          plane[first + l / in_row * side * TileSums::columns + l % in_row * side] = numbers.v[l];
      }
    };
    for (int c = 0; c < colours; ++c) put(sums.colour[c], found.colour[c]);
    put(sums.total, total);
    if constexpr (!opaque) put(sums.alpha, found.alpha);
    put(sums.open, found.open), put(sums.missed, found.missed), put(sums.unknown, found.unknown);
  }
};

/// Follows one line of all pixels of a register, starting at the step `from`.
template <int side, bool opaque, int colours>
PETZVAL_INLINE std::uint64_t follow_steps(const Register<side>& pixels, const Steps& steps, int from,
                                          std::ptrdiff_t last, Numbers gap, Numbers weight,
                                          GatherState<opaque, colours>& found) noexcept {
  const LayerWindow& window = pixels.window;
  found.begin_ray(pixels.lanes);
  // In the previous step, all pixels passed in front of the first layer.
  if (from > 0) found.front = in_front(pixels.at(steps.offset(from - 1))(window.depth));
  std::uint64_t made = 0;
  for (int n = from; n < steps.count && any(found.seeking); ++n, ++made) {
    meet(window, pixels.at(steps.offset(n)), pixels.at(steps.offset(n > 0 ? n - 1 : 0)), Numbers(steps.low(n)),
         Numbers(steps.low(n - 1)), gap, weight, found.seeking, found);
  }
  if (!any(found.seeking)) return made;
  end_partly(found);
  end_in_void(window, pixels.at(last), weight, found.seeking, found);
  for (int n = steps.count; n-- > 0 && any(found.seeking);) {
    guess(window, pixels.at(steps.offset(n)), Numbers(steps.low(n)), weight, found.seeking, found);
  }
  give_up(weight, found);
  return made;
}

/// Follows a ray for which each pixel of a register has a line of its own.
template <int side, bool opaque, int colours>
PETZVAL_INLINE std::uint64_t follow_lines(const Register<side>& pixels, const TileRays& rays, float gap,
                                          const Lines& lines, std::size_t ray,
                                          GatherState<opaque, colours>& found) noexcept {
  Numbers line[row_count];
  for (std::size_t r = 0; r < row_count; ++r) line[r] = lines.of_ray(r, ray, pixels.across, pixels.down);
  found.begin_ray(pixels.lanes);
  // In most cases all pixels have equal offsets.
  const auto load_pixels = [&](PixelIndices offsets, PixelIndices before, Mask here, const auto& visit) {
    const std::int32_t first = offsets[0], first_before = before[0];
    const Mask equal_offsets = all_of(lanes_of(offsets, first), lanes_of(before, first_before));
    if (!any(without(here, equal_offsets))) return visit(pixels.at(first), pixels.at(first_before), here);
    visit(Anywhere{offsets + pixels.own, here}, Anywhere{before + pixels.own, here}, here);
  };
  return follow(pixels.window, rays, gap, line, load_pixels, found);
}

/// Follows the rays of some registers of a block. In most cases all pixels meet the first layer in the same step and
/// need no masks. Otherwise, pixels follow their own lines if the line of the block does not serve all pixels.
template <int side, bool opaque, int colours, int at_once>
std::uint64_t follow_registers(const TileJob& job, const TileRays& rays, const Lines& lines, const BlockSteps& block,
                               std::size_t first_ray, const Register<side>* registers) noexcept {
  bool full = opaque;
  for (int r = 0; r < at_once; ++r) full &= every(registers[r].lanes);
  GatherState<opaque, colours> found[at_once];
  Numbers total[at_once];
  for (Numbers& t : total) t = Numbers(0.0f);
  const Numbers gap(job.gap);
  std::uint64_t made = 0;
  for (std::size_t i = 0; i < rays.count; ++i) {
    const std::size_t ray = first_ray + i;
    Numbers weights[at_once];
    for (int r = 0; r < at_once; ++r) {
      weights[r] = lines.weight_of(ray, registers[r].across, registers[r].down);
      total[r] = total[r] + weights[r];
    }
    const Steps steps = block.of(i, first_ray);
    int n = 0;
    bool met = false;
    for (; full && n < steps.count; ++n) {
      const Numbers low(steps.low(n)), sure_low(steps.sure_low(n)), high(steps.sure_high(n));
      const std::ptrdiff_t offset = steps.offset(n);
      Mask all = first_lanes(width), reached = first_lanes(0);
      for (int r = 0; r < at_once; ++r) {
        const Numbers w = registers[r].at(offset)(registers[r].window.depth);
        reached = reached | (w >= low), all = all_of(all, w >= sure_low, w <= high);
      }
      if (every(all)) {
        for (int r = 0; r < at_once; ++r) {
          const Colours<colours> colour(registers[r].window, registers[r].at(offset), 0);
          for (int c = 0; c < colours; ++c) found[r].colour[c] = found[r].colour[c] + weights[r] * colour.of[c];
        }
        met = true;
        break;
      }
      if (any(reached)) break;
    }
    made += static_cast<std::uint64_t>(at_once) * static_cast<std::uint64_t>(n + met);
    if (met) continue;
    for (int r = 0; r < at_once; ++r) {
      made += steps.sure ? follow_steps(registers[r], steps, n, block.end(i), gap, weights[r], found[r])
                         : follow_lines(registers[r], rays, job.gap, lines, ray, found[r]);
    }
  }
  for (int r = 0; r < at_once; ++r) registers[r].keep(*job.sums, found[r], total[r]);
  return made;
}

/// Measures by how much the lines of a block differ from the line at its middle, beyond the tolerance.
/// @return true if the lines of any ray do
PETZVAL_INLINE bool measure_excess(const TileJob& job, const TileRays& rays, const Lines& lines, int columns,
                                   int rows) noexcept {
  const auto half_of = [](int length, int all) {
    return Numbers(0.5f * static_cast<float>(length < all ? length - 1 : length) / static_cast<float>(all));
  };
  const Numbers half_across = half_of(columns, job.columns), half_down = half_of(rows, job.rows), none(0.0f);
  bool differ = false;
  for (std::size_t i = 0; i < rays.row_stride; i += static_cast<std::size_t>(width)) {
    Numbers beyond = none;
    for (const auto& [depth, px] : rays.tolerances)
      beyond = larger(beyond, lines.change(i, Numbers(depth), half_across, half_down) - Numbers(px));
    store(rays.excess() + i, beyond);
    differ |= any(all_of(beyond > none, first_lanes(rays.row_stride - i)));
  }
  return differ;
}

/// Follows the rays of a tile block by block. Blocks are as large as the tolerance permits; the tile is one block if
/// its lines differ nowhere, as for thin lenses.
template <int side, bool opaque, int colours>
std::uint64_t follow_sets(const TileJob& job, const TileRays& rays) noexcept {
  constexpr int at_once = width == 16 ? 4 : 2;
  const Lines lines(rays);
  int columns = job.columns, rows = job.rows;
  while (measure_excess(job, rays, lines, columns, rows)) {
    if (columns > width && (columns > rows || rows <= 4 * side))
      columns = (columns / 2 + width - 1) / width * width;
    else if (rows > 4 * side)
      rows = (rows / 2 + side * side - 1) / (side * side) * (side * side);
    else
      break;
  }
  BlockSteps block(rays);
  std::uint64_t made = 0;
  for (int set = 0; set < side * side; ++set) {
    const int row = ((set / side - job.top) % side + side) % side,
              column = ((set % side - job.left) % side + side) % side;
    const std::size_t first_ray = static_cast<std::size_t>(set) * rays.count;
    for (int top = 0; top < job.rows; top += rows) {
      for (int left = 0; left < job.columns; left += columns) {
        const auto middle = [](int begin, int length, int all) {
          return (static_cast<float>(begin) + 0.5f * static_cast<float>(smaller_of(length, all - begin))) /
                 static_cast<float>(all);
        };
        block.make(job, rays, lines, first_ray, middle(left, columns, job.columns), middle(top, rows, job.rows));
        Register<side> registers[at_once];
        int waiting = 0;
        const auto follow_waiting = [&] {
          if (waiting == at_once) {
            made += follow_registers<side, opaque, colours, at_once>(job, rays, lines, block, first_ray, registers);
          } else {
            for (int r = 0; r < waiting; ++r)
              made += follow_registers<side, opaque, colours, 1>(job, rays, lines, block, first_ray, registers + r);
          }
          waiting = 0;
        };
        for (int c = left; c < smaller_of(left + columns, job.columns); c += width) {
          for (int r = top; r < smaller_of(top + rows, job.rows); r += side * side) {
            if (r + row >= job.rows || c + column >= job.columns) continue;
            registers[waiting++] = Register<side>(job, r + row, c + column);
            if (waiting == at_once) follow_waiting();
          }
        }
        follow_waiting();
      }
    }
  }
  return made * static_cast<std::uint64_t>(width);
}

template <bool opaque, int colours>
std::uint64_t follow_tile(const TileJob& job, const TileRays& rays) noexcept {
  switch (rays.side) {
    case 1: return follow_sets<1, opaque, colours>(job, rays);
    case 2: return follow_sets<2, opaque, colours>(job, rays);
    default: return follow_sets<4, opaque, colours>(job, rays);
  }
}

void transmit(const LayerWindow& window, const TileRays& rays, float gap, const Limits& pixels,
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

std::uint64_t follow(const TileJob& job, const TileRays& rays) noexcept {
  if (job.opaque) return job.colours == 3 ? follow_tile<true, 3>(job, rays) : follow_tile<true, 1>(job, rays);
  return job.colours == 3 ? follow_tile<false, 3>(job, rays) : follow_tile<false, 1>(job, rays);
}

}  // namespace

extern const GatherLoops PETZVAL_LOOPS;
const GatherLoops PETZVAL_LOOPS{follow, limits, transmit};

}  // namespace petzval::blur_detail
