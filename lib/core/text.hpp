// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// A number for messages, figures and JSON: the shortest decimals that read back to the same double, whatever the
/// locale ("0.1", "1e+30", "nan").
PETZVAL_API std::string to_text(double value);

/// The same rounded to a number of significant digits.
PETZVAL_API std::string to_text(double value, int significant_digits);

}  // namespace petzval::inline v0
