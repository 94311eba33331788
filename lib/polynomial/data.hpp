// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "loops.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::inline v0 {

struct RayPolynomial::Data {
  template <class R>
  struct In {
    polynomial_detail::Scales<R> scales;
    std::vector<R> coefficients;  ///< by wavelength, as in ToSceneJob
  };

  int degree;
  Domain domain;
  std::vector<Fit> fits;
  std::size_t primary;  ///< position of the primary wavelength
  In<float> in_float{};
  In<double> in_double{};

  Data(int degree, const Domain& domain, std::vector<Fit> fits, std::optional<std::size_t> primary);

  /// Position of the degree in the tables of loops.
  std::size_t loop() const noexcept { return static_cast<std::size_t>(degree - 3) / 2; }
};

namespace polynomial_detail {

template <class R>
const auto& in(const auto& data) noexcept {
  if constexpr (sizeof(R) == sizeof(float)) {
    return data.in_float;
  } else {
    return data.in_double;
  }
}

template <class R>
const ToSceneLoops<R>& to_scene_loops() noexcept {
  if constexpr (sizeof(R) == sizeof(float)) {
    return polynomial_loops().in_float;
  } else {
    return polynomial_loops().in_double;
  }
}

}  // namespace polynomial_detail
}  // namespace petzval::inline v0
