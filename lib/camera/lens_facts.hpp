// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::camera_detail {

/// True if the two sections of a lens differ.
inline bool has_cylinders(const Lens& lens) noexcept {
  const auto surfaces = lens.surfaces();
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](const LensSurface& s) { return s.curved_in != Section::both; });
}

/// First-order data of a lens at each wavelength, shared by the components of a camera.
class LensFacts {
 public:
  LensFacts(const Lens& lens) : lens_(lens) {
    for (std::size_t w = 0; w < wavelengths(); ++w) {
      first_order_.push_back(petzval::first_order(lens, w));
      pupils_.push_back(petzval::has_pupils(lens) ? std::optional(petzval::pupils(lens, w)) : std::nullopt);
    }
  }

  const Lens& lens() const noexcept { return lens_; }
  std::size_t wavelengths() const noexcept { return lens_.wavelengths_nm().size(); }
  /// In the section along y.
  const FirstOrder& first_order(std::size_t wavelength) const { return first_order_[wavelength]; }
  /// In the section along y.
  /// @throws Error  as petzval::pupils()
  Pupils pupils(std::size_t wavelength) const {
    return pupils_[wavelength] ? *pupils_[wavelength] : petzval::pupils(lens_, wavelength);
  }
  bool has_pupils() const noexcept { return petzval::has_pupils(lens_); }

 private:
  Lens lens_;
  std::vector<FirstOrder> first_order_;
  std::vector<std::optional<Pupils>> pupils_;
};

}  // namespace petzval::camera_detail
