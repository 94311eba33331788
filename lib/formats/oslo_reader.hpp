// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is a lens file of OSLO: it begins with LEN NEW, a name, a number and a count of surfaces.
bool is_oslo(std::string_view text);

/// Reads one into `in`, but for Import::finish.
void read_oslo(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
