// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "petzval/core/config.hpp"

namespace petzval {

/// A number as text: the shortest decimals that read back to the same double, in any locale ("0.1", "1e+30", "nan").
PETZVAL_API std::string to_text(double value);

/// A number rounded to `significant_digits`, independent of the locale.
PETZVAL_API std::string to_text(double value, int significant_digits);

/// Number of bytes of the UTF-8 character that starts at a position; 0 if the bytes are no valid character. Surrogates,
/// code points above U+10FFFF and overlong encodings are not valid.
PETZVAL_API std::size_t utf8_length(std::string_view text, std::size_t at) noexcept;

/// The longest beginning of a UTF-8 text with at most `most` bytes that does not split a character.
PETZVAL_API std::string_view beginning(std::string_view text, std::size_t most) noexcept;

/// The text on one line: control characters, including line breaks, become blanks.
PETZVAL_API std::string one_line(std::string text);

}  // namespace petzval
