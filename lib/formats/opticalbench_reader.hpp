// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// Whether a text is a table of Photons to Photos: it has a section [lens data].
bool is_opticalbench(std::string_view text);

/// Reads one into `in`, but for Import::finish.
void read_opticalbench(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
