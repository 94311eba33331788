// SPDX-License-Identifier: Apache-2.0
#include "iris_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

/// The published formula before it is limited to 0, and its integral from 0 to x, with |d| for d.
double uncut(const EdgeWeight& w, double x) noexcept {
  const double d = std::abs(w.distribution);
  return 1 + w.strength * ((d + 1) * std::pow(x, d) - 1);
}
double uncut_below(const EdgeWeight& w, double x) noexcept {
  const double d = std::abs(w.distribution);
  return x + w.strength * (std::pow(x, d + 1) - x);
}

/// The interval of x in which the formula is not negative; the formula is monotonic.
std::array<double, 2> lit(const EdgeWeight& w) noexcept {
  const bool first = uncut(w, 0) >= 0, last = uncut(w, 1) >= 0;
  if (first && last) return {0, 1};
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((uncut(w, middle) >= 0) == first ? low : high) = middle;
  }
  return first ? std::array{0.0, low} : std::array{high, 1.0};
}

/// The integral of an edge weight, limited to 0.
class EdgeLight {
 public:
  explicit EdgeLight(const EdgeWeight& weight) noexcept : weight_(weight), lit_(lit(weight)) {}

  /// The integral over all points whose fraction of the area is below x.
  double below(double x) const noexcept {
    if (weight_.even()) return x;
    return weight_.distribution < 0 ? from_begin(1) - from_begin(1 - x) : from_begin(x);
  }

 private:
  double from_begin(double to) const noexcept {
    return uncut_below(weight_, std::clamp(to, lit_[0], lit_[1])) - uncut_below(weight_, lit_[0]);
  }

  EdgeWeight weight_;
  std::array<double, 2> lit_;
};

}  // namespace

double EdgeWeight::at(double area_fraction) const noexcept {
  if (even()) return 1;
  const double x = std::clamp(area_fraction, 0.0, 1.0);
  return std::max(uncut(*this, distribution < 0 ? 1 - x : x), 0.0);
}

double EdgeWeight::light_added() const noexcept { return std::max(EdgeLight(*this).below(1) - 1, 0.0); }

double iris_area(const Iris& iris, const IrisMap& map) {
  iris_detail::check(map, "iris: ");
  return iris_area(iris) * iris_detail::IrisWeights(iris, {}, map, 0, "iris: ").mean();
}

IrisMap onion_rings(const OnionRings& rings, int pixels) {
  if (!(pixels >= 2 && pixels <= 8192)) {
    throw Error("onion_rings: pixels = " + std::to_string(pixels) + "; must be 2 to 8192");
  }
  const double least = 4.0 / pixels;
  if (!(rings.period >= least && rings.period <= 2)) {
    throw Error("onion_rings: period = " + to_text(rings.period) + "; must be " + to_text(least) + " to 2");
  }
  if (!(rings.contrast >= 0 && rings.contrast <= 1)) {
    throw Error("onion_rings: contrast = " + to_text(rings.contrast) + "; must be 0 to 1");
  }
  if (!(rings.jitter >= 0 && std::isfinite(rings.jitter))) {
    throw Error("onion_rings: jitter = " + to_text(rings.jitter) + "; must be finite and at least 0");
  }
  // The phase is a random walk over the rings, interpolated linearly.
  constexpr double pi = std::numbers::pi;
  std::vector<double> walk{0};
  std::uint32_t state = rings.seed;
  const auto random = [&] {  // splitmix by 32 bits
    std::uint32_t z = state += 0x9e3779b9u;
    z = (z ^ (z >> 16)) * 0x85ebca6bu;
    z = (z ^ (z >> 13)) * 0xc2b2ae35u;
    return (z ^ (z >> 16)) / 4294967296.0;
  };
  const auto count = static_cast<std::size_t>(std::sqrt(2.0) / rings.period) + 2;
  while (walk.size() <= count) walk.push_back(walk.back() + 2 * pi * rings.jitter * (2 * random() - 1));
  IrisMap map{pixels, pixels, {}, true};
  for (int row = 0; row < pixels; ++row) {
    for (int column = 0; column < pixels; ++column) {
      const double x = (2 * column + 1.0) / pixels - 1, y = (2 * row + 1.0) / pixels - 1;
      const double ring = std::hypot(x, y) / rings.period;
      const auto k = static_cast<std::size_t>(ring);
      const double phase = walk[k] + (ring - static_cast<double>(k)) * (walk[k + 1] - walk[k]);
      map.values.push_back(static_cast<float>(1 + rings.contrast * std::cos(2 * pi * ring + phase)));
    }
  }
  return map;
}

