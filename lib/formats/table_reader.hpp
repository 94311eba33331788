// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether the first line that is no comment, or the one behind column names, has four or five numbers.
bool is_table(std::string_view text);

/// Reads a renderer's table into `in`, but for Import::finish.
void read_table(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
