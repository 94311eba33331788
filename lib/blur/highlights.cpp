// SPDX-License-Identifier: Apache-2.0
#include "highlights.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "core/low_discrepancy.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::blur_detail {
namespace {

constexpr std::size_t least_rays = 64, most_rays = 16384;  // per stamp
constexpr double rays_of_pixel = 2.5;
constexpr int group_cell = 16;  // px

std::size_t dense_rays(double area) {
  return static_cast<std::size_t>(std::clamp<double>(rays_of_pixel * area, least_rays, most_rays));
}

/// The area covered by the lines of a node at an inverse depth, from an ellipse with the same moments.
class CoveredArea {
 public:
  CoveredArea(const float* rows, std::size_t rays) {
    const auto mean = [&](auto&& number) {
      double sum = 0;
      for (std::size_t i = 0; i < rays; ++i) sum += number(i);
      return sum / static_cast<double>(rays);
    };
    const auto column = [&](Row r) { return [=](std::size_t i) { return static_cast<double>(rows[r * rays + i]); }; };
    const auto covariance = [&](Row a, Row b) {
      return mean([&](std::size_t i) { return column(a)(i) * column(b)(i); }) - mean(column(a)) * mean(column(b));
    };
    const auto along = [&](Row a, Row b, Row sa, Row sb) {
      return Quadratic{covariance(a, b), covariance(a, sb) + covariance(sa, b), covariance(sa, sb)};
    };
    xx_ = along(at_x, at_x, slope_x, slope_x), yy_ = along(at_y, at_y, slope_y, slope_y);
    xy_ = along(at_x, at_y, slope_x, slope_y);
  }

  double at(double w) const noexcept {
    const double determinant = xx_.at(w) * yy_.at(w) - xy_.at(w) * xy_.at(w);
    return 4 * std::numbers::pi * std::sqrt(std::max(determinant, 0.0));
  }

 private:
  struct Quadratic {
    double c0 = 0, c1 = 0, c2 = 0;
    double at(double w) const noexcept { return c0 + w * (c1 + w * c2); }
  };
  Quadratic xx_, yy_, xy_;
};

}  // namespace

void CountsIn::fill(int columns, int rows, int block, const std::vector<Highlight>& of) {
  columns_ = columns, rows_ = rows, block_ = block;
  stride_ = static_cast<std::size_t>((columns + block - 1) / block + 1);
  before_.assign(stride_ * static_cast<std::size_t>((rows + block - 1) / block + 1), 0);
  for (const Highlight& h : of) {
    ++before_[static_cast<std::size_t>(h.row / block + 1) * stride_ + static_cast<std::size_t>(h.column / block + 1)];
  }
  for (std::size_t i = stride_; i < before_.size(); ++i) {
    if (i % stride_ != 0) before_[i] += before_[i - 1] + before_[i - stride_] - before_[i - stride_ - 1];
  }
}

std::uint32_t CountsIn::operator()(const PixelRect& rect) const noexcept {
  if (before_.empty()) return 0;
  const auto at = [&](int pixel, int end) { return static_cast<std::size_t>(std::clamp(pixel, 0, end - 1) / block_); };
  const std::size_t left = at(rect.left, columns_), right = at(rect.right, columns_) + 1, top = at(rect.top, rows_),
                    bottom = at(rect.bottom, rows_) + 1;
  return before_[bottom * stride_ + right] + before_[top * stride_ + left] - before_[top * stride_ + right] -
         before_[bottom * stride_ + left];
}

/// The light that a highlight of value 1 adds to a rectangle of the picture, relative to the pixel of the highlight.
struct Highlights::Stamp {
  int left = 0, top = 0, columns = 0, rows = 0;
  bool hidden = false;  ///< true if some rays do not reach the highlight
  std::vector<float> light;
};