namespace iris_detail {
namespace {

/// Number of rows and of columns of the cells in which maps are sampled.
constexpr std::size_t map_cells = 256;

/// True if both are finite; a cast of NaN to an index is undefined.
bool finite(double a, double b) noexcept { return (a + b) * 0 == 0; }

/// Index of the last part that begins at or below `value`, by bisection of cumulative sums that start at 0.
/// Branch-free, because the processor would mispredict branches on random numbers.
std::size_t cell_at(const double* begins, double value) noexcept {
  std::size_t cell = 0;
  for (std::size_t step = map_cells / 2; step > 0; step /= 2) cell += begins[cell + step] <= value ? step : 0;
  return cell;
}

}  // namespace

void check(const IrisMap& map, const std::string& where) {
  if (map.empty() && map.width == 0 && map.height == 0) return;
  const auto size = std::to_string(map.width) + " x " + std::to_string(map.height);
  constexpr std::int64_t max_pixels = std::int64_t{1} << 26;
  const std::int64_t pixels = std::int64_t{map.width} * map.height;
  if (map.width < 1 || map.height < 1 || pixels > max_pixels) {
    throw Error(where + "map: width x height = " + size + "; must be 1 x 1 to " + std::to_string(max_pixels) +
                " pixels in all");
  }
  if (static_cast<std::int64_t>(map.values.size()) != pixels) {
    throw Error(where + "map: number of values = " + std::to_string(map.values.size()) + "; must be " + size);
  }
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const float value = map.values[i];
    if (std::isfinite(value) && value >= 0) continue;
    const auto width = static_cast<std::size_t>(map.width);
    throw Error(where + "map: weight = " + to_text(value) + " in row " + std::to_string(i / width) + ", column " +
                std::to_string(i % width) + "; must be finite and at least 0");
  }
}

IrisMap upside_down(IrisMap map, bool along_x, bool along_y) {
  if (along_x && along_y) {
    std::reverse(map.values.begin(), map.values.end());
  } else if (along_x || along_y) {
    for (auto row = map.values.begin(); row != map.values.end(); row += map.width) std::reverse(row, row + map.width);
    if (along_y) std::reverse(map.values.begin(), map.values.end());
  }
  return map;
}

IrisWeights::IrisWeights(const Iris& iris, const EdgeWeight& edge, const IrisMap& map, double uniform_fraction,
                         const std::string& where)
    : shape_(iris), edge_(edge), map_(map) {
  if (!(std::abs(edge.distribution) <= 1000) || !(std::abs(edge.strength) <= 1e6)) {
    throw Error(where + "weight distribution, strength = " + to_text(edge.distribution) + ", " +
                to_text(edge.strength) + "; must be at most 1000 and 1e6 in absolute value");
  }
  tabulate_edge();
  divide_rows(map.empty() ? 2048 : map_cells, uniform_fraction);
  if (map.empty()) return;
  std::vector<double> light = light_of_cells();
  mean_ = std::accumulate(light.begin(), light.end(), 0.0);
  if (!(mean_ > 0)) throw Error(where + "the map is black on the iris; must be above 0 somewhere");
  for (double& value : light) value /= mean_;
  divide_columns(light, uniform_fraction);
}

