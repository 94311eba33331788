// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval::image_detail {

/// A PNG file without alpha: 16-bit numbers of its channels (1 of grey, 3 of colours), rows from the top.
struct PngPicture {
  std::size_t width = 0, height = 0, channels = 0;
  std::vector<std::uint16_t> values;
};

/// Reads a PNG file as it is, whatever gamma it states. Throws Error that names the file, also for more than 2^26
/// pixels.
PngPicture read_png_picture(const std::filesystem::path& file);

/// Refuses more than 2^26 pixels.
void check_size(std::size_t width, std::size_t height, const std::filesystem::path& file);

}  // namespace petzval::image_detail
