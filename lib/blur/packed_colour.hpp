// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace petzval::blur_detail {

/// Three colours in 64 bits: the upper 21 bits of red and of green, and the upper 22 bits of blue, whose halves fill
/// the lower 11 bits of red and green. Accuracy: within 2^-13 of each colour.
struct PackedColour {
  static constexpr std::uint32_t upper = 0xfffff800, lower = 0x7ff;  ///< bits of red or green, and of half of blue
  static constexpr int first_half = 21, second_half = 10;            ///< shifts of the halves of blue

  float red_blue = 0, green_blue = 0;

  static PackedColour of(float red, float green, float blue) noexcept {
    const auto bits = [](float x, std::uint32_t half) { return std::bit_cast<std::uint32_t>(x) + half; };
    const std::uint32_t b = bits(blue, 0x200);
    return {std::bit_cast<float>((bits(red, 0x400) & upper) | (b >> first_half)),
            std::bit_cast<float>((bits(green, 0x400) & upper) | ((b >> second_half) & lower))};
  }
  std::array<float, 3> unpacked() const noexcept {
    const auto r = std::bit_cast<std::uint32_t>(red_blue), g = std::bit_cast<std::uint32_t>(green_blue);
    return {std::bit_cast<float>(r & upper), std::bit_cast<float>(g & upper),
            std::bit_cast<float>((r & lower) << first_half | (g & lower) << second_half)};
  }
};

}  // namespace petzval::blur_detail
