// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval::polynomial_detail {

/// Lines from the film points that represent all others by symmetry: points on the axis +y for a lens of revolution,
/// points in the quadrant x, y >= 0 for a lens with mirror symmetry.
struct Lines {
  std::vector<double> film_x, film_y, pupil_x, pupil_y;

  std::size_t size() const noexcept { return film_y.size(); }
};

struct FitLines {
  Lines fitted;
  Lines axial;  ///< from the film centre, uniform over its pupil
  Lines fresh;  ///< lines that the fit does not use, to measure errors
  Lines rims;   ///< lines on the rims of the pupils, for the largest errors
  Lines edges;  ///< lines near the rims and from the edge of the film, for the largest errors
};

/// Fits the lines that pass the lens at one wavelength. The film centre is in focus in the plane in which exact rays
/// are sharpest; with mirror symmetry, in the plane of each section.
RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines);

}  // namespace petzval::polynomial_detail