/// Rays that meet a highlight, relative to its pixel.
struct Highlights::Splat {
  double x, y, light;  ///< position in the picture, and the light of the ray
  double half = 0;     ///< half the width of the tent over which the light is spread
};
struct Highlights::Lines {
  std::size_t channel = 0, most = 0;  ///< most: largest number of lines
  RasterArea area{};                  ///< part of the picture
  std::vector<float> rows{};          ///< [Row][ray], as in RayTable
  std::vector<Splat> splats{};

  std::size_t stride() const noexcept { return most + 64; }
};

/// Highlights that share a stamp.
struct Highlights::SharedStamp {
  Group members;
  Stamp stamp;
};

Highlights::Highlights(const LayerData& layers, const LensRays& rays, const GatherOptions& options, int overscan)
    : layers_(layers),
      rays_(RayAccess::data(rays)),
      gap_(rays_.gap()),
      nearest_(std::max(layers.depths().most, 1e-30f)),
      farthest_(layers.depths().least),
      overscan_(overscan) {
  if (options.highlights_above == 0) return;
  find(options);
  make_groups();
  if (highlights_.empty() || !rays_.shift_invariant) return;
  const auto narrower = [](const Highlight& a, const Highlight& b) { return a.area < b.area; };
  const float widest = std::max_element(highlights_.begin(), highlights_.end(), narrower)->area;
  for (std::size_t channel = 0; channel < rays_.table.channels; ++channel) {
    shared_.push_back(rays_.dense({0, 0, 1, 1}, channel, 0, dense_rays(widest), options.stop));
  }
}

void Highlights::find(const GatherOptions& options) {
  const auto above = static_cast<float>(options.highlights_above);
  std::vector<Highlight> bright;
  for (int row = 0; row < layers_.rows; ++row) {
    keep_on(options.stop, "gather");
    for (int layer = 0; layer < layers_.count; ++layer) {
      if (!(layers_.brightest[static_cast<std::size_t>(layer * layers_.rows + row)] > above)) continue;
      const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(row) * layers_.columns;
      const float* const depth = layers_.plane(layer, 0) + from;
      for (int column = 0; column < layers_.columns; ++column) {
        const auto [r, g, b] = layers_.colour(layer, static_cast<std::size_t>(from + column));
        if (!(std::max({r, g, b}) > above) || depth[column] < 0 || !std::isfinite(r + g + b)) continue;
        bright.push_back({column, row, layer, depth[column], {r, g, b}});
      }
    }
  }
  if (bright.empty()) return;
  const RayTable& table = rays_.table;
  std::vector<std::optional<CoveredArea>> areas(table.node_rows * table.node_columns);
  const auto node = [&](int position, int end, std::size_t nodes) {
    const int within = std::clamp(position - overscan_, 0, end);
    return std::min(static_cast<std::size_t>(within / table.step), nodes - 1);
  };
  for (Highlight& h : bright) {
    const std::size_t row = node(h.row, table.area.rows, table.node_rows),
                      column = node(h.column, table.area.columns, table.node_columns);
    std::optional<CoveredArea>& area = areas[row * table.node_columns + column];
    if (!area) area.emplace(table.node(0, row, column), table.rays);
    h.area = static_cast<float>(area->at(h.inverse_depth));
  }
  // A wide bright surface needs no stamps, because enough rays of each pixel meet it. Much dimmer surfaces, such as a
  // white wall behind a lamp, are not counted. Blocks of one pixel: with larger blocks, the count would depend on the
  // position of a pixel in its block.
  constexpr float much = 16;
  const auto rays = static_cast<double>(rays_.rays_of_set());
  const auto brightness = [](const Highlight& h) { return std::max({h.light[0], h.light[1], h.light[2]}); };
  // Near the limit of a condition, the light is divided between the disc and the pixel of the layer. A light that
  // becomes a disc in a sequence of frames does so gradually.
  constexpr double fade = 0.25;
  const auto beyond = [](double value, double limit) { return std::clamp((value / limit - 1) / fade, 0.0, 1.0); };
  const auto below = [](double value, double limit) { return std::clamp((1 - value / limit) / fade, 0.0, 1.0); };
  CountsIn bright_in;
  for (float level = above; !bright.empty(); level *= much) {
    bright_in.fill(layers_.columns, layers_.rows, 1, bright);
    for (const Highlight& h : bright) {
      if (brightness(h) > level * much) continue;
      const int reach = static_cast<int>(std::sqrt(h.area / std::numbers::pi));
      const double covered =
          bright_in({h.column - reach, h.row - reach, h.column + reach, h.row + reach}) / std::max(h.area, 1.0f);
      const auto part = static_cast<float>(beyond(static_cast<double>(brightness(h)), options.highlights_above) *
                                           beyond(static_cast<double>(h.area), rays) * below(covered, 0.5) *
                                           below(covered * rays, 32));
      if (part == 0) continue;
      Highlight& added = highlights_.emplace_back(h);
      for (std::size_t c = 0; c < 3; ++c)
        added.light[c] = part * h.light[c], added.rest[c] = h.light[c] - added.light[c];
    }
    std::erase_if(bright, [&](const Highlight& h) { return brightness(h) <= level * much; });
  }
  std::ranges::stable_sort(highlights_, {}, &Highlight::row);
  counts_.fill(layers_.columns, layers_.rows, NBuffer::block, highlights_);
  std::size_t at = 0;
  for (int row = 0; row <= layers_.rows; ++row) {
    while (at < highlights_.size() && highlights_[at].row < row) ++at;
    row_begin_.push_back(at);
  }
}

