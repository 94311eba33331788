// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "loops.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::polynomial_detail {

/// Coefficients of all fits as sums of few modes: those of fit w are those of the modes times weights[w].
struct FitModes {
  std::vector<std::vector<double>> modes;               ///< the mean of all fits first
  std::vector<std::array<double, most_modes>> weights;  ///< of the first mode 1, of those that do not exist 0
};

/// By singular values: as many modes as make the root of the sum of squares of what is left of any fit's coefficients a
/// twentieth of its error (and 5e-8 rad, which is less than float adds), or most_modes. Fits of a lens follow the
/// dispersion of its glasses: four or five modes hold any number of them.
/// coefficients: of each fit, the half for directions first.
FitModes find_modes(const std::vector<RayPolynomial::Fit>& fits, const std::vector<std::vector<double>>& coefficients);

}  // namespace petzval::polynomial_detail
