// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is a .seq: statements SO, S and SI.
bool is_codev(std::string_view text);

/// Reads a .seq into `in`, but for Import::finish.
void read_codev(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
