// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// The formulas in which catalogues print n(lambda); l is the wavelength in micrometres.
enum class DispersionFormula {
  sellmeier,          ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C)
  sellmeier_squared,  ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C^2)
  polynomial,         ///< n^2 = c0 + sum c l^e
  cauchy,             ///< n   = c0 + sum c l^e
  buchdahl,           ///< n   = c0 + c1 w + c2 w^2, w = (l - 0.574) / (1 + 2.5 (l - 0.574))
};

/// One glass of a catalogue: its dispersion formula and the range in which the formula was fitted.
struct Glass {
  std::string catalogue;  ///< "schott", "ohara", ...
  std::string name;       ///< "N-BK7"
  double nd = 1;          ///< index at 587.5618 nm, as the catalogue prints it
  double vd = 0;          ///< Abbe number
  DispersionFormula formula = DispersionFormula::cauchy;
  double shortest_nm = 0;
  double longest_nm = 0;
  std::vector<double> coefficients;  ///< in the order of the formula
};

/// The index of a glass relative to air. Throws Error that names the glass and its range for a wavelength outside the
/// range, and for a formula that gives no real index there.
PETZVAL_API double refractive_index(const Glass& glass, double wavelength_nm);

/// The index from n_d and the Abbe number: n = A + B / lambda^2, with n_d and n_F - n_C as stated. For media whose
/// glass is unknown. From 420 to 680 nm the error is at most 5e-4 for half of the glasses in data/glass, 5e-3 for 95 %
/// of them and 0.016 for the densest flints (table in tests/media/dispersion_test.cpp). Valid from 365 to 1014 nm.
PETZVAL_API double abbe_index(double nd, double vd, double wavelength_nm);

/// The wavelength of a spectral line by its letter ("d", "F", "C", "e", "F'", ...), nm. Throws Error for an unknown
/// letter.
PETZVAL_API double spectral_line_nm(std::string_view symbol);

}  // namespace petzval::inline v0
