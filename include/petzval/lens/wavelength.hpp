// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "petzval/core/version.hpp"

namespace petzval::inline v0 {

/// One of the wavelengths that a lens was compiled for: a position in Lens::wavelengths_nm(), or by default the primary
/// wavelength of the lens, at whatever position it stands.
///
///     first_order(lens);                                     // at the primary wavelength
///     first_order(lens, 2);                                  // at the third one
///     first_order(lens, lens.wavelength(486.1327));          // at the F line, which has to be compiled
///     first_order(lens, lens.nearest_wavelength(510));       // at the compiled one nearest to 510 nm
class Wavelength {
 public:
  constexpr Wavelength() noexcept = default;
  constexpr Wavelength(std::size_t position) noexcept : position_(position < primary ? position : primary - 1) {}

  /// The position, for a lens whose primary wavelength stands at `of_primary`. Positions are not checked.
  constexpr std::size_t position(std::size_t of_primary) const noexcept {
    return position_ == primary ? of_primary : position_;
  }

 private:
  static constexpr std::size_t primary = static_cast<std::size_t>(-1);
  std::size_t position_ = primary;
};

/// The wavelengths of N rays: one for all, or one each.
struct RayWavelengths {
  Wavelength all{};
  const std::uint16_t* each = nullptr;  ///< N positions, instead of `all`

  /// The position for one ray; of_primary: as for Wavelength.
  constexpr std::size_t position(std::size_t ray, std::size_t of_primary) const noexcept {
    return each ? each[ray] : all.position(of_primary);
  }
  /// The same wavelengths by position.
  constexpr RayWavelengths resolved(std::size_t of_primary) const noexcept { return {all.position(of_primary), each}; }
  /// The wavelengths of the rays from a position on.
  constexpr RayWavelengths from(std::size_t ray) const noexcept { return {all, each ? each + ray : nullptr}; }
};

}  // namespace petzval::inline v0
