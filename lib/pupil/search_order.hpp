// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace petzval::pupil_detail {

/// A point about halfway between two neighbours, from whose pupils its pupil is predicted. The far neighbours continue
/// the same spacing on both sides; equal to `point` if there is no far neighbour.
struct Halfway {
  std::uint32_t point, before, after, far_before, far_after;
};

/// Order in which pupils are searched: some points in full, then the points halfway between them, in rounds.
struct SearchOrder {
  std::vector<std::uint32_t> full;
  std::vector<std::vector<Halfway>> rounds;

  /// Order for points in rows of length `row`; adjacent points of a row have similar pupils.
  static SearchOrder rows(std::size_t points, std::size_t row);
  /// Order for a grid in which adjacent rows have similar pupils: two columns first, then the rows between them.
  static SearchOrder grid(std::size_t rows, std::size_t row);

 private:
  struct Line {
    std::size_t begin, stride, count;

    std::uint32_t at(std::size_t index) const noexcept { return static_cast<std::uint32_t>(begin + stride * index); }
  };
  void halve(const Line& line, std::size_t first_step, std::size_t first_round);
};

}  // namespace petzval::pupil_detail
