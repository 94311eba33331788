// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::polynomial_detail {

/// Lines of the film points from which all others follow by the symmetry: those on the axis +y of a lens of revolution,
/// those in the quadrant x, y >= 0 of one with mirror symmetry.
struct Lines {
  std::vector<double> film_x, film_y, pupil_x, pupil_y;

  std::size_t size() const noexcept { return film_y.size(); }
};

struct FitLines {
  Lines fitted;
  Lines axial;  ///< of the film's centre, uniform over its pupil
  Lines fresh;  ///< to find errors with, and for the largest ones
  Lines rims;   ///< those along the rims of the pupils and
  Lines edges;  ///< those near them and of the film's farthest points
};

/// The fit at one wavelength to the lines that pass the lens. The film's centre is in focus where exact rays are
/// sharpest, in both sections of a
/// lens with mirror symmetry.
RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines);

}  // namespace petzval::polynomial_detail
