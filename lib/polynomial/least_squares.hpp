// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::inline v0::polynomial_detail {

/// Lines of film points on the axis +y; all others are these, turned about the axis.
struct MeridianLines {
  std::vector<double> film_y, pupil_x, pupil_y;

  std::size_t size() const noexcept { return film_y.size(); }
};

/// The fit at one wavelength to the lines that pass the lens; its errors from other lines and from the rims of the
/// pupils.
RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const MeridianLines& lines, const MeridianLines& fresh, const MeridianLines& rims);

}  // namespace petzval::inline v0::polynomial_detail
