// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "petzval/core/version.hpp"

namespace petzval {

/// A wavelength of a lens: a position in Lens::wavelengths_nm(), by default that of the primary wavelength wherever it
/// stands, or any wavelength between the smallest and the largest compiled one, in nm.
///
///     first_order(lens);                                     // at the primary wavelength
///     first_order(lens, 2);                                  // at the third one
///     first_order(lens, Wavelength::nm(546.1));              // between those that were compiled
///     first_order(lens, lens.wavelength(486.1327));          // at the F line, which has to be compiled
///     first_order(lens, lens.nearest_wavelength(510));       // at the compiled one nearest to 510 nm
///
/// Indices and exact rays take any wavelength (Lens::index_error() says how well), and so does what follows from
/// indices alone, as first_order() and pupils() do. Cameras take them too (Camera says how well). Functions that search
/// for pupils take compiled ones, of nm within 1e-6 nm.
class Wavelength {
 public:
  constexpr Wavelength() noexcept = default;
  constexpr Wavelength(std::size_t position) noexcept : position_(position < by_nm ? position : none) {}
  /// What is no position is no wavelength either: nm() takes those.
  template <class T>
    requires(std::floating_point<T> || std::same_as<T, bool>)
  Wavelength(T)
  = delete;
  static constexpr Wavelength nm(double nm) noexcept {
    Wavelength result;
    result.position_ = by_nm;
    result.nm_ = nm;
    return result;
  }

  /// The position, for a lens whose primary wavelength stands at `of_primary`. Positions are not checked. Of one in nm,
  /// a position that no lens has: Lens::position() looks it up.
  constexpr std::size_t position(std::size_t of_primary) const noexcept {
    return position_ == primary ? of_primary : position_ == by_nm ? none : position_;
  }
  /// What was given in nm.
  constexpr std::optional<double> in_nm() const noexcept {
    return position_ == by_nm ? std::optional(nm_) : std::nullopt;
  }

 private:
  static constexpr std::size_t primary = static_cast<std::size_t>(-1), none = primary - 1, by_nm = primary - 2;

  std::size_t position_ = primary;
  double nm_ = 0;
};

/// The wavelengths of N rays: one for all, or one each.
struct RayWavelengths {
  Wavelength all{};
  const std::uint16_t* each = nullptr;  ///< N positions, instead of `all`
  const float* each_nm = nullptr;       ///< N wavelengths in nm, instead of both

  /// That of one ray.
  constexpr Wavelength at(std::size_t ray) const noexcept {
    return each_nm ? Wavelength::nm(double{each_nm[ray]}) : each ? Wavelength(each[ray]) : all;
  }
  /// Its position; of_primary: as for Wavelength.
  constexpr std::size_t position(std::size_t ray, std::size_t of_primary) const noexcept {
    return at(ray).position(of_primary);
  }
  /// Whether they are given in nm.
  constexpr bool in_nm() const noexcept { return each_nm || (!each && all.in_nm()); }
  /// The same wavelengths by position, or in nm.
  constexpr RayWavelengths resolved(std::size_t of_primary) const noexcept {
    return {all.in_nm() ? all : Wavelength(all.position(of_primary)), each, each_nm};
  }
  /// The wavelengths of the rays from a position on.
  constexpr RayWavelengths from(std::size_t ray) const noexcept {
    return {all, each ? each + ray : nullptr, each_nm ? each_nm + ray : nullptr};
  }
};

}  // namespace petzval
