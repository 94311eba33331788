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

struct FitLines {
  MeridianLines fitted;
  MeridianLines axial;  ///< of the film's centre, uniform over its pupil
  MeridianLines fresh;  ///< to find errors with, and for the largest ones
  MeridianLines rims;   ///< those along the rims of the pupils and
  MeridianLines edges;  ///< those near them and of the film's farthest point
};

/// The fit at one wavelength to the lines that pass the lens. The film's centre is in focus where exact rays are
/// sharpest.
RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines);

}  // namespace petzval::inline v0::polynomial_detail
