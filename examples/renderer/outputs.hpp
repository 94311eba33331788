// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"
#include "renderer/picture_sums.hpp"
#include "renderer/render.hpp"
#include "support/files.hpp"

namespace renderer {

/// The picture plus its guides ghosts.R, .G and .B, if there are any.
petzval::RgbImage picture_with_ghosts(const PictureSums& sums);

/// Writes picture_with_ghosts() as picture.exr (linear Rec. 709 and the guides, with `texts` and `numbers` in its
/// header), picture.pfm (linear Rec. 709) and picture.png (sRGB of the values times `exposure`) to a folder, as listed
/// in `formats`. Returns the paths.
/// @throws petzval::Error that names the file
std::vector<std::filesystem::path> write_pictures(const PictureSums& sums,
                                                  const std::map<std::string, std::string>& texts,
                                                  const std::map<std::string, double>& numbers,
                                                  const std::vector<std::string>& formats,
                                                  const std::filesystem::path& folder, float exposure = 1);

/// "samples" (mean number per pixel), "light_paths" (per pixel), "mean_radiance" (R, G, B: mean and standard_error),
/// "tiles" (rows by columns: mean and standard_error of the luminance, samples and noise, a list for each row), "noise"
/// (rms and largest of the tiles, see PictureSums::Noise; floor) and "rejected". A standard error or noise is
/// null if fewer than two rounds have samples or the sum is 0.
examples::Json statistics(const PictureSums& sums, double floor = Effort{}.floor);

}  // namespace renderer
