// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"
#include "renderer/picture_sums.hpp"
#include "support/files.hpp"

namespace renderer {

/// Writes picture.exr (linear Rec. 709; texts and numbers go into its header), picture.pfm (the same) and picture.png
/// (sRGB of the values times
/// `exposure`) to a folder, as the formats say. Returns the paths. Throws petzval::Error that names a file.
std::vector<std::filesystem::path> write_pictures(const petzval::RgbImage& picture,
                                                  const std::map<std::string, std::string>& texts,
                                                  const std::map<std::string, double>& numbers,
                                                  const std::vector<std::string>& formats,
                                                  const std::filesystem::path& folder, float exposure = 1);

/// "samples" (of a pixel, the mean of all), "mean_radiance" (R, G, B: mean and standard_error), "tiles" (of rows by
/// columns: mean and standard_error of the luminance, a list for each row), "rejected". A standard error is null where
/// there is nothing to compare.
examples::Json statistics(const PictureSums& sums);

}  // namespace renderer
