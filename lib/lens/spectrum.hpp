// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lens_view.hpp"

namespace petzval::lens_detail {

/// The range of wavelengths, extended by the rounding of a float.
kernel::SpectralCoordinate<double> spectral_coordinate(std::span<const double> wavelengths_nm);

/// The indices of the media of a lens at every wavelength from the shortest to the longest compiled wavelength.
/// Polynomials are fitted to the dispersion formulas themselves, at Chebyshev nodes of the range; the number and
/// spacing of the compiled wavelengths therefore do not matter.
class Spectrum {
 public:
  Spectrum() = default;
  explicit Spectrum(std::span<const double> wavelengths_nm);

  /// Adds the medium of the next space.
  /// @param index_at index at a wavelength (nm); if it throws Error, only the compiled wavelengths are covered
  /// @param kinks wavelengths at which the slope jumps
  void add(const std::function<double(double)>& index_at, std::span<const double> kinks = {});

  /// The same spectrum for spaces in another order.
  Spectrum along(std::span<const std::size_t> spaces) const {
    Spectrum result = *this;
    result.media_.clear();
    for (const std::size_t space : spaces) result.media_.push_back(media_[space]);
    return result;
  }

  /// True if a wavelength lies in the range, extended by the rounding of a float.
  bool covers(double nm) const noexcept { return coordinate_.covers(nm); }
  double index(std::size_t space, double nm) const noexcept;
  /// Largest error of an index; infinite if there are no polynomials.
  double error() const noexcept { return error_; }

  const kernel::SpectralCoordinate<double>& coordinate() const noexcept { return coordinate_; }
  const kernel::SquaredIndex<double>& medium(std::size_t space) const noexcept { return media_[space]; }

 private:
  std::vector<double> compiled_nm_;
  kernel::SpectralCoordinate<double> coordinate_;
  std::vector<kernel::SquaredIndex<double>> media_;  // [space]
  double error_ = 0;
};

}  // namespace petzval::lens_detail
