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

/// The number with a count of decimals.
std::string fixed(double value, int decimals);

/// A text for a comment of a source file: on one line, without the marks of C comments.
std::string comment_text(std::string text);

/// Escapes & < > for the content of an HTML element.
std::string escaped_html(std::string_view text);

}  // namespace examples
