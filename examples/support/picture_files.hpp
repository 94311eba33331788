// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cli.hpp"
#include "petzval/image/image.hpp"

namespace examples {

/// Adds --format: exr, png and pfm; exr and png by default. png: the exposure of the PNG, for the help text.
Option* add_formats(App& app, std::vector<std::string>& formats, const std::string& png);

/// Adds the planes PREFIXR, PREFIXG and PREFIXB of an image.
void add_channels(std::map<std::string, std::vector<float>>& channels, const std::string& prefix,
                  const petzval::RgbImage& image);

/// Writes a PNG with parameters().
void write_png(const petzval::Rgb8Image& image, const std::filesystem::path& file);

/// Writes STEM.exr (linear float, with `texts` and `numbers` in its header, or parameters() without texts and with more
/// `channels` by name), STEM.pfm (linear float) and STEM.png
/// (`shown`) as far as `formats` names them, each once. Returns the paths.
/// @throws petzval::Error that names the file
std::vector<std::filesystem::path> write_picture(const petzval::RgbImage& image, const petzval::Rgb8Image& shown,
                                                 const std::vector<std::string>& formats,
                                                 const std::filesystem::path& stem,
                                                 const std::map<std::string, std::string>& texts = {},
                                                 const std::map<std::string, double>& numbers = {},
                                                 const std::map<std::string, std::vector<float>>& channels = {});

}  // namespace examples
