// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "petzval/image/image.hpp"

namespace petzval::image_detail {

/// Reads channels of the first part of an EXR file.
///
/// @throws Error if the file cannot be read or a channel is missing
ExrPart read_first_part(const std::filesystem::path& file, std::span<const std::string_view> channels);

}  // namespace petzval::image_detail
