// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace petzval::inline v0 {

/// The wavelengths of N rays, as positions among the compiled ones: one for all, or one each.
struct RayWavelengths {
  std::size_t all = 0;
  const std::uint16_t* each = nullptr;  ///< N, instead of `all`

  std::size_t operator[](std::size_t ray) const noexcept { return each ? each[ray] : all; }
  /// Of the rays from a position on.
  RayWavelengths from(std::size_t ray) const noexcept { return {all, each ? each + ray : nullptr}; }
};

}  // namespace petzval::inline v0