void IrisWeights::tabulate_edge() {
  // The error is at most 4e-6 of the largest weight: (d / steps)^4 / 384.
  constexpr double min_exponent = 4, max_exponent = 200;
  constexpr int steps = 1024;
  const double d = std::abs(edge_.distribution);
  if (!(d >= min_exponent && d <= max_exponent)) return;
  for (int i = 0; i <= steps; ++i) {
    const double area_fraction = static_cast<double>(i) / steps,
                 x = edge_.distribution < 0 ? 1 - area_fraction : area_fraction;
    const double rate = edge_.strength * (d + 1) * d * std::pow(x, d - 1) / steps;
    edge_steps_.push_back({uncut(edge_, x), edge_.distribution < 0 ? -rate : rate});
  }
}

void IrisWeights::divide_rows(std::size_t count, double uniform_fraction) {
  const EdgeLight light(edge_);
  mean_ = light.below(1);
  const auto samples_below = [&](double v) {
    return uniform_fraction * v + (1 - uniform_fraction) * (light.below(v) / mean_);
  };
  rows_.push_back(0);
  for (std::size_t k = 1; k < count; ++k) {
    double low = rows_.back(), high = 1;
    const double target = static_cast<double>(k) / static_cast<double>(count);
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (samples_below(middle) < target ? low : high) = middle;
    }
    rows_.push_back(high);
  }
  rows_.push_back(1);
  for (std::size_t k = 0; k < count; ++k) {
    row_densities_.push_back(1 / (static_cast<double>(count) * (rows_[k + 1] - rows_[k])));
  }
}

std::vector<double> IrisWeights::light_of_cells() {
  // A uniform grid over the square with at least one point per pixel.
  constexpr int min_samples_across = 1024;
  const auto samples_across = [](int pixels) { return pixels * ((min_samples_across + pixels - 1) / pixels); };
  const int across = samples_across(map_.width), down = samples_across(map_.height);
  std::vector<double> light(map_cells * map_cells);
  double of_map = 0, within = 0;
  for (int i = 0; i < down; ++i) {
    for (int j = 0; j < across; ++j) {
      const Vec2<double> stop_point{(2 * j + 1.0) / across - 1, 1 - (2 * i + 1.0) / down};
      const Vec2<double> at = shape_.position(stop_point.x, stop_point.y);
      if (!(at.y <= 1)) continue;
      const double own = map_at(stop_point);
      light[row_of(at.y) * map_cells + column_of(at.x)] += edge_at(at.y) * own;
      of_map += own, ++within;
    }
  }
  if (map_.keep_mean && of_map > 0) {
    const double map_mean = of_map / within;
    for (float& value : map_.values) value = static_cast<float>(value / map_mean);
    for (double& value : light) value /= map_mean;
  }
  for (double& value : light) value /= within;
  return light;
}

void IrisWeights::divide_columns(const std::vector<double>& contributions, double uniform_fraction) {
  // Between the grid points weights may be larger, and a small cell may contain no grid point.
  const double floor = std::max(uniform_fraction, 0.02);
  before_rows_.push_back(0);
  for (std::size_t i = 0; i < map_cells; ++i) {
    const double* const of_row = &contributions[i * map_cells];
    const double height = rows_[i + 1] - rows_[i];
    const double own = (1 - floor) * std::accumulate(of_row, of_row + map_cells, 0.0) + floor * height;
    before_rows_.push_back(before_rows_.back() + own);
    row_densities_[i] = own / height;
    before_in_row_.push_back(0);
    for (std::size_t j = 0; j < map_cells; ++j) {
      before_in_row_.push_back(before_in_row_.back() + ((1 - floor) * of_row[j] + floor * height / map_cells) / own);
    }
    before_in_row_.back() = 1;
  }
  before_rows_.back() = 1;
}