void Highlights::make_groups() {
  constexpr int cell = group_cell;
  // Highlights of one group have blurs that differ by less than a pixel.
  const auto key_of = [&](const Highlight& h) {
    return std::tuple(cell_of(h.row, cell), cell_of(h.column, cell), h.layer,
                      static_cast<int>(h.inverse_depth * rays_.largest_slope));
  };
  std::map<std::tuple<int, int, int, int>, std::size_t> known;
  for (std::size_t i = 0; i < highlights_.size(); ++i) {
    const auto [at, added] = known.try_emplace(key_of(highlights_[i]), groups_.size());
    if (added) groups_.emplace_back();
    groups_[at->second].push_back(i);
  }
}

void Highlights::cut(const PixelRect& rect, int columns, int layers, int planes, std::size_t plane_stride,
                     float* copy) const {
  if (highlights_.empty()) return;
  for (int row = std::max(rect.top, 0); row <= std::min(rect.bottom, layers_.rows - 1); ++row) {
    for (std::size_t i = row_begin_[static_cast<std::size_t>(row)]; i < row_begin_[static_cast<std::size_t>(row) + 1];
         ++i) {
      const Highlight& h = highlights_[i];
      if (h.column < rect.left || h.column > rect.right || h.layer >= layers) continue;
      float* const at = copy + static_cast<std::size_t>(h.layer * planes) * plane_stride +
                        static_cast<std::ptrdiff_t>(row - rect.top) * columns + (h.column - rect.left);
      const PackedColour rest = PackedColour::of(h.rest[0], h.rest[1], h.rest[2]);
      at[plane_stride] = rest.red_blue, at[2 * plane_stride] = rest.green_blue;
    }
  }
}

