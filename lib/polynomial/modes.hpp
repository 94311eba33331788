// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "loops.hpp"

namespace petzval::polynomial_detail {

/// All fits as sums of few modes: the coefficients of fit w are the sum of modes[k] * weights[w][k].
struct FitModes {
  std::vector<std::vector<double>> modes;               ///< the first mode is the mean of all fits
  std::vector<std::array<double, most_modes>> weights;  ///< 1 for the first mode, 0 for missing modes
};

/// Finds modes by singular value decomposition.
///
/// It takes as many modes as are needed to reduce the norm of the residual coefficients of every fit to the tolerances;
/// at most most_modes. The fits of a lens change with the dispersion of its glasses: for any number of fits, four or
/// five modes suffice.
/// @param coefficients for each fit
/// @param tolerances of the first and of the second half of the coefficients
FitModes find_modes(const std::vector<std::vector<double>>& coefficients, const std::array<double, 2>& tolerances);

}  // namespace petzval::polynomial_detail