double IrisWeights::map_at(const Vec2<double>& stop_point) const noexcept {
  if (map_.empty()) return 1;
  const auto along = [](double at, int pixels) {
    const double x = std::clamp((at + 1) / 2 * pixels - 0.5, 0.0, pixels - 1.0);
    const int below = std::min(static_cast<int>(x), std::max(pixels - 2, 0));
    return std::pair{below, x - below};
  };
  const auto [column, s] = along(stop_point.x, map_.width);
  const auto [row, t] = along(-stop_point.y, map_.height);
  const auto value = [&, column = column, row = row](int right, int down) -> double {
    const int c = std::min(column + right, map_.width - 1), r = std::min(row + down, map_.height - 1);
    return map_
        .values[static_cast<std::size_t>(r) * static_cast<std::size_t>(map_.width) + static_cast<std::size_t>(c)];
  };
  const double above = value(0, 0) + s * (value(1, 0) - value(0, 0));
  return above + t * (value(0, 1) + s * (value(1, 1) - value(0, 1)) - above);
}

double IrisWeights::edge_at(double area_fraction) const noexcept {
  if (edge_steps_.empty()) return edge_.at(area_fraction);
  const double last = static_cast<double>(edge_steps_.size() - 1), at = std::clamp(area_fraction, 0.0, 1.0) * last;
  const auto k = static_cast<std::size_t>(std::min(at, last - 1));
  const auto [from, from_rate] = edge_steps_[k];
  const auto [to, to_rate] = edge_steps_[k + 1];
  const double t = at - static_cast<double>(k), change = to - from;
  const double weight =
      from + t * (from_rate + t * (3 * change - 2 * from_rate - to_rate + t * (from_rate + to_rate - 2 * change)));
  return std::max(weight, 0.0);
}

double IrisWeights::at(const Vec2<double>& stop_point) const noexcept {
  if (!finite(stop_point.x, stop_point.y)) return 0;
  return (edge_.even() ? 1 : edge_at(shape_.area_fraction(stop_point.x, stop_point.y))) * map_at(stop_point);
}

double IrisWeights::of_sample(double u, double v) const noexcept {
  if (!finite(u, v)) return 0;
  return edge_at(v) * (map_.empty() ? 1 : map_at(shape_.sample(u, v)));
}

std::size_t IrisWeights::row_of(double v) const noexcept {
  const auto above = std::upper_bound(rows_.begin() + 1, rows_.end() - 1, v);
  return static_cast<std::size_t>(above - rows_.begin() - 1);
}

std::size_t IrisWeights::column_of(double u) const noexcept {
  return std::min(static_cast<std::size_t>(u * map_cells), map_cells - 1);
}

IrisWeights::IrisSample IrisWeights::draw(double u, double v) const noexcept {
  if (!finite(u, v)) return {u, v, 1};  // the pupil rejects such numbers
  u = std::clamp(u, 0.0, 1.0), v = std::clamp(v, 0.0, 1.0);
  if (map_.empty()) {
    const double at = v * static_cast<double>(rows_.size() - 1);
    const std::size_t row = std::min(static_cast<std::size_t>(at), rows_.size() - 2);
    const double height = rows_[row + 1] - rows_[row];
    return {u, std::min(rows_[row] + height * (at - static_cast<double>(row)), 1.0), row_densities_[row]};
  }
  const std::size_t row = cell_at(before_rows_.data(), v);
  const double own = before_rows_[row + 1] - before_rows_[row], height = rows_[row + 1] - rows_[row];
  const double to_v = rows_[row] + height * std::min((v - before_rows_[row]) / own, 1.0);
  const double* const columns = before_in_row_.data() + row * (map_cells + 1);
  const std::size_t column = cell_at(columns, u);
  const double* const at_column = columns + column;
  const double fraction = at_column[1] - at_column[0];
  const double to_u = (static_cast<double>(column) + std::min((u - at_column[0]) / fraction, 1.0)) / map_cells;
  return {to_u, to_v, row_densities_[row] * fraction * map_cells};
}

double IrisWeights::density(double u, double v) const noexcept {
  if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) return 0;
  const std::size_t row = row_of(v);
  if (map_.empty()) return row_densities_[row];
  const std::size_t at = row * (map_cells + 1) + column_of(u);
  return row_densities_[row] * (before_in_row_[at + 1] - before_in_row_[at]) * map_cells;
}

}  // namespace iris_detail
}  // namespace petzval
