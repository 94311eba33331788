// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "lens/between_wavelengths.hpp"
#include "loops.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {

struct RayPolynomial::Data {
  template <class R>
  struct In {
    polynomial_detail::Scales<R> scales;
    polynomial_detail::Scales<R> empty_domain;  ///< film points become NaN
    std::vector<R> coefficients = {};           ///< by wavelength, as in ToSceneJob
    lens_detail::AlignedRows<R> rows = {};      ///< the coefficients in rows, one row per coefficient
    std::vector<R> modes = {};                  ///< coefficients by mode
  };

  int degree;
  Domain domain;
  std::vector<Fit> fits;
  std::size_t primary;  ///< position of the primary wavelength
  lens_detail::CompiledWavelengths wavelengths;
  std::size_t modes;  ///< number of modes
  lens_detail::BetweenWavelengths<polynomial_detail::most_modes> mode_weights;
  std::tuple<In<float>, In<double>> in{};

  Data(int degree, const Domain& domain, std::vector<Fit> fits, std::optional<std::size_t> primary);

  /// Coefficients at a wavelength; null if there is no fit.
  /// @param nm buffer for interpolated coefficients
  template <class R>
  struct CoefficientBuffer {
    std::array<R, polynomial_detail::most_coefficients> coefficients;
  };
  template <class R>
  const R* coefficients(Wavelength wavelength, CoefficientBuffer<R>& nm) const noexcept;
  /// A fit and the domain in which it holds. If there is no fit, the domain contains no line, and the coefficients are
  /// those of another fit.
  template <class R>
  struct Fitted {
    const R* coefficients;
    const polynomial_detail::Scales<R>& scales;
  };
  template <class R>
  Fitted<R> fitted(Wavelength wavelength, CoefficientBuffer<R>& nm) const noexcept {
    const In<R>& all = std::get<In<R>>(in);
    const R* const found = coefficients(wavelength, nm);
    return {found ? found : all.coefficients.data(), found ? all.scales : all.empty_domain};
  }

  /// Index of symmetry and degree in the tables of loops.
  std::size_t loop() const noexcept {
    return static_cast<std::size_t>(degree - 3) / 2 + (domain.along_x ? polynomial_detail::degree_count : 0);
  }
};

namespace polynomial_detail {

/// @throws Error  prefixed with `where` if no fit has this degree
void check_degree(const std::string& where, int degree);

/// Shift and radius of the pupil along x and y.
inline std::array<RayPolynomial::Domain::Section, 2> sections(const RayPolynomial::Domain& domain) noexcept {
  const RayPolynomial::Domain::Section along_y{domain.pupil_shift, domain.pupil_radius};
  return {domain.along_x.value_or(along_y), along_y};
}

}  // namespace polynomial_detail

template <class R>
const R* RayPolynomial::Data::coefficients(Wavelength wavelength, CoefficientBuffer<R>& buffer) const noexcept {
  const std::vector<R>& all = std::get<In<R>>(in).coefficients;
  const std::size_t each = all.size() / fits.size();
  const auto nm = wavelength.in_nm();
  if (!nm) {
    const std::size_t position = wavelength.position(primary);
    return position < fits.size() ? all.data() + position * each : nullptr;
  }
  if (!wavelengths.covers(*nm)) return nullptr;
  const auto weights = mode_weights(*nm);
  const R* mode = std::get<In<R>>(in).modes.data();
  std::fill_n(buffer.coefficients.begin(), each, R(0));
  for (std::size_t k = 0; k < modes; ++k, mode += each) {
    const R weight = static_cast<R>(weights[k]);
    for (std::size_t i = 0; i < each; ++i) buffer.coefficients[i] += weight * mode[i];
  }
  return buffer.coefficients.data();
}

}  // namespace petzval
