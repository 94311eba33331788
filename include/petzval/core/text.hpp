// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// A number for messages, figures and JSON: the shortest decimals that read back to the same double, whatever the
/// locale ("0.1", "1e+30", "nan").
PETZVAL_API std::string number(double value);

/// The same rounded to a number of significant digits.
PETZVAL_API std::string number(double value, int significant_digits);

/// Words as the content of an element of XML or HTML: & < > by their names.
PETZVAL_API std::string escaped_xml(std::string_view words);

}  // namespace petzval::inline v0
