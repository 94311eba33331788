// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval::image_detail {

/// The values of a PNG file without alpha: 16 bits per channel (1 grey or 3 colour channels), rows from the top.
struct PngPicture {
  std::size_t width = 0, height = 0, channels = 0;
  std::vector<std::uint16_t> values;
};

/// Reads a PNG file without decoding a gamma.
///
/// @throws Error if the file cannot be read or has more than 2^26 pixels
PngPicture read_png_picture(const std::filesystem::path& file);

/// @throws Error if there are more than 2^26 pixels
void check_size(std::size_t width, std::size_t height, const std::filesystem::path& file);

}  // namespace petzval::image_detail
