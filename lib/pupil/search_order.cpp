// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>

#include "boundary_search.hpp"

namespace petzval::pupil_detail {

SearchOrder SearchOrder::rows(std::size_t points, std::size_t row) {
  SearchOrder order;
  constexpr std::size_t first_step = 32;
  for (std::size_t begin = 0; begin < points; begin += row) {
    const Line line{begin, 1, row};
    for (std::size_t i = 0; i < row; ++i) {
      if (i % first_step == 0 || i + 1 == row) order.full.push_back(line.at(i));
    }
    order.halve(line, first_step, 0);
  }
  return order;
}

SearchOrder SearchOrder::grid(std::size_t rows, std::size_t row) {
  SearchOrder order;
  for (const std::size_t column : {std::size_t{0}, row - 1}) {
    const Line line{column, row, rows};
    order.full.insert(order.full.end(), {line.at(0), line.at(rows - 1)});
    order.halve(line, std::bit_ceil(rows - 1), 0);
  }
  const std::size_t columns_done = order.rounds.size();
  for (std::size_t i = 0; i < rows; ++i) order.halve({i * row, 1, row}, std::bit_ceil(row - 1), columns_done);
  return order;
}

void SearchOrder::halve(const Line& line, std::size_t first_step, std::size_t first_round) {
  std::size_t round = first_round;
  for (std::size_t step = first_step; step > 1; step /= 2, ++round) {
    if (rounds.size() <= round) rounds.resize(round + 1);
    for (std::size_t i = step / 2; i + 1 < line.count; i += step) {
      const std::size_t half = step / 2, after = std::min(i + half, line.count - 1);
      const bool even = after == i + half;
      rounds[round].push_back({line.at(i), line.at(i - half), line.at(after),
                               line.at(even && i >= 3 * half ? i - 3 * half : i),
                               line.at(even && i + 3 * half < line.count ? i + 3 * half : i)});
    }
  }
}

}  // namespace petzval::pupil_detail
