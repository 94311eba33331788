// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/image.hpp"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/open_file.hpp"
#include "core/text.hpp"
#include "image/exr.hpp"
#include "image/file_capacity.hpp"
#include "image/png.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

constexpr std::array<std::string_view, 3> rgb_channels{"R", "G", "B"};

template <class Image>
void validate(const Image& image, const std::string& where) {
  if (image.width > 0 && image.height > 0 &&
      image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3) {
    return;
  }
  throw Error(where + ": image = " + std::to_string(image.width) + " x " + std::to_string(image.height) + " with " +
              std::to_string(image.pixels.size()) + " values; must have 3 per pixel and at least one pixel");
}

float srgb(float linear) noexcept {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

}  // namespace

void write_exr(const RgbImage& image, const std::filesystem::path& file) {
  validate(image, file.string());
  ExrPart part{.width = image.width, .height = image.height};
  for (std::size_t c = 0; c < rgb_channels.size(); ++c) {
    std::vector<float>& values = part.channels[std::string(rgb_channels[c])];
    values.reserve(image.pixels.size() / 3);
    for (std::size_t i = c; i < image.pixels.size(); i += 3) values.push_back(image.pixels[i]);
  }
  write_exr({&part, 1}, file);
}

RgbImage read_exr(const std::filesystem::path& file) {
  const ExrPart part = image_detail::read_first_part(file, rgb_channels);
  RgbImage image(part.width, part.height);
  for (std::size_t c = 0; c < rgb_channels.size(); ++c) {
    const std::vector<float>& values = part.channels.at(std::string(rgb_channels[c]));
    for (std::size_t i = 0; i < values.size(); ++i) image.pixels[3 * i + c] = values[i];
  }
  return image;
}

