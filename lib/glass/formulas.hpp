// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "petzval/glass/glass.hpp"

namespace petzval::glass_detail {

/// Name of a formula in tables and its number of coefficients: `first` coefficients, then any number of terms with
/// `each` coefficients.
struct FormulaForm {
  DispersionFormula formula;
  std::string_view name;
  std::size_t first, each;  ///< each: 0 if the formula has no terms
  std::string_view rule;    ///< the coefficients, for messages

  constexpr bool takes(std::size_t count) const noexcept {
    return each == 0 ? count == first : count >= first && (count - first) % each == 0;
  }
};

/// In the order of the enumerators.
inline constexpr std::array<FormulaForm, 8> formula_forms = {{
    {DispersionFormula::sellmeier, "sellmeier", 1, 2, "c0 and pairs"},
    {DispersionFormula::sellmeier_squared, "sellmeier_squared", 1, 2, "c0 and pairs"},
    {DispersionFormula::polynomial, "polynomial", 1, 2, "c0 and pairs"},
    {DispersionFormula::cauchy, "cauchy", 1, 2, "c0 and pairs"},
    {DispersionFormula::buchdahl, "buchdahl", 3, 0, "3"},
    {DispersionFormula::rational, "rational", 1, 3, "c0 and triples"},
    {DispersionFormula::herzberger, "herzberger", 6, 0, "6"},
    {DispersionFormula::tabulated, "tabulated", 4, 2, "two pairs or more"},
}};

constexpr const FormulaForm& form_of(DispersionFormula formula) noexcept {
  return formula_forms[static_cast<std::size_t>(formula)];
}

}  // namespace petzval::glass_detail