void Highlights::hide(const Highlight& h, const Lines& lines, std::size_t count, std::vector<float>& through) const {
  // A surface that is nearer by less than this margin, the offset of the umbra, hides the highlight from no ray.
  const double margin = 0.5 / std::max(rays_.largest_slope, 1e-30);
  TileRays rays{.count = count,
                .row_stride = lines.stride(),
                .corners = {lines.rows.data()},
                .from = nearest_,
                .to = static_cast<float>(h.inverse_depth + margin),
                .most = nearest_,
                .end = farthest_};
  // Start at the nearest of all surfaces, then at the nearest surface below the paths that follow from it.
  for (int i = 0; i < 2; ++i) {
    const Limits reach = gather_loops().limits(rays.corners, 1, rays.row_stride, count, rays.from, h.inverse_depth);
    const auto pixel = [](int at, float offset) { return at + static_cast<int>(std::floor(offset)); };
    const PixelRect rect{pixel(h.column, reach.left) - 1, pixel(h.row, reach.top) - 1, pixel(h.column, reach.right) + 2,
                         pixel(h.row, reach.bottom) + 2};
    rays.from = layers_.n_buffer.below(rect).most;
    if (rays.from <= rays.to) return;
  }
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(h.row) * layers_.columns + h.column;
  const auto number = [](int n) { return static_cast<float>(n); };
  gather_loops().transmit(
      {.layers = layers_.count,
       .stride = layers_.columns,
       .layer_stride = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(layers_.planes) * layers_.plane_stride()),
       .depth = layers_.plane(0, 0) + at,
       .alpha = layers_.planes > 3 ? layers_.plane(0, 3) + at : nullptr},
      rays, gap_,
      {number(-h.column), number(layers_.columns - 1 - h.column), number(-h.row), number(layers_.rows - 1 - h.row)},
      through.data());
}

void Highlights::extend(Lines& lines, const Highlight& h, std::size_t count, const std::stop_token& stop) const {
  const std::size_t first = lines.splats.size();
  if (first >= count) return;
  lines.rows.resize(weight * lines.stride());
  RayTable own;
  if (!rays_.shift_invariant) own = rays_.dense(lines.area, lines.channel, first, count, stop);
  const RayTable& table = rays_.shift_invariant ? shared_[lines.channel] : own;
  const double x = h.column + 0.5 - overscan_, y = h.row + 0.5 - overscan_, w = h.inverse_depth;
  for (std::size_t ray = 0; ray < count - first; ++ray) {
    float line[row_count];
    // The position of the ray at the depth of the highlight, for a ray of the picture position `from`.
    const auto lead = [&](const Vec2<double>& from) {
      table.ray_at(0, ray, from.x, from.y, line);
      return Vec2<double>{from.x + line[at_x] + w * line[slope_x], from.y + line[at_y] + w * line[slope_y]};
    };
    Vec2<double> landing{x, y};
    double stretch = 1, off = 0;
    if (rays_.shift_invariant) {
      for (std::size_t r = 0; r < row_count; ++r) line[r] = table.node(0, 0, 0)[r * table.rays + ray];
      landing -= Vec2<double>{line[at_x] + w * line[slope_x], line[at_y] + w * line[slope_y]};
    } else {
      off = 1;
      for (int k = 0; k < 12 && off > 0.05; ++k) {
        const Vec2<double> miss = Vec2<double>{x, y} - lead(landing);
        off = std::max(std::abs(miss.x), std::abs(miss.y));
        landing += miss;
      }
      const Vec2<double> right = lead(landing + Vec2<double>{1, 0}), below = lead(landing + Vec2<double>{0, 1}),
                         here = lead(landing), across = right - here, down = below - here;
      stretch = std::abs(across.x * down.y - across.y * down.x);
    }
    if (!(off <= 1 && stretch > 1e-3)) {  // no light
      landing = {x, y};
      std::fill_n(line, row_count, 0.0f);
    }
    lines.splats.push_back({landing.x - h.column, landing.y - h.row, line[weight] > 0 ? line[weight] / stretch : 0});
    float* const row = lines.rows.data() + first + ray;
    row[at_x * lines.stride()] = static_cast<float>(landing.x + line[at_x] - x);
    row[at_y * lines.stride()] = static_cast<float>(landing.y + line[at_y] - y);
    row[slope_x * lines.stride()] = line[slope_x], row[slope_y * lines.stride()] = line[slope_y];
  }
}