namespace {

/// @param row     numbers per row
/// @param values  rows from the top
void write_pfm(const char* kind, int width, int height, std::size_t row, std::span<const float> values,
               const std::filesystem::path& file) {
  std::string bytes = std::string(kind) + '\n' + std::to_string(width) + ' ' + std::to_string(height) + "\n-1.0\n";
  for (auto y = static_cast<std::size_t>(height); y-- > 0;) {
    for (const float value : values.subspan(y * row, row)) {
      const auto bits = std::bit_cast<std::uint32_t>(value);
      for (int byte = 0; byte < 4; ++byte) bytes += static_cast<char>(bits >> (8 * byte) & 0xff);
    }
  }
  write_file(bytes, file);
}

/// Reads the next word of the header of a PFM file and one white space after it. A word, or the white space before it,
/// has at most 64 characters, so that reading the header of an endless file terminates.
std::string next_word(std::istream& in) {
  constexpr std::size_t max_word_size = 64;
  const auto blank = [](int c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  int c = in.get();
  for (std::size_t i = 0; i < max_word_size && blank(c); ++i) c = in.get();
  std::string word;
  for (; in && !blank(c) && word.size() < max_word_size; c = in.get()) word += static_cast<char>(c);
  return word;
}

/// Reads a whole word as a number.
template <class T>
bool parse(std::string_view word, T& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

void write_pfm(const RgbImage& image, const std::filesystem::path& file) {
  validate(image, file.string());
  write_pfm("PF", image.width, image.height, 3 * static_cast<std::size_t>(image.width), image.pixels, file);
}

void write_pfm(int width, int height, std::span<const float> values, const std::filesystem::path& file) {
  if (width < 1 || height < 1 || values.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw Error(file.string() + ": values = " + std::to_string(values.size()) + " for " + std::to_string(width) +
                " x " + std::to_string(height) + " pixels; must be one per pixel");
  }
  write_pfm("Pf", width, height, static_cast<std::size_t>(width), values, file);
}

RgbImage read_pfm(const std::filesystem::path& file) {
  std::ifstream in = core_detail::opened(file, "a PFM file");
  std::int64_t width = 0, height = 0;
  double scale = 0;
  const std::string kind = next_word(in);
  const bool numbers = parse(next_word(in), width) && parse(next_word(in), height) && parse(next_word(in), scale);
  if (!numbers || (kind != "PF" && kind != "Pf") || width < 1 || height < 1 || scale == 0) {
    throw Error(file.string() + ": PFM header is invalid; must be PF or Pf, width, height and scale");
  }
  image_detail::check_size(static_cast<std::size_t>(width), static_cast<std::size_t>(height), file);
  const std::size_t channels = kind == "PF" ? 3 : 1, row = channels * static_cast<std::size_t>(width);
  const std::string too_short = file.string() + ": ends before its last value; must be a complete PFM file";
  if (!image_detail::fits_in_file(row * static_cast<std::size_t>(height), 1, file)) throw Error(too_short);
  RgbImage image(static_cast<int>(width), static_cast<int>(height));
  std::vector<unsigned char> bytes(4 * row);
  for (auto y = static_cast<int>(height); y-- > 0;) {
    if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
      throw Error(too_short);
    }
    for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(width); ++i) {
      const unsigned char* const b = &bytes[4 * (channels == 3 ? i : i / 3)];
      const auto of = [&](int k) { return static_cast<std::uint32_t>(b[scale < 0 ? k : 3 - k]) << (8 * k); };
      image.pixel(0, y)[i] = std::bit_cast<float>(of(0) | of(1) | of(2) | of(3));
    }
  }
  return image;
}

RgbImage read_png(const std::filesystem::path& file) {
  const image_detail::PngPicture picture = image_detail::read_png_picture(file);
  RgbImage image(static_cast<int>(picture.width), static_cast<int>(picture.height));
  std::vector<float> linear(65536);
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const double v = static_cast<double>(i) / 65535;
    linear[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = linear[picture.values[picture.channels == 3 ? i : i / 3]];
  }
  return image;
}

namespace {

/// A chunk of a PNG file.
std::string png_chunk(const std::string& type, const std::string& data) {
  const auto four_bytes = [](std::size_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
  };
  const std::string body = type + data;
  std::vector<unsigned char> checked(body.begin(), body.end());
  const uLong crc = crc32(0, checked.data(), static_cast<uInt>(checked.size()));
  return four_bytes(data.size()) + body + four_bytes(crc);
}

/// The bytes of a PNG file. `where`: name of the picture, for messages.
std::string png_bytes(const Rgb8Image& image, const std::map<std::string, std::string>& texts,
                      const std::string& where) {
  validate(image, where);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // This upper bound of the packed size avoids packing the picture twice, the first time only for its size.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr)) {
    throw Error(where + ": " + png.message);
  }
  bytes.resize(size);
  std::string chunks;
  for (const auto& [keyword, text] : texts) {
    if (keyword.empty() || keyword.size() > 79) {
      throw Error(where + ": keyword = \"" + keyword + "\"; must have 1 to 79 bytes");
    }
    chunks += png_chunk("tEXt", keyword + '\0' + text);
  }
  constexpr std::size_t after_head = 33;  // signature and IHDR
  bytes.insert(after_head, chunks);
  return bytes;
}

}  // namespace

std::string to_png(const Rgb8Image& image) { return png_bytes(image, {}, "PNG"); }

void write_png(const Rgb8Image& image, const std::filesystem::path& file,
               const std::map<std::string, std::string>& texts) {
  write_file(png_bytes(image, texts, file.string()), file);
}

RgbImage desqueezed(const RgbImage& image, double squeeze) {
  validate(image, "desqueezed");
  const double wide = std::max(squeeze, 1.0), high = 1 / std::min(squeeze, 1.0);
  const double width = std::round(image.width * wide), height = std::round(image.height * high);
  if (!(squeeze > 0 && width * height <= 1 << 30)) {
    throw Error("image: squeeze = " + to_text(squeeze) + " for " + std::to_string(image.width) + " x " +
                std::to_string(image.height) + " pixels; must be positive and give at most 2^30 pixels");
  }
  RgbImage out(static_cast<int>(width), static_cast<int>(height));
  // Position of an output pixel between the centres of two input pixels, along a side of `count` pixels.
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
    // Comparisons with NaN are false: NaN becomes black.
    const float clipped = light > 0 ? (light < 1 ? light : 1.0f) : 0.0f;
    out.pixels.push_back(static_cast<std::uint8_t>(255 * srgb(clipped) + 0.5f));
  }
  return out;
}

}  // namespace petzval
