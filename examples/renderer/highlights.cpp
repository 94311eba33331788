// SPDX-License-Identifier: Apache-2.0
#include "renderer/highlights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "petzval/core/geometry.hpp"
#include "renderer/luminance.hpp"

namespace renderer {
namespace {

constexpr int balls_per_side = 6;  // on each side of the centre ball

double luminance_at(const petzval::RgbImage& picture, int x, int y) {
  const float* const p = picture.pixel(x, y);
  return static_cast<double>(luminance({p[0], p[1], p[2]}));
}

/// The value below which a given fraction of the values lies.
double quantile(std::vector<double> values, double fraction) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The range of columns of a ball at a spacing.
std::pair<int, int> columns_of(const petzval::RgbImage& picture, int ball, double spacing) {
  const double middle = picture.width / 2.0 + ball * spacing;
  return {std::max(0, static_cast<int>(middle - spacing / 2)),
          std::min(picture.width - 1, static_cast<int>(middle + spacing / 2))};
}

double spacing_of(const petzval::RgbImage& picture) {
  std::vector<double> columns;
  for (int x = 0; x < picture.width; ++x) {
    double sum = 0;
    for (int y = 0; y < picture.height; ++y) sum += luminance_at(picture, x, y);
    columns.push_back(sum);
  }
  double best = 0, found = 0;
  // From half of the largest spacing that fits into the picture.
  const double most = picture.width / (2.0 * balls_per_side + 1);
  for (double spacing = most / 2; spacing <= most; spacing += 0.1) {
    double sum = 0;
    int count = 0;
    for (int ball = -balls_per_side; ball <= balls_per_side; ++ball) {
      const double middle = picture.width / 2.0 + ball * spacing;
      for (int x = static_cast<int>(middle - 0.18 * spacing); x <= static_cast<int>(middle + 0.18 * spacing); ++x) {
        sum += columns[static_cast<std::size_t>(std::clamp(x, 0, picture.width - 1))];
        ++count;
      }
    }
    if (sum / count > best) best = sum / count, found = spacing;
  }
  return found;
}

/// A pixel of a mask.
struct Point {
  int column, row;
  double x, y, value, mean;  ///< value, and mean of 3 x 3 pixels, above the background
};

/// Moves the spot with the most light to the front of a mask. Points up to two pixels apart belong to one spot, because
/// grain leaves gaps of one pixel. Returns the first point of the other spots.
std::vector<Point>::iterator brightest_spot_first(std::vector<Point>& points) {
  double most = 0;
  auto first = points.begin(), first_of_most = first, end_of_most = first;
  while (first != points.end()) {
    auto rest = first + 1;
    for (auto at = first; at != rest; ++at) {
      rest = std::partition(rest, points.end(), [&](const Point& p) {
        return std::abs(p.column - at->column) <= 2 && std::abs(p.row - at->row) <= 2;
      });
    }
    double light = 0;
    for (auto p = first; p != rest; ++p) light += p->value;
    if (light > most) most = light, first_of_most = first, end_of_most = rest;
    first = rest;
  }
  return std::rotate(points.begin(), first_of_most, end_of_most);
}

}  // namespace

std::optional<Highlight> highlight_in(const petzval::RgbImage& picture, int first_column, int last_column) {
  const int border = std::max(1, picture.height / 8);
  std::vector<double> luminances;
  for (int y = 0; y < picture.height; ++y) {
    if (y >= border && y < picture.height - border) continue;
    for (int x = first_column; x <= last_column; ++x) luminances.push_back(luminance_at(picture, x, y));
  }
  if (luminances.empty()) return {};
  const double background = quantile(luminances, 0.5);
  std::vector<Point> points;
  std::vector<double> means;
  for (int y = 1; y + 1 < picture.height; ++y) {
    for (int x = std::max(first_column, 1); x <= std::min(last_column, picture.width - 2); ++x) {
      double mean = 0;
      for (int dy : {-1, 0, 1}) {
        for (int dx : {-1, 0, 1}) mean += (luminance_at(picture, x + dx, y + dy) - background) / 9;
      }
      points.push_back({x, y, x + 0.5, y + 0.5, luminance_at(picture, x, y) - background, mean});
      means.push_back(mean);
    }
  }
  if (points.empty()) return {};
  const double least = 0.25 * quantile(means, 0.975);
  if (!(least > 0)) return {};
  std::erase_if(points, [&](const Point& p) { return p.mean <= least; });
  if (points.empty()) return {};

  // Mutual reflections of balls are separate spots.
  Highlight result;
  const auto rest = brightest_spot_first(points);
  for (auto p = rest; p != points.end(); ++p) result.neighbour_light += p->value;
  points.erase(rest, points.end());
  const auto [left, right] = std::minmax_element(points.begin(), points.end(),
                                                 [](const Point& a, const Point& b) { return a.column < b.column; });
  const auto [top, bottom] =
      std::minmax_element(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.row < b.row; });
  result.width = right->column - left->column + 1, result.height = bottom->row - top->row + 1;
  result.whole = left->column > std::max(first_column, 1) && right->column < std::min(last_column, picture.width - 2) &&
                 top->row > 1 && bottom->row < picture.height - 2;
  for (const Point& p : points) result.light += p.value, result.x += p.value * p.x, result.y += p.value * p.y;
  if (!(result.light > 0)) return {};
  result.neighbour_light /= result.light;
  result.x /= result.light, result.y /= result.light;
  const double from_x = result.x - picture.width / 2.0, from_y = result.y - picture.height / 2.0;
  const double radius = std::hypot(from_x, from_y);
  // In the centre the radius is taken along x.
  const double rx = radius > 1 ? from_x / radius : 1, ry = radius > 1 ? from_y / radius : 0;
  double along = 0, across = 0, mixed = 0, cubes = 0;
  for (const Point& p : points) {
    const double a = (p.x - result.x) * rx + (p.y - result.y) * ry, b = (p.y - result.y) * rx - (p.x - result.x) * ry;
    along += p.value * a * a / result.light, across += p.value * b * b / result.light;
    mixed += p.value * a * b / result.light, cubes += p.value * a * a * a / result.light;
  }
  const double middle = (along + across) / 2, half = std::hypot((along - across) / 2, mixed);
  if (!(middle > half)) return {};
  result.axis_ratio = std::sqrt((middle + half) / (middle - half));
  result.to_radius_deg = std::abs(petzval::degrees(std::atan2(2 * mixed, along - across) / 2));
  result.outward_skewness = cubes / (along * std::sqrt(along));
  return result;
}

std::vector<std::optional<Highlight>> ball_highlights(const petzval::RgbImage& picture) {
  const double spacing = spacing_of(picture);
  std::vector<std::optional<Highlight>> result;
  if (!(spacing > 2)) return result;
  for (int ball = -balls_per_side; ball <= balls_per_side; ++ball) {
    const auto [first, last] = columns_of(picture, ball, spacing);
    result.push_back(highlight_in(picture, first, last));
  }
  return result;
}

}  // namespace renderer