/// Sets the widths of tents that overlap the tents of adjacent rays, so that the sum is smooth.
///
/// Rays whose indices differ by a constant have a constant offset in the pupil. The area between such neighbours of a
/// ray is the part of the blur that the ray represents.
void Highlights::set_tents(std::vector<Splat>& splats, std::size_t rays, double area) {
  const core_detail::Kronecker<2> points;
  struct Offset {
    std::size_t index;
    double u, v;
  };
  std::vector<Offset> nearest;
  for (std::size_t i = 1; i < rays / 2; ++i) {
    const auto [u, v] = points(i);
    nearest.push_back({i, std::remainder(u - points(0)[0], 1), std::remainder(v - points(0)[1], 1)});
  }
  std::ranges::partial_sort(nearest, nearest.begin() + 2, {}, [](const Offset& o) { return o.u * o.u + o.v * o.v; });
  const double of_pupil = std::abs(nearest[0].u * nearest[1].v - nearest[0].v * nearest[1].u);
  const double usual = area / static_cast<double>(rays);
  for (std::size_t i = 0; i < rays; ++i) {
    Splat& s = splats[i];
    Vec2<double> to[2];
    bool known = s.light > 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto [index, u, dv] = nearest[k];
      const double next = points(i)[1] + dv, last = points(i)[1] - dv;
      const bool ahead = i + index < rays && next > 0 && next < 1, behind = i >= index && last > 0 && last < 1;
      known = known && (ahead || behind);
      if (!known) break;
      const Splat& other = splats[ahead ? i + index : i - index];
      known = other.light > 0;
      to[k] = {other.x - s.x, other.y - s.y};
    }
    const double own =
        known ? std::abs(to[0].x * to[1].y - to[0].y * to[1].x) / of_pupil / static_cast<double>(rays) : usual;
    s.half = std::max(0.75, 2.1 * std::sqrt(std::min(own, 9 * usual)));
  }
}

/// Moves rays towards their mean, so that tents keep the second moments of the rays.
void Highlights::contract(std::vector<Splat>& splats) {
  double light = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, variance = 0;
  for (const Splat& s : splats) {
    light += s.light, x += s.light * s.x, y += s.light * s.y, variance += s.light * s.half * s.half / 6;
  }
  x /= light, y /= light, variance /= light;
  for (const Splat& s : splats) {
    xx += s.light * (s.x - x) * (s.x - x), xy += s.light * (s.x - x) * (s.y - y), yy += s.light * (s.y - y) * (s.y - y);
  }
  xx /= light, xy /= light, yy /= light;
  // Half the variance relative to the moments; a blur that is narrower than the tents is kept.
  const double determinant = xx * yy - xy * xy, part = variance / 2 / determinant;
  if (!(determinant > 2 * variance * (xx + yy))) return;
  for (Splat& s : splats) {
    const double off_x = s.x - x, off_y = s.y - y;
    s.x -= part * (yy * off_x - xy * off_y), s.y -= part * (xx * off_y - xy * off_x);
  }
}

