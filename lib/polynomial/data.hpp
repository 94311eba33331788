// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "lens/between_wavelengths.hpp"
#include "loops.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {
namespace polynomial_detail {

/// @throws Error  prefixed with `where` if no fit has this degree
void check_degree(const std::string& where, int degree);

/// Shift and radius of the pupil along x and y.
inline std::array<RayPolynomial::Domain::Section, 2> sections(const RayPolynomial::Domain& domain) noexcept {
  const RayPolynomial::Domain::Section along_y{domain.pupil_shift, domain.pupil_radius};
  return {domain.along_x.value_or(along_y), along_y};
}

template <class R>
Scales<R> scales_of(const RayPolynomial::Domain& domain) noexcept {
  const auto scales = [](const RayPolynomial::Domain::Section& section) {
    return typename Scales<R>::Section{static_cast<R>(section.pupil_shift), static_cast<R>(1 / section.pupil_radius)};
  };
  const auto [along_x, along_y] = sections(domain);
  return {static_cast<R>(1 / domain.film_radius), static_cast<R>(domain.reference_z), scales(along_x), scales(along_y)};
}

/// The fits of all wavelengths, in both precisions.
class WavelengthFits {
 public:
  /// Coefficients at a wavelength between fits.
  template <class R>
  using Buffer = std::array<R, most_coefficients>;
  /// A fit and the domain in which it holds.
  template <class R>
  struct Fitted {
    const R* coefficients;
    const Scales<R>& scales;
  };

  /// No fits.
  WavelengthFits() = default;
  /// @param wavelengths_nm, coefficients by position of the wavelength
  /// @param primary position of the primary wavelength
  /// @param tolerances as in find_modes()
  WavelengthFits(const RayPolynomial::Domain& domain, std::span<const double> wavelengths_nm, std::size_t primary,
                 const std::vector<std::vector<double>>& coefficients, const std::array<double, 2>& tolerances);

  /// Coefficients at a wavelength; null if there is no fit.
  template <class R>
  const R* coefficients(Wavelength wavelength, Buffer<R>& between) const noexcept;
  /// The fit of a wavelength; if there is no such fit, the coefficients of another fit and a domain without lines.
  template <class R>
  Fitted<R> fitted(Wavelength wavelength, Buffer<R>& between) const noexcept {
    const In<R>& all = std::get<In<R>>(in_);
    const R* const found = coefficients(wavelength, between);
    return {found ? found : all.coefficients.data(), found ? all.scales : all.empty_domain};
  }
  /// The job of a batch, without its rays.
  template <class R>
  Job<R> job(std::size_t count, const RayWavelengths& wavelengths, Buffer<R>& between) const noexcept {
    const In<R>& all = std::get<In<R>>(in_);
    const auto [own, scales] = fitted<R>(wavelengths.shared() ? wavelengths.all : Wavelength(0), between);
    return {.coefficients = own,
            .rows = all.rows.data(),
            .row_length = all.rows.length(),
            .fits = count_,
            .modes = {all.modes.data(), modes_, mode_weights_.rows<R>()},
            .scales = scales,
            .count = count,
            .wavelengths = wavelengths,
            .in = {},
            .out = {},
            .fates = nullptr};
  }

 private:
  template <class R>
  struct In {
    Scales<R> scales;
    Scales<R> empty_domain;            ///< film points become NaN
    std::vector<R> coefficients;       ///< by wavelength, as in Job
    lens_detail::AlignedRows<R> rows;  ///< the coefficients in rows, one row per coefficient
    std::vector<R> modes;              ///< coefficients by mode
  };

  std::size_t count_ = 0, primary_ = 0;
  lens_detail::CompiledWavelengths wavelengths_;
  std::size_t modes_ = 0;  ///< number of modes
  lens_detail::BetweenWavelengths<most_modes> mode_weights_;
  std::tuple<In<float>, In<double>> in_{};
};

}  // namespace polynomial_detail

struct RayPolynomial::Data {
  int degree;
  Domain domain;
  std::vector<Fit> fits;
  polynomial_detail::WavelengthFits by_wavelength;

  Data(int degree, const Domain& domain, std::vector<Fit> fits, std::size_t primary);

  /// Index of symmetry and degree in the tables of loops.
  std::size_t loop() const noexcept {
    return static_cast<std::size_t>(degree - 3) / 2 + (domain.along_x ? polynomial_detail::degree_count : 0);
  }
};

template <class R>
const R* polynomial_detail::WavelengthFits::coefficients(Wavelength wavelength, Buffer<R>& between) const noexcept {
  const In<R>& in = std::get<In<R>>(in_);
  const std::size_t each = in.coefficients.size() / count_;
  const auto nm = wavelength.in_nm();
  if (!nm) {
    const std::size_t position = wavelength.index(primary_);
    return position < count_ ? in.coefficients.data() + position * each : nullptr;
  }
  if (!wavelengths_.covers(*nm)) return nullptr;
  const auto weights = mode_weights_(*nm);
  const R* mode = in.modes.data();
  std::fill_n(between.begin(), each, R(0));
  for (std::size_t k = 0; k < modes_; ++k, mode += each) {
    const R weight = static_cast<R>(weights[k]);
    for (std::size_t i = 0; i < each; ++i) between[i] += weight * mode[i];
  }
  return between.data();
}

}  // namespace petzval
