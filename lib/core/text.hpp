// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval {

/// A number for messages, figures and JSON: the shortest decimals that read back to the same double, whatever the
/// locale ("0.1", "1e+30", "nan").
PETZVAL_API std::string to_text(double value);

/// The same rounded to a number of significant digits.
PETZVAL_API std::string to_text(double value, int significant_digits);

/// The number of bytes of the UTF-8 character that starts at a place; 0 if none does: also for surrogates, numbers
/// above U+10FFFF and characters written with more bytes than they need.
PETZVAL_API std::size_t utf8_length(std::string_view text, std::size_t at) noexcept;

/// The beginning of a UTF-8 text, at most this many bytes: whole characters.
PETZVAL_API std::string_view beginning(std::string_view text, std::size_t most) noexcept;

}  // namespace petzval