Highlights::Stamp Highlights::stamp_of(const Highlight& h, double density, Lines& lines,
                                       const std::stop_token& stop) const {
  keep_on(stop, "gather");
  const auto rays = static_cast<std::size_t>(std::clamp<double>(density * h.area, least_rays, lines.most));
  // Highlights of a group share the lines, except where lines are cheap.
  if (rays_.shift_invariant) lines.splats.clear();
  extend(lines, h, rays, stop);
  set_tents(lines.splats, rays, h.area);
  std::vector<float> through(rays + 64, 1.0f);
  hide(h, lines, rays, through);

  std::vector<Splat> splats;
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  Stamp stamp;
  for (std::size_t i = 0; i < rays; ++i) {
    Splat s = lines.splats[i];
    stamp.hidden |= s.light > 0 && through[i] < 1;
    s.light *= through[i] / static_cast<double>(rays);
    if (s.light > 0) splats.push_back(s);
  }
  contract(splats);
  double widest = 0;
  for (const Splat& s : splats) {
    left = std::min(left, s.x - s.half), right = std::max(right, s.x + s.half);
    top = std::min(top, s.y - s.half), bottom = std::max(bottom, s.y + s.half);
    widest = std::max(widest, s.half);
  }
  if (splats.empty()) return stamp;

  stamp.left = static_cast<int>(std::floor(left)), stamp.top = static_cast<int>(std::floor(top));
  stamp.columns = static_cast<int>(std::ceil(right)) - stamp.left;
  stamp.rows = static_cast<int>(std::ceil(bottom)) - stamp.top;
  // Fractions of a tent's light in rows of pixels; the rows have a fixed length, for SIMD instructions.
  constexpr std::size_t lanes = 8;
  std::vector<float> across((static_cast<std::size_t>(2 * widest) + 1 + lanes) / lanes * lanes), down(across.size());
  stamp.light.resize(static_cast<std::size_t>(stamp.columns) * static_cast<std::size_t>(stamp.rows) + across.size());
  const auto fractions = [](double centre, double half, int first, std::vector<float>& of_pixels) {
    const auto begin = static_cast<float>((first - centre) / half), step = static_cast<float>(1 / half);
    const auto before = [](float t) {
      t = t < -1 ? -1 : t > 1 ? 1 : t;
      return t - 0.5f * t * std::abs(t);
    };
    for (std::size_t i = 0; i < of_pixels.size(); ++i) {
      const auto n = static_cast<float>(static_cast<int>(i));
      of_pixels[i] = before(begin + (n + 1) * step) - before(begin + n * step);
    }
  };
  for (const Splat& s : splats) {
    const int column = static_cast<int>(std::floor(s.x - s.half)), row = static_cast<int>(std::floor(s.y - s.half)),
              end = static_cast<int>(std::ceil(s.y + s.half));
    fractions(s.x, s.half, column, across), fractions(s.y, s.half, row, down);
    float* light = &stamp.light[static_cast<std::size_t>(row - stamp.top) * static_cast<std::size_t>(stamp.columns) +
                                static_cast<std::size_t>(column - stamp.left)];
    for (int j = 0; j < end - row; ++j, light += stamp.columns) {
      const float of_row = static_cast<float>(s.light) * down[static_cast<std::size_t>(j)];
      for (std::size_t i = 0; i < across.size(); i += lanes) {
        for (std::size_t k = 0; k < lanes; ++k) light[i + k] += of_row * across[i + k];
      }
    }
  }
  return stamp;
}

const Highlight& Highlights::brightest(const Group& group) const {
  const auto brightness = [&](std::size_t i) {
    return highlights_[i].light[0] + highlights_[i].light[1] + highlights_[i].light[2];
  };
  return highlights_[*std::max_element(group.begin(), group.end(),
                                       [&](std::size_t a, std::size_t b) { return brightness(a) < brightness(b); })];
}

RasterArea Highlights::around(const Group& group, std::size_t channel) const {
  const RayTable& table = rays_.table;
  const Highlight& light = brightest(group);
  std::vector<float> rows(table.node_size());
  const int column = light.column - overscan_, row = light.row - overscan_;
  table.at(channel, column + 0.5, row + 0.5, rows.data());
  int left = column, right = column, top = row, bottom = row;
  for (std::size_t i = 0; i < table.rays; ++i) {
    if (rows[weight * table.rays + i] == 0) continue;
    const auto along = [&](Row at, Row slope) {
      return static_cast<int>(rows[at * table.rays + i] + light.inverse_depth * rows[slope * table.rays + i]);
    };
    const int x = column - along(at_x, slope_x), y = row - along(at_y, slope_y);
    left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
  }
  return {left, top, right - left, bottom - top};
}

RasterArea Highlights::area_of(const Group& group, std::size_t channel) const {
  const RasterArea rays = around(group, channel);
  // The blur changes over the picture, and highlights of one group are up to a cell apart.
  return common(grown(rays, 2 + group_cell + std::max(rays.columns, rays.rows) / 8), rays_.table.area);
}

