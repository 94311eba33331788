// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is JSON of lentil: it has "optical-elements-...".
bool is_lentil(std::string_view text);

/// Reads such a file, of one lens, into `in`, but for Import::finish.
void read_lentil(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
