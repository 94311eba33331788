// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "petzval/core/config.hpp"

namespace petzval {

/// A wavelength of a lens: an index into Lens::wavelengths_nm(), or any value in nm within the compiled range.
///
///     first_order(lens);                                     // the primary wavelength
///     first_order(lens, 2);                                  // the third compiled wavelength
///     first_order(lens, Wavelength::nm(546.1));              // any wavelength within the compiled range
///     first_order(lens, lens.wavelength_index(Wavelength::nm(486.1327)));  // the F line, which must be compiled
///     first_order(lens, lens.nearest_wavelength(510));       // the compiled wavelength nearest to 510 nm
///
/// Indices, exact rays, cameras and paraxial functions such as first_order() and pupils() accept any wavelength within
/// the range; Lens::index_error() and Camera state the error. Functions that search for pupils accept compiled
/// wavelengths only (values in nm within 1e-6 nm).
class Wavelength {
 public:
  constexpr Wavelength() noexcept = default;
  constexpr Wavelength(std::size_t index) noexcept : index_(index < by_nm ? index : none) {}
  /// Deleted, because a floating-point number is no wavelength index: nm() accepts values in nm.
  template <class T>
    requires(std::floating_point<T> || std::same_as<T, bool>)
  Wavelength(T)
  = delete;
  static constexpr Wavelength nm(double nm) noexcept {
    Wavelength result;
    result.index_ = by_nm;
    result.nm_ = nm;
    return result;
  }

  /// The wavelength index for a lens with primary wavelength `of_primary`; not checked.
  ///
  /// An invalid index for a value in nm; Lens::wavelength_index() finds the index of a compiled value.
  constexpr std::size_t index(std::size_t of_primary) const noexcept {
    return index_ == primary ? of_primary : index_ == by_nm ? none : index_;
  }
  /// The value in nm; nullopt if the wavelength is given by index.
  constexpr std::optional<double> in_nm() const noexcept { return index_ == by_nm ? std::optional(nm_) : std::nullopt; }

 private:
  static constexpr std::size_t primary = static_cast<std::size_t>(-1), none = primary - 1, by_nm = primary - 2;

  std::size_t index_ = primary;
  double nm_ = 0;
};

/// The wavelengths of N rays: one for all rays, or one for each ray.
struct RayWavelengths {
  Wavelength all{};
  const std::uint16_t* each = nullptr;  ///< N wavelength indices, used instead of `all`; or nullptr
  const float* each_nm = nullptr;       ///< N values in nm, used instead of `all` and `each`; or nullptr

  /// The wavelength of one ray.
  constexpr Wavelength at(std::size_t ray) const noexcept {
    return each_nm ? Wavelength::nm(double{each_nm[ray]}) : each ? Wavelength(each[ray]) : all;
  }
  /// The wavelength index of one ray, as by Wavelength::index().
  constexpr std::size_t index(std::size_t ray, std::size_t of_primary) const noexcept {
    return at(ray).index(of_primary);
  }
  /// True if the wavelengths are given in nm.
  constexpr bool in_nm() const noexcept { return each_nm || (!each && all.in_nm()); }
  /// True if all rays have the wavelength `all`.
  constexpr bool shared() const noexcept { return !each && !each_nm; }
  /// The same wavelengths, with the index of the primary wavelength filled in.
  constexpr RayWavelengths resolved(std::size_t of_primary) const noexcept {
    return {all.in_nm() ? all : Wavelength(all.index(of_primary)), each, each_nm};
  }
  /// The wavelengths of the rays from `ray` on.
  constexpr RayWavelengths from(std::size_t ray) const noexcept {
    return {all, each ? each + ray : nullptr, each_nm ? each_nm + ray : nullptr};
  }
};

}  // namespace petzval
