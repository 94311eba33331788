// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace petzval::pupil_table_detail {

/// Index of a wavelength that repeats another one within 1e-6 nm, the tolerance of compile(); nullopt if all differ.
inline std::optional<std::size_t> repeated_wavelength(std::span<const double> wavelengths_nm) {
  std::vector<std::size_t> order(wavelengths_nm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t w) { return wavelengths_nm[w]; });
  const auto found = std::ranges::adjacent_find(
      order, [&](std::size_t a, std::size_t b) { return wavelengths_nm[b] - wavelengths_nm[a] <= 1e-6; });
  return found == order.end() ? std::nullopt : std::optional(std::max(*found, *(found + 1)));
}

}  // namespace petzval::pupil_table_detail
