// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris_weights.hpp"

namespace petzval {

/// A linear RGB image in float: width x height pixels of 3 values, rows from the top.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;

  RgbImage() = default;
  /// Black. Throws Error for a negative size.
  RgbImage(int w, int h) : width(w), height(h), pixels(values_of(w, h), 0.0f) {}
  float* pixel(int x, int y) noexcept { return &pixels[offset(x, y)]; }
  const float* pixel(int x, int y) const noexcept { return &pixels[offset(x, y)]; }

 private:
  static std::size_t values_of(int w, int h) {
    if (w < 0 || h < 0) {
      throw Error("picture of " + std::to_string(w) + " x " + std::to_string(h) + " pixels, wanted 0 or more");
    }
    return static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3;
  }
  std::size_t offset(int x, int y) const noexcept {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 3;
  }
};

/// An 8-bit sRGB image: width x height pixels of 3 values, rows from the top.
struct Rgb8Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

/// One channel of an EXR part: width x height values, rows from the top.
struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

/// One picture of an EXR file: channels of one size, and what the file says about them.
///
/// Numbers become attributes of type double, except those for which OpenEXR has a standard of type float: aperture,
/// effectiveFocalLength, entrancePupilOffset, focus, nominalFocalLength, pinholeFocalLength and tStop.
struct ExrPart {
  std::string name{};  ///< may be empty in a file of one part
  int width = 0;
  int height = 0;
  std::vector<ExrChannel> channels{};          ///< read ones are sorted by name, as the format keeps them
  std::map<std::string, std::string> texts{};  ///< attributes of type string
  std::map<std::string, double> numbers{};     ///< of type double or float; int is read too
  std::map<std::string, Vec2<float>> pairs{};  ///< of type v2f
  /// Pixels on either side beyond the display window. Read ones are 0 where a data window has others.
  int margin_x = 0, margin_y = 0;
};

/// Writes parts of 32-bit float channels, without loss, as write_file does; a file of several is multi-part.
///
/// The display window begins at (0, 0) and is the smallest one around all parts without their margins. Throws Error
/// that names the file: for no part, a part without channels or pixels, margins that leave no pixel, channels of
/// another size than their part, names that are empty or stand twice, and attributes that EXR has for itself.
PETZVAL_API void write_exr(std::span<const ExrPart> parts, const std::filesystem::path& file);

/// Reads all parts of an EXR file of scan lines or tiles, any channel as float; attributes that every EXR has, and
/// those of other types, are left out. Throws Error that names the file, also for more than 3 GiB of values.
PETZVAL_API std::vector<ExrPart> read_exr_parts(const std::filesystem::path& file);

/// Writes 32-bit float channels R, G, B, without loss, as write_file does. Throws Error that names the file.
PETZVAL_API void write_exr(const RgbImage& image, const std::filesystem::path& file);

/// Reads channels R, G, B of the first part of any EXR file as float. Throws Error that names the file.
PETZVAL_API RgbImage read_exr(const std::filesystem::path& file);

/// Writes a PFM, for scripts that read without libraries: "PF", width and height, -1.0 (little-endian), then RGB
/// triples of 32-bit floats, rows from the bottom. As write_file does. Throws Error that names the file.
PETZVAL_API void write_pfm(const RgbImage& image, const std::filesystem::path& file);
/// The same of one channel, "Pf". values: width x height, rows from the top.
PETZVAL_API void write_pfm(int width, int height, std::span<const float> values, const std::filesystem::path& file);

/// Reads a PFM, of either order of bytes, rows from the bottom: three channels ("PF"), or one ("Pf") for all three.
/// Throws Error that names the file, also for more than 2^26 pixels.
PETZVAL_API RgbImage read_pfm(const std::filesystem::path& file);

/// Reads a PNG of 8 or 16 bits as linear light: its values decoded as sRGB, whatever gamma it states, alpha left out.
/// Throws Error that names the file, also for more than 2^26 pixels.
PETZVAL_API RgbImage read_png(const std::filesystem::path& file);

/// Writes an 8-bit sRGB PNG as write_file does. Throws Error that names the file.
PETZVAL_API void write_png(const Rgb8Image& image, const std::filesystem::path& file);

/// Reads a PNG, or an EXR (.exr) with a channel Y or R, G and B, as weights over the stop: grey, or the mean of the
/// three, of a PNG as the file has it, from 0 to 1, whatever gamma it states. Alpha is left out. Throws Error that
/// names the file, also for more than 2^26 pixels.
PETZVAL_API IrisMap read_iris_map(const std::filesystem::path& file);

/// The picture of an anamorphic lens as the scene looks: wider by squeeze(lens), or for less than 1 higher by its
/// inverse, so that no detail is lost. Pixels are interpolated linearly. Throws Error for an image without
/// pixels or with another number of values, a squeeze that is not positive and finite, and a picture beyond 2^30
/// pixels.
PETZVAL_API RgbImage desqueezed(const RgbImage& image, double squeeze);

/// Converts linear light times `exposure` to 8-bit sRGB. Values are clipped to 0 and 1; NaN becomes black.
PETZVAL_API Rgb8Image to_srgb8(const RgbImage& image, float exposure = 1.0f);

}  // namespace petzval
