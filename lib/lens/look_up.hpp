// SPDX-License-Identifier: Apache-2.0
// Numbers per ray for mixed wavelengths. For sources compiled once per instruction set, like core/simd.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/look_up.hpp"
#include "petzval/lens/wavelength.hpp"
#include "wavelength_rows.hpp"

namespace petzval::lens_detail {
namespace {

/// Largest number of rays per call of look_up().
inline constexpr std::size_t look_up_block = 64;

/// Positions for one register of rays.
using Positions = std::uint16_t __attribute__((vector_size(core_detail::lane_bytes / 2)));

/// Looks up the first `used` numbers of rays with individual wavelengths, from ray `begin` on, at most look_up_block
/// rays. Written as to[number][ray]; zeros if a wavelength does not exist.
template <class R, std::size_t numbers>
inline void look_up(const WavelengthRows<R>& given, const RayWavelengths& wavelengths, std::size_t begin,
                    std::size_t count, R (&to)[numbers][look_up_block], std::size_t used = numbers) noexcept {
  using Native = core_detail::Native<R>;
  using Values = typename Native::Values;
  using Bits = typename Native::Bits;
  constexpr std::size_t lanes = core_detail::lane_count<R>;
  const WavelengthRows<R> table = given;  // a copy, which writes cannot alias
  const auto store = [&](std::size_t k, std::size_t o, const Values& values) {
    __builtin_memcpy(&to[k][o], &values, sizeof values);
  };
  // Compute the table positions of all rays first, in loops that vectorise best if the number of rays is a constant.
  typename Native::Bit indices[look_up_block];
  const auto for_each = [&](const auto& body) {
    if (count == look_up_block) {
      for (std::size_t i = 0; i < look_up_block; ++i) body(i);
    } else {
      for (std::size_t i = 0; i < count; ++i) body(i);
      for (std::size_t i = count; i < (count + lanes - 1) / lanes * lanes; ++i) indices[i] = 0;
    }
  };
  if (const float* const nm = wavelengths.each_nm) {
    R fractions[look_up_block] = {};
    const std::int32_t last = table.cells - 1;
    for_each([&](std::size_t i) {
      const R own = static_cast<R>(nm[begin + i]);
      const bool covered = (own >= table.shortest) & (own <= table.longest);
      const R at = covered ? (own - table.shortest) * table.cells_per_nm : R(0);
      const auto cell = static_cast<std::int32_t>(at < static_cast<R>(last) ? at : static_cast<R>(last));
      indices[i] = covered ? cell : last + 1;
      fractions[i] = at - static_cast<R>(cell);
    });
    const auto sum = [&](auto in_cells) {
      for (std::size_t o = 0; o < count; o += lanes) {
        Bits at;
        Values fraction;
        __builtin_memcpy(&at, indices + o, sizeof at);
        __builtin_memcpy(&fraction, fractions + o, sizeof fraction);
        const R* row = table.by_nm;
        for (std::size_t k = 0; k < used; ++k, row += 3 * table.cell_length) {
          const auto power = [&](std::size_t p) {
            return core_detail::look_up(row + p * table.cell_length, in_cells, at);
          };
          store(k, o, power(0) + fraction * (power(1) + fraction * power(2)));
        }
      }
    };
    if (table.cells == permuted_cells) {
      sum(std::integral_constant<std::size_t, permuted_cells + 1>());
    } else {
      sum(static_cast<std::size_t>(table.cells) + 1);
    }
    return;
  }
  for_each([&](std::size_t i) {
    const std::int32_t position = wavelengths.each[begin + i];
    indices[i] = position < table.compiled ? position : table.compiled;
  });
  const auto known = static_cast<std::size_t>(table.compiled) + 1;
  for (std::size_t o = 0; o < count; o += lanes) {
    Bits at;
    __builtin_memcpy(&at, indices + o, sizeof at);
    for (std::size_t k = 0; k < used; ++k) {
      store(k, o, core_detail::look_up(table.by_position + k * table.length, known, at));
    }
  }
}

/// Finds the compiled wavelength nearest to each of `count` wavelengths (nm); 65535 if a wavelength is not covered.
inline void find_nearest(const NearestPosition& nearest, std::size_t count, const float* nm,
                         std::uint16_t* positions) noexcept {
  using Native = core_detail::Native<float>;
  constexpr std::size_t lanes = core_detail::lane_count<float>;
  const auto find = [&](std::size_t o, std::size_t n) {
    Native::Values own{};
    __builtin_memcpy(&own, nm + o, n * sizeof(float));
    Native::Bits found = Native::Bits{} + nearest.first;
    for (std::size_t k = 0; k < nearest.count; ++k) {
      const auto [middle, added] = nearest.steps[k];
      found += (own > middle) & added;
    }
    const Native::Bits covered = (own >= nearest.shortest) & (own <= nearest.longest);
    found = covered ? found : Native::Bits{} + 65535;
    const auto narrow = __builtin_convertvector(found, Positions);
    __builtin_memcpy(positions + o, &narrow, n * sizeof(std::uint16_t));
  };
  std::size_t o = 0;
  for (; o + lanes <= count; o += lanes) find(o, lanes);
  if (o < count) find(o, count - o);
}

}  // namespace
}  // namespace petzval::lens_detail
