// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// Writes a whole file or none: first to FILE.part, which then replaces FILE. A failure keeps the old file and leaves
/// no partial one. Links are followed. Pipes and devices are written to directly. Throws Error that names the file.
PETZVAL_API void write_file(std::string_view bytes, const std::filesystem::path& file);

}  // namespace petzval::inline v0
