// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/image.hpp"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/io/write_file.hpp"

namespace petzval::inline v0 {
namespace {

constexpr std::array<const char*, 3> channel_names{"R", "G", "B"};
// 3 GiB in memory. A damaged header may claim any size.
constexpr std::size_t most_pixels = std::size_t(1) << 28;

template <class Image>
void validate(const Image& image, const std::filesystem::path& file) {
  if (image.width > 0 && image.height > 0 &&
      image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3) {
    return;
  }
  throw Error(file.string() + ": image is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
              " with " + std::to_string(image.pixels.size()) + " values, wanted 3 a pixel and at least one pixel");
}

/// The three channels of interleaved float pixels; the first pixel is the upper left corner of the data window.
Imf::FrameBuffer frame(float* pixels, const Imath::Box2i& window, int width, int height) {
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channel_names.size(); ++c) {
    buffer.insert(channel_names[c],
                  Imf::Slice::Make(Imf::FLOAT, pixels + c, window.min, width, height, 3 * sizeof(float),
                                   3 * sizeof(float) * static_cast<std::size_t>(width)));
  }
  return buffer;
}

float srgb(float linear) noexcept {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

}  // namespace

void write_exr(const RgbImage& image, const std::filesystem::path& file) {
  validate(image, file);
  Imf::StdOSStream stream;
  try {
    Imf::Header header(image.width, image.height);
    for (const char* name : channel_names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile out(stream, header, 0);
    out.setFrameBuffer(frame(const_cast<float*>(image.pixels.data()), header.dataWindow(), image.width, image.height));
    out.writePixels(image.height);
  } catch (const std::exception& e) {
    throw Error(file.string() + ": " + e.what());
  }
  write_file(stream.str(), file);
}

RgbImage read_exr(const std::filesystem::path& file) {
  try {
    Imf::InputFile in(file.string().c_str(), 0);
    for (const char* name : channel_names) {
      if (!in.header().channels().findChannel(name))
        throw Error(std::string("no channel ") + name + ", wanted R, G and B");
    }
    const Imath::Box2i window = in.header().dataWindow();
    const auto width = std::int64_t(window.max.x) - window.min.x + 1;
    const auto height = std::int64_t(window.max.y) - window.min.y + 1;
    if (static_cast<std::size_t>(width) > most_pixels / static_cast<std::size_t>(height)) {
      throw Error("image is " + std::to_string(width) + " x " + std::to_string(height) + ", wanted " +
                  std::to_string(most_pixels) + " pixels or fewer");
    }
    RgbImage image(static_cast<int>(width), static_cast<int>(height));
    in.setFrameBuffer(frame(image.pixels.data(), window, image.width, image.height));
    in.readPixels(window.min.y, window.max.y);
    return image;
  } catch (const std::exception& e) {
    throw Error(file.string() + ": " + e.what());
  }
}

void write_pfm(const RgbImage& image, const std::filesystem::path& file) {
  validate(image, file);
  std::string bytes = "PF\n" + std::to_string(image.width) + ' ' + std::to_string(image.height) + "\n-1.0\n";
  for (int y = image.height; y-- > 0;) {
    const float* const row = image.pixel(0, y);
    for (int i = 0; i < 3 * image.width; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(row[i]);
      for (int byte = 0; byte < 4; ++byte) bytes += static_cast<char>(bits >> (8 * byte) & 0xff);
    }
  }
  write_file(bytes, file);
}

void write_png(const Rgb8Image& image, const std::filesystem::path& file) {
  validate(image, file);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // This bound on the packed size avoids packing twice, once only for the size.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr)) {
    throw Error(file.string() + ": " + png.message);
  }
  write_file({bytes.data(), size}, file);
}

RgbImage desqueezed(const RgbImage& image, double squeeze) {
  const double wide = std::max(squeeze, 1.0), high = 1 / std::min(squeeze, 1.0);
  const double width = std::round(image.width * wide), height = std::round(image.height * high);
  if (!(squeeze > 0 && width * height <= 1 << 30)) {
    throw Error("image: the squeeze is " + to_text(squeeze) + " of " + std::to_string(image.width) + " x " +
                std::to_string(image.height) + " pixels, wanted a positive one, and at most 2^30 pixels");
  }
  RgbImage out(static_cast<int>(width), static_cast<int>(height));
  // A pixel's place between the middles of two pixels of the image, in a row or a column of `count`.
  struct Between {
    int low, high;
    float part;
  };
  const auto between = [](int i, int count, int out_count) -> Between {
    const double at = std::clamp((i + 0.5) * count / out_count - 0.5, 0.0, count - 1.0);
    const int low = static_cast<int>(at);
    return {low, std::min(low + 1, count - 1), static_cast<float>(at - low)};
  };
  for (int y = 0; y < out.height; ++y) {
    const auto [y0, y1, down] = between(y, image.height, out.height);
    for (int x = 0; x < out.width; ++x) {
      const auto [x0, x1, right] = between(x, image.width, out.width);
      for (int c = 0; c < 3; ++c) {
        const float above = (1 - right) * image.pixel(x0, y0)[c] + right * image.pixel(x1, y0)[c];
        const float below = (1 - right) * image.pixel(x0, y1)[c] + right * image.pixel(x1, y1)[c];
        out.pixel(x, y)[c] = (1 - down) * above + down * below;
      }
    }
  }
  return out;
}

Rgb8Image to_srgb8(const RgbImage& image, float exposure) {
  Rgb8Image out{image.width, image.height, {}};
  out.pixels.reserve(image.pixels.size());
  for (const float linear : image.pixels) {
    const float light = linear * exposure;
    // Comparisons with NaN are false: it becomes black.
    const float clipped = light > 0 ? (light < 1 ? light : 1.0f) : 0.0f;
    out.pixels.push_back(static_cast<std::uint8_t>(255 * srgb(clipped) + 0.5f));
  }
  return out;
}

}  // namespace petzval::inline v0