std::vector<Highlights::SharedStamp> Highlights::stamps_of(const Group& group, std::size_t channel,
                                                           const std::stop_token& stop) const {
  constexpr int cell = 4;
  // For each highlight, nearer surfaces hide different rays. The highlights of one cell are treated as if the same rays
  // were hidden, which moves the edge of the shadow by less than a cell.
  std::map<std::pair<int, int>, Group> cells;
  for (const std::size_t member : group) {
    cells[{cell_of(highlights_[member].row, cell), cell_of(highlights_[member].column, cell)}].push_back(member);
  }
  std::vector<SharedStamp> stamps;
  const Highlight& light = brightest(group);
  Lines lines{.channel = channel, .most = dense_rays(light.area), .area = area_of(group, channel)};
  if (!rays_.shift_invariant && lines.area.columns == 0) return stamps;
  if (cells.size() == 1 || !stamp_of(light, 0.5, lines, stop).hidden) {
    stamps.push_back({group, stamp_of(light, rays_of_pixel, lines, stop)});
    return stamps;
  }
  const double rays = std::max(1.0, rays_of_pixel / static_cast<double>(cells.size()));
  for (const auto& [landing, members] : cells) {
    stamps.push_back({members, stamp_of(brightest(members), rays, lines, stop)});
  }
  return stamps;
}

std::vector<Highlights::Job> Highlights::jobs_in(const RasterArea& region) const {
  std::vector<Job> jobs;
  for (const Group& group : groups_) {
    // Each highlight has the stamp of the brightest of its group.
    const Highlight& light = brightest(group);
    int left = 0, right = 0, top = 0, bottom = 0;
    for (const std::size_t member : group) {
      const int x = highlights_[member].column - light.column, y = highlights_[member].row - light.row;
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
    for (std::size_t channel = 0; channel < rays_.table.channels; ++channel) {
      const RasterArea rays = around(group, channel);
      const int margin = 12 + std::max(rays.columns, rays.rows) / 8;  // tents; more rays than in the table
      const RasterArea bounds =
          grown({rays.left + left, rays.top + top, rays.columns + right - left, rays.rows + bottom - top}, margin);
      if (common(bounds, region).columns > 0) jobs.push_back({&group, channel, bounds});
    }
  }
  return jobs;
}

void Highlights::spread(const std::vector<Job>& jobs, const RasterArea& region, const GatherOptions& options,
                        GatherProgress& progress, BlurredImage& picture) const {
  constexpr std::size_t batch_size = 64;
  std::vector<std::vector<SharedStamp>> stamps(std::min(batch_size, jobs.size()));
  for (std::size_t begin = 0; begin < jobs.size(); begin += batch_size) {
    const std::size_t count = std::min(batch_size, jobs.size() - begin);
    parallel_for(count, 1, options.threads, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        stamps[i] = stamps_of(*jobs[begin + i].group, jobs[begin + i].channel, options.stop);
        progress.add(1);
      }
    });
    // In sequence, so that the sums do not depend on the number of threads.
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& [members, stamp] : stamps[i]) {
        keep_on(options.stop, "gather");
        for (const std::size_t member : members) add(stamp, highlights_[member], jobs[begin + i], region, picture);
      }
    }
  }
}

void Highlights::add(const Stamp& stamp, const Highlight& h, const Job& job, const RasterArea& region,
                     BlurredImage& picture) const {
  float light[4] = {};
  for (std::size_t c = 0; c < 3; ++c) light[c] = rays_.table.channels == 1 || c == job.channel ? h.light[c] : 0;
  const int left = stamp.left + h.column, top = stamp.top + h.row;
  // Within the bounds, so that a region without this job has the bits of the whole image.
  const RasterArea to = common(common({left, top, stamp.columns, stamp.rows}, job.bounds), region);
  for (int row = to.top; row < to.top + to.rows; ++row) {
    const float* const of_row =
        stamp.light.data() + static_cast<std::ptrdiff_t>(row - top) * stamp.columns + to.left - left;
    float* const rgba = picture.rgba.data() +
                        4 * (static_cast<std::ptrdiff_t>(row - region.top) * picture.columns + to.left - region.left);
    for (int column = 0; column < to.columns; ++column) {
      for (int c = 0; c < 4; ++c) rgba[4 * column + c] += of_row[column] * light[c];
    }
  }
}

}  // namespace petzval::blur_detail
