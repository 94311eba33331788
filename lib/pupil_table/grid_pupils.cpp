// SPDX-License-Identifier: Apache-2.0
#include "grid_pupils.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace petzval::pupil_table_detail {
namespace {

using pupil_detail::PupilGuess;
using pupil_detail::SearchOrder;

/// Finds the pupils of points in rows.
class PupilFinder {
 public:
  PupilFinder(const GridOfPoints& grid, std::size_t directions, const pupil_detail::PositionClearances& clearances)
      : guesses_(grid.guesses), row_(grid.row), directions_(directions), clearances_(clearances) {}

  std::vector<PupilRegion> operator()() {
    const auto order =
        row_ == 1 ? SearchOrder::rows(guesses_.size(), 1) : SearchOrder::grid(guesses_.size() / row_, row_);
    std::vector<PupilRegion> pupils = pupil_detail::find_regions(guesses_, order, directions_, false, clearances_);
    // If the chief ray is lost, other rays may pass: search near the pupils of neighbours, or everywhere if no
    // neighbour has a pupil.
    if (std::all_of(pupils.begin(), pupils.end(), [](const PupilRegion& p) { return p.empty(); })) {
      std::vector<std::uint32_t> ends;
      for (std::size_t i = 0; i < guesses_.size(); ++i) {
        if (i % row_ == 0 || i % row_ == row_ - 1) ends.push_back(static_cast<std::uint32_t>(i));
      }
      std::vector<Box> boxes;
      for (const std::uint32_t i : ends) {
        const PupilGuess& g = guesses_[i];
        const double half = (g.high - g.low) / 2;
        boxes.push_back({g.x, g.low + half, half, half});
      }
      look_again(pupils, ends, boxes, 64);
    }
    std::vector<bool> looked(guesses_.size(), false);
    for (bool found = true; found;) {
      std::vector<std::uint32_t> dark;
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < guesses_.size(); ++i) {
        if (looked[i] || !pupils[i].empty()) continue;
        const auto neighbour_box = lit_neighbour(pupils, i);
        if (!neighbour_box) continue;
        looked[i] = true;
        dark.push_back(static_cast<std::uint32_t>(i));
        boxes.push_back(*neighbour_box);
      }
      found = look_again(pupils, dark, boxes, 24);
    }
    return pupils;
  }

 private:
  struct Box {
    double x, y, half_x, half_y;
  };

  /// The search box: centred at the extrapolated pupil of a neighbour, and of the size of this pupil.
  std::optional<Box> lit_neighbour(const std::vector<PupilRegion>& pupils, std::size_t i) const {
    const std::size_t column = i % row_;
    const auto lit = [&](std::size_t at) { return at < pupils.size() && !pupils[at].empty(); };
    const auto neighbour_box = [&](std::size_t near, std::size_t far, bool has_far) {
      const PupilRegion& p = pupils[near];
      Vec2<double> middle = p.middle;
      if (has_far && lit(far)) middle = middle + (p.middle - pupils[far].middle);
      constexpr double box_scale = 1.6;
      return Box{middle.x, middle.y, box_scale * p.half_axes.x, box_scale * p.half_axes.y};
    };
    if (column > 0 && lit(i - 1)) return neighbour_box(i - 1, i - 2, column > 1);
    if (i >= row_ && lit(i - row_)) return neighbour_box(i - row_, i - 2 * row_, i >= 2 * row_);
    if (column + 1 < row_ && lit(i + 1)) return neighbour_box(i + 1, i + 2, column + 2 < row_);
    if (lit(i + row_)) return neighbour_box(i + row_, i + 2 * row_, true);
    return {};
  }

  /// Tests positions in the whole search boxes of some points, and finds the pupils of points for which a ray passes.
  bool look_again(std::vector<PupilRegion>& pupils, const std::vector<std::uint32_t>& which,
                  const std::vector<Box>& boxes, int side) {
    std::vector<std::uint32_t> points;
    std::vector<double> x, y;
    for (std::size_t j = 0; j < which.size(); ++j) {
      for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
          points.push_back(which[j]);
          x.push_back(boxes[j].x + boxes[j].half_x * ((2 * column + 1.0) / side - 1));
          y.push_back(boxes[j].y + boxes[j].half_y * ((2 * row + 1.0) / side - 1));
        }
      }
    }
    std::vector<double> values(x.size());
    if (!x.empty()) clearances_(x.size(), points.data(), x.data(), y.data(), values.data());
    std::vector<std::uint32_t> lit;
    std::vector<PupilGuess> guesses;
    for (std::size_t j = 0; j < which.size(); ++j) {
      const std::size_t begin = j * static_cast<std::size_t>(side * side), end = begin + side * side;
      double sum_x = 0, sum_y = 0;
      int count = 0;
      for (std::size_t i = begin; i < end; ++i) {
        if (values[i] >= 0) sum_x += x[i], sum_y += y[i], ++count;
      }
      if (count == 0) continue;
      // Take the passing position nearest to the mean of all passing positions.
      std::size_t best = end;
      const auto away = [&](std::size_t i) { return std::hypot(x[i] - sum_x / count, y[i] - sum_y / count); };
      for (std::size_t i = begin; i < end; ++i) {
        if (values[i] >= 0 && (best == end || away(i) < away(best))) best = i;
      }
      PupilGuess guess = guesses_[which[j]];
      guess.x = x[best], guess.y = y[best];
      guess.radius = std::max(boxes[j].half_x, boxes[j].half_y);
      guess.near = 2 * boxes[j].half_y;
      lit.push_back(which[j]);
      guesses.push_back(guess);
    }
    if (lit.empty()) return false;
    const pupil_detail::PositionClearances of_lit = [&](std::size_t count, const std::uint32_t* index, const double* px,
                                                        const double* py, double* found_clearances) {
      points.resize(count);
      for (std::size_t i = 0; i < count; ++i) points[i] = lit[index[i]];
      clearances_(count, points.data(), px, py, found_clearances);
    };
    const auto found =
        pupil_detail::find_regions(guesses, SearchOrder::rows(guesses.size(), 1), directions_, false, of_lit);
    for (std::size_t i = 0; i < lit.size(); ++i) pupils[lit[i]] = found[i];
    return true;
  }

  std::span<const PupilGuess> guesses_;
  std::size_t row_, directions_;
  const pupil_detail::PositionClearances& clearances_;
};

}  // namespace

std::vector<PupilRegion> grid_pupils(const GridOfPoints& grid, std::size_t directions,
                                     const pupil_detail::PositionClearances& clearances) {
  return PupilFinder(grid, directions, clearances)();
}

}  // namespace petzval::pupil_table_detail
