// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <cstdint>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/io/image.hpp"

namespace petzval::inline v0 {
namespace {

void check_size(std::size_t width, std::size_t height, const std::filesystem::path& file) {
  constexpr std::size_t most = std::size_t(1) << 26;
  if (width <= most / height) return;
  throw Error(file.string() + ": found " + std::to_string(width) + " x " + std::to_string(height) + " pixels, wanted " +
              std::to_string(most) + " or fewer");
}

/// As the file has them: weights are no light, and have no gamma.
IrisMap read_png_map(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str())) throw Error(file.string() + ": " + png.message);
  IrisMap map{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  try {
    check_size(png.width, png.height, file);
  } catch (const Error&) {
    png_image_free(&png);
    throw;
  }
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr)) throw Error(file.string() + ": " + png.message);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    map.values.push_back(static_cast<float>(bytes[i] + bytes[i + 1] + bytes[i + 2]) / (3 * 255));
  }
  return map;
}

IrisMap read_exr_map(const std::filesystem::path& file) {
  const ExrPart part = read_exr_parts(file).front();
  check_size(static_cast<std::size_t>(part.width), static_cast<std::size_t>(part.height), file);
  const auto channel = [&](const char* name) -> const std::vector<float>* {
    for (const ExrChannel& own : part.channels) {
      if (own.name == name) return &own.values;
    }
    return nullptr;
  };
  IrisMap map{part.width, part.height, {}};
  if (const auto* const grey = channel("Y")) {
    map.values = *grey;
    return map;
  }
  const auto *const red = channel("R"), *const green = channel("G"), *const blue = channel("B");
  if (!red || !green || !blue) throw Error(file.string() + ": found neither a channel Y nor R, G and B, wanted grey");
  for (std::size_t i = 0; i < red->size(); ++i) map.values.push_back(((*red)[i] + (*green)[i] + (*blue)[i]) / 3);
  return map;
}

}  // namespace

IrisMap read_iris_map(const std::filesystem::path& file) {
  return file.extension() == ".exr" ? read_exr_map(file) : read_png_map(file);
}

}  // namespace petzval::inline v0
