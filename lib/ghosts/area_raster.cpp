// SPDX-License-Identifier: Apache-2.0
#include "area_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace petzval::ghosts_detail {

void AreaRaster::add(std::span<const Vec2<double>> polygon, double energy, std::size_t first,
                     std::size_t last) noexcept {
  constexpr double narrowest = 0.02;
  double low = polygon[0].y, high = low, left = polygon[0].x, twice = 0;
  for (const Vec2<double>& p : polygon) {
    low = std::min(low, p.y), high = std::max(high, p.y), left = std::min(left, p.x);
  }
  if (!(high + narrowest > static_cast<double>(first) && low - narrowest < static_cast<double>(last) &&
        left - narrowest < static_cast<double>(columns_))) {
    return;
  }
  const auto add_edges = [&](std::span<const Vec2<double>> corners, double area) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      add_edge(corners[k], corners[(k + 1) % corners.size()], energy / area, first, last);
    }
  };
  Vec2<double> longest{0, 0}, middle{0, 0};
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    middle += polygon[k] / static_cast<double>(polygon.size());
    if (k > 1) twice += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
    for (std::size_t m = 0; m < k; ++m) {
      const Vec2<double> d = polygon[k] - polygon[m];
      if (glm::dot(d, d) > glm::dot(longest, longest)) longest = d;
    }
  }
  const double length = glm::length(longest);
  if (std::abs(twice) > narrowest * length && length > narrowest) return add_edges(polygon, twice / 2);
  const Vec2<double> along = length > 0 ? longest / length : Vec2<double>(1, 0);
  const Vec2<double> a = along * (std::max(length, narrowest) / 2),
                     b = Vec2<double>(-along.y, along.x) * (narrowest / 2);
  add_edges(std::array{middle - a - b, middle + a - b, middle + a + b, middle - a + b}, 4 * cross(a, b));
}

void AreaRaster::add_edge(const Vec2<double>& from, const Vec2<double>& to, double density, std::size_t first,
                          std::size_t last) noexcept {
  if (from.y == to.y) return;
  const bool down = from.y < to.y;
  const Vec2<double>&a = down ? from : to, &b = down ? to : from;
  const double top = std::max(a.y, static_cast<double>(first)), bottom = std::min(b.y, static_cast<double>(last));
  if (!(top < bottom)) return;
  // The area to the right of an edge that runs upwards (rows count downwards) is inside.
  const double weight = down ? -density : density, slope = (b.x - a.x) / (b.y - a.y);
  double y = top, x = a.x + slope * (top - a.y);
  for (auto row = static_cast<std::size_t>(top); y < bottom; ++row) {
    const double next = std::min(bottom, static_cast<double>(row + 1)), next_x = a.x + slope * (next - a.y);
    add_slice(row, std::min(x, next_x), std::max(x, next_x), weight * (next - y));
    y = next, x = next_x;
  }
}

void AreaRaster::add_slice(std::size_t row, double x0, double x1, double weight) noexcept {
  double* const to = differences_.data() + row * (columns_ + 2);
  const auto width = static_cast<double>(columns_);
  if (x0 >= 0 && x1 < width) {
    const auto column = static_cast<std::size_t>(x0);
    const auto left = static_cast<double>(column);
    if (x1 <= left + 1) {  // most edges are steep
      const double behind = weight * ((x0 + x1) / 2 - left);
      to[column] += weight - behind, to[column + 1] += behind;
      return;
    }
  }
  if (x0 >= width) return;
  if (x1 <= 0) {
    to[0] += weight;
    return;
  }
  if (x0 < 0 || x1 > width) {  // the part on the left covers whole rows, the part on the right nothing
    const double per_length = weight / (x1 - x0);
    if (x0 < 0) to[0] -= per_length * x0;
    weight = per_length * (std::min(x1, width) - std::max(x0, 0.0));
    x0 = std::max(x0, 0.0), x1 = std::min(x1, width);
  }
  // Mean of the part of the row between the edge and t: its difference over a pixel is the covered part of the pixel.
  const double middle = (x0 + x1) / 2, per_twice = x1 > x0 ? 0.5 / (x1 - x0) : 0;
  const auto covered = [&](double t) { return t >= x1 ? t - middle : (t - x0) * (t - x0) * per_twice; };
  auto column = static_cast<std::size_t>(x0);
  double before = 0, sum = 0;
  for (; static_cast<double>(column) < x1 || before == 0; ++column) {
    const double next = covered(static_cast<double>(column + 1)), part = next - sum;
    to[column] += weight * (part - before);
    before = part, sum = next;
    if (column == columns_) return;
  }
  to[column] += weight * (1 - before);
}

void AreaRaster::read(std::size_t row, std::span<double> energies) const noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < columns_; ++k) energies[k] = sum += differences_[row * (columns_ + 2) + k];
}

}  // namespace petzval::ghosts_detail
