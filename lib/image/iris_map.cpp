// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>

#include "image/exr.hpp"
#include "image/png.hpp"
#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"

namespace petzval {
namespace {

using image_detail::check_size;

/// Reads values without decoding a gamma, because weights are not colours.
IrisMap read_png_map(const std::filesystem::path& file) {
  const image_detail::PngPicture picture = image_detail::read_png_picture(file);
  IrisMap map{static_cast<int>(picture.width), static_cast<int>(picture.height), {}};
  for (std::size_t i = 0; i < picture.values.size(); i += picture.channels) {
    float sum = 0;
    for (std::size_t c = 0; c < picture.channels; ++c) sum += static_cast<float>(picture.values[i + c]);
    map.values.push_back(sum / (65535 * static_cast<float>(picture.channels)));
  }
  return map;
}

IrisMap read_exr_map(const std::filesystem::path& file) {
  const ExrPart part = read_exr_parts(file).front();
  check_size(static_cast<std::size_t>(part.width), static_cast<std::size_t>(part.height), file);
  IrisMap map{part.width, part.height, {}};
  if (const auto grey = part.channels.find("Y"); grey != part.channels.end()) {
    map.values = grey->second;
    return map;
  }
  for (const char* name : {"R", "G", "B"}) {
    if (part.channels.contains(name)) continue;
    throw Error(file.string() + ": channels are missing; must have Y, or R, G and B");
  }
  const std::vector<float>&red = part.channels.at("R"), &green = part.channels.at("G"), &blue = part.channels.at("B");
  for (std::size_t i = 0; i < red.size(); ++i) map.values.push_back((red[i] + green[i] + blue[i]) / 3);
  return map;
}

}  // namespace

IrisMap read_iris_map(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".exr" || ending == ".EXR" ? read_exr_map(file) : read_png_map(file);
}

}  // namespace petzval
