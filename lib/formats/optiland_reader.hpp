// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is JSON of optiland: it has a surface_group.
bool is_optiland(std::string_view text);

/// Reads such a file into `in`, but for Import::finish.
void read_optiland(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
