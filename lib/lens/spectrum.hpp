// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lens_view.hpp"

namespace petzval::lens_detail {

/// The range of some wavelengths, by the rounding of a float wider.
kernel::SpectralPlace<double> spectral_place(std::span<const double> wavelengths_nm);

/// The media of a lens at every wavelength from the smallest to the largest compiled one. Polynomials are fitted to the
/// dispersion formulas themselves, at Chebyshev nodes of the range, so that neither number nor spacing of the compiled
/// wavelengths matters.
class Spectrum {
 public:
  Spectrum() = default;
  explicit Spectrum(std::span<const double> wavelengths_nm);

  /// Adds the medium of the next space. index_at(nm) may throw Error: then the lens has its compiled wavelengths only.
  /// kinks: wavelengths where its slope jumps.
  void add(const std::function<double(double)>& index_at, std::span<const double> kinks = {});

  /// Whether a wavelength lies in the range, or beside it by the rounding of a float.
  bool covers(double nm) const noexcept { return place_.covers(nm); }
  double index(std::size_t space, double nm) const noexcept;
  /// The largest error of an index; infinite without polynomials.
  double error() const noexcept { return error_; }

  const kernel::SpectralPlace<double>& place() const noexcept { return place_; }
  const kernel::SquaredIndex<double>& medium(std::size_t space) const noexcept { return media_[space]; }

 private:
  std::vector<double> compiled_nm_;
  kernel::SpectralPlace<double> place_;
  std::vector<kernel::SquaredIndex<double>> media_;  // [space]
  double error_ = 0;
};

}  // namespace petzval::lens_detail
