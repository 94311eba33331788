// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace petzval::pupil_detail {

/// A point about halfway between two others, where its pupil is looked for next to theirs. The farther two are as far
/// again from these on both sides; the point itself: there is none.
struct Halfway {
  std::uint32_t point, before, after, far_before, far_after;
};

/// In which order pupils are looked for: some points in full, then those halfway between, round after round.
struct SearchOrder {
  std::vector<std::uint32_t> full;
  std::vector<std::vector<Halfway>> rounds;

  /// Points stand in rows of so many, in which neighbours have similar pupils.
  static SearchOrder rows(std::size_t points, std::size_t row);
  /// In neighbouring rows too: two columns of the grid are found first, and the rows from there.
  static SearchOrder grid(std::size_t rows, std::size_t row);

 private:
  struct Line {
    std::size_t begin, stride, count;

    std::uint32_t at(std::size_t place) const noexcept { return static_cast<std::uint32_t>(begin + stride * place); }
  };
  void halve(const Line& line, std::size_t first_step, std::size_t first_round);
};

}  // namespace petzval::pupil_detail
