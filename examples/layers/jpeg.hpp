// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "petzval/image/image.hpp"

namespace lens_blur {

/// Reads a grey or RGB JPEG file as linear light. Values are decoded as sRGB; a note says so if the file has another
/// colour profile. The orientation of the camera (EXIF) is applied.
///
/// @throws petzval::Error if the file cannot be read, is incomplete, has four inks or more than 2^26 pixels, or if the
///                        program was built without libjpeg
petzval::RgbImage read_jpeg(const std::filesystem::path& file);

}  // namespace lens_blur
