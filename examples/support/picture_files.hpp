// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cli.hpp"
#include "petzval/image/image.hpp"

namespace examples {

/// --format: some of exr, png and pfm; exr and png by default. png: how that file is exposed.
Option* add_formats(App& app, std::vector<std::string>& formats, const std::string& png);

/// Writes STEM.exr (linear float; texts and numbers go into its header), STEM.pfm (the same) and STEM.png (`shown`), as
/// the formats say, each once. Returns the paths. Throws petzval::Error that names a file.
std::vector<std::filesystem::path> write_picture(const petzval::RgbImage& image, const petzval::Rgb8Image& shown,
                                                 const std::vector<std::string>& formats,
                                                 const std::filesystem::path& stem,
                                                 const std::map<std::string, std::string>& texts = {},
                                                 const std::map<std::string, double>& numbers = {});

}  // namespace examples
