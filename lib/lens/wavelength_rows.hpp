// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "lens_view.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval::inline v0::lens_detail {

/// Some numbers for each wavelength, borrowed, for loops over rays of mixed wavelengths: rows of those at the compiled
/// ones, at `cells` + 1 even places of the range, and two of zeros.
template <class R, std::size_t numbers>
struct WavelengthRows {
  static constexpr std::size_t cells = 128;

  const R* rows = nullptr;
  std::int32_t compiled = 0, none = 0;  ///< how many there are of the first, and the first row of zeros
  kernel::SpectralPlace<R> place{};     ///< covers nothing where there are no rows at even places
};

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

/// The most rays that look_up() takes.
inline constexpr std::size_t look_up_block = 64;

/// The numbers of the rays from `begin` on that have wavelengths of their own, at most a block of them: each number of
/// all rays, then the next. Zeros for a wavelength that does not exist.
template <class R, std::size_t numbers>
inline void look_up(const WavelengthRows<R, numbers>& table, const RayWavelengths& wavelengths, std::size_t begin,
                    std::size_t count, R (&to)[numbers][look_up_block]) noexcept {
  const R* const rows = table.rows;
  const std::int32_t compiled = table.compiled, none = table.none;
  std::int32_t row[look_up_block];
  if (const float* const nm = wavelengths.each_nm) {
    const auto place = table.place;
    R part[look_up_block];
    for (std::size_t i = 0; i < count; ++i) {
      constexpr R cells = WavelengthRows<R, numbers>::cells;
      const R own = static_cast<R>(nm[begin + i]);
      const bool covered = (own >= place.shortest) & (own <= place.longest);
      const R at = (place.at(covered ? own : place.longest) + R(1)) * (cells / 2);
      const auto cell = static_cast<std::int32_t>(at < cells - 1 ? at : cells - 1);
      row[i] = covered ? compiled + cell : none;
      part[i] = covered ? at - static_cast<R>(cell) : R(0);
    }
    for (std::size_t k = 0; k < numbers; ++k) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t o = static_cast<std::size_t>(row[i]) * numbers + k;
        to[k][i] = rows[o] + part[i] * (rows[o + numbers] - rows[o]);
      }
    }
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t position = wavelengths.each[begin + i];
    row[i] = position < compiled ? position : none;
  }
  for (std::size_t k = 0; k < numbers; ++k) {
    for (std::size_t i = 0; i < count; ++i) to[k][i] = rows[static_cast<std::size_t>(row[i]) * numbers + k];
  }
}

}  // namespace
}  // namespace petzval::inline v0::lens_detail
