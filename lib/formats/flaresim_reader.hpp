// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// True if a text is a .lens file of FlareSim: a line "surfaces:" between keys and rows.
bool is_flaresim(std::string_view text);
void read_flaresim(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
