// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "petzval/core/version.hpp"

namespace petzval::inline v0::io_detail {

/// Refuses an EXR file with an attribute that reaches beyond the file's end, as OpenEXR takes memory for any size that
/// a damaged head states, or that has not the size of its type. What else is wrong with the head is left to OpenEXR.
/// Throws Error without the file's name.
void check_exr_attributes(const std::filesystem::path& file);

}  // namespace petzval::inline v0::io_detail
