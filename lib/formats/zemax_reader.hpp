// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is a .zmx: it has surfaces "SURF n" and one of the words that begin such files.
bool is_zemax(std::string_view text);

/// Reads a .zmx into `in`, but for Import::finish.
void read_zemax(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
