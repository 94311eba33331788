// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/image/image.hpp"

namespace petzval::image_detail {

/// Reads the first part of an EXR file, of its channels those, in that order. Throws Error that names the file, also
/// where it has no such channel.
ExrPart read_first_part(const std::filesystem::path& file, std::span<const std::string_view> channels);

/// The values of a part's channel; null where it has none of that name. (Files keep channels sorted by name.)
const std::vector<float>* channel(const ExrPart& part, std::string_view name) noexcept;

}  // namespace petzval::image_detail
