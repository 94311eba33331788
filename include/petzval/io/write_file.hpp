// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// Writes a file as a whole or not at all: first beside it, under its name with .part behind, then in its place. A
/// failure leaves neither a torn file nor the loss of an old one. Links are followed; what is no ordinary file, a pipe
/// or a device, is written to as it is. Throws Error that names the file.
PETZVAL_API void write_file(std::string_view bytes, const std::filesystem::path& file);

}  // namespace petzval::inline v0
