// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace examples {

/// A number for messages and tables, the same in every locale: the shortest decimals that read back to the same double
/// ("0.1", "1e+30", "nan").
std::string number(double value);

/// The number rounded to a count of significant digits.
std::string number(double value, int significant_digits);

/// Escapes & < > for the content of an HTML element.
std::string escaped_html(std::string_view text);

}  // namespace examples
