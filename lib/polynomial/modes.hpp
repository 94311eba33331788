// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "loops.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval::polynomial_detail {

/// All fits as sums of few modes: the coefficients of fit w are the sum of modes[k] * weights[w][k].
struct FitModes {
  std::vector<std::vector<double>> modes;               ///< the first mode is the mean of all fits
  std::vector<std::array<double, most_modes>> weights;  ///< 1 for the first mode, 0 for missing modes
};

/// Finds modes by singular value decomposition.
///
/// It takes as many modes as are needed to reduce the norm of the residual coefficients of every fit to a twentieth of
/// the error of the fit plus 5e-8 rad, which is below the rounding of float; at most most_modes. The fits of a lens
/// change with the dispersion of its glasses: for any number of fits, four or five modes suffice.
/// @param coefficients for each fit; the first half is for directions, the second half for offsets
FitModes find_modes(const std::vector<RayPolynomial::Fit>& fits, const std::vector<std::vector<double>>& coefficients);

}  // namespace petzval::polynomial_detail
