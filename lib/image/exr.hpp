// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/image/image.hpp"

namespace petzval::image_detail {

/// Reads channels of the first part of an EXR file, in the given order.
///
/// @throws Error if the file cannot be read or a channel is missing
ExrPart read_first_part(const std::filesystem::path& file, std::span<const std::string_view> channels);

/// The values of a channel of a part; null if the part has no channel with that name.
const std::vector<float>* channel(const ExrPart& part, std::string_view name) noexcept;

}  // namespace petzval::image_detail
