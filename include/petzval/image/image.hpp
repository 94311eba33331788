// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval {

/// A linear RGB image in float: width x height pixels of 3 values, rows from the top.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;

  RgbImage() = default;
  /// A black image.
  ///
  /// @throws Error if a size is negative
  RgbImage(int w, int h) : width(w), height(h), pixels(values_of(w, h), 0.0f) {}
  float* pixel(int x, int y) noexcept { return &pixels[offset(x, y)]; }
  const float* pixel(int x, int y) const noexcept { return &pixels[offset(x, y)]; }

 private:
  static std::size_t values_of(int w, int h) {
    if (w < 0 || h < 0) {
      throw Error("picture: size = " + std::to_string(w) + " x " + std::to_string(h) + " pixels; must be 0 or more");
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

/// One image of an EXR file: channels of equal size, and attributes.
///
/// Numbers are written as attributes of type double, except for the standard float attributes of OpenEXR: aperture,
/// effectiveFocalLength, entrancePupilOffset, focus, nominalFocalLength, pinholeFocalLength and tStop.
struct ExrPart {
  std::string name{};  ///< may be empty if the file has a single part
  int width = 0;
  int height = 0;
  /// width x height values by the name of the channel, rows from the top.
  std::map<std::string, std::vector<float>> channels{};
  std::map<std::string, std::string> texts{};  ///< attributes of type string
  std::map<std::string, double> numbers{};     ///< attributes of type double or float; also int when reading
  std::map<std::string, Vec2<float>> pairs{};  ///< attributes of type v2f
  /// Pixels on either side beyond the display window; 0 after reading if the windows have different centres.
  int margin_x = 0, margin_y = 0;
  bool half = false;  ///< writing: channels of 16-bit floats, rounded to the nearest
};

/// Writes parts with float channels to an EXR file with write_file(), lossless.
///
/// The display window starts at (0, 0) and is the smallest window around all parts without their margins.
///
/// @throws Error if there is no part, a part has no channels or no pixels outside its margins, a channel differs in
///               size from its part, names are empty, parts have equal names, an attribute name is reserved by EXR, or
///               the file cannot be written
PETZVAL_API void write_exr(std::span<const ExrPart> parts, const std::filesystem::path& file);

/// The window of an EXR file whose pixels are read. Pixels of `display` outside the data window are 0.
enum class ExrWindow { data, display };

/// Reads all parts of an EXR file with scan lines or tiles.
///
/// Channels of any type are converted to float. Attributes of other types and attributes of every EXR file are skipped.
///
/// @throws Error if the file cannot be read or has more than 3 GiB of values
PETZVAL_API std::vector<ExrPart> read_exr_parts(const std::filesystem::path& file, ExrWindow window = ExrWindow::data);

/// Writes 32-bit float channels R, G, B to an EXR file with write_file(), lossless.
///
/// @throws Error if the image has no pixels or is inconsistent, or the file cannot be written
PETZVAL_API void write_exr(const RgbImage& image, const std::filesystem::path& file);

/// Reads channels R, G, B of the first part of an EXR file as float.
///
/// @throws Error if the file cannot be read or a channel is missing
PETZVAL_API RgbImage read_exr(const std::filesystem::path& file);

/// Writes a PFM file with write_file(), for scripts without image libraries.
///
/// The format is "PF", width and height, -1.0 (little-endian), then RGB triples of 32-bit floats, rows from the bottom.
///
/// @throws Error if the image has no pixels or is inconsistent, or the file cannot be written
PETZVAL_API void write_pfm(const RgbImage& image, const std::filesystem::path& file);
/// Writes a PFM file with one channel ("Pf"). `values` has width x height values, rows from the top.
PETZVAL_API void write_pfm(int width, int height, std::span<const float> values, const std::filesystem::path& file);

/// Reads a PFM file of either byte order. A single channel ("Pf") is copied to all three.
///
/// @throws Error if the file cannot be read or has more than 2^26 pixels
PETZVAL_API RgbImage read_pfm(const std::filesystem::path& file);

/// Reads an 8-bit or 16-bit PNG file as linear light.
///
/// Values are decoded as sRGB; a gamma stated in the file and alpha are ignored.
///
/// @throws Error if the file cannot be read or has more than 2^26 pixels
PETZVAL_API RgbImage read_png(const std::filesystem::path& file);

/// The bytes of an 8-bit sRGB PNG file, to embed it in another file.
///
/// @throws Error if the image has no pixels or is inconsistent
PETZVAL_API std::string to_png(const Rgb8Image& image);

/// Writes an 8-bit sRGB PNG file with write_file().
///
/// @param image  the picture
/// @param file   the file to write
/// @param texts  tEXt chunks by keyword, in Latin-1
/// @throws Error if the image has no pixels or is inconsistent, a keyword is not 1 to 79 bytes long, or the file cannot
///               be written
PETZVAL_API void write_png(const Rgb8Image& image, const std::filesystem::path& file,
                           const std::map<std::string, std::string>& texts = {});

/// Reads weights over the stop from an image: grey values, or the mean of R, G and B. Alpha is ignored.
///
/// @param file    an EXR file (.exr) with a channel Y or R, G and B, or a PNG file, whose values are scaled to 0 to 1
///                without gamma
/// @throws Error  if the file cannot be read, has other channels, or has more than 2^26 pixels
PETZVAL_API IrisMap read_iris_map(const std::filesystem::path& file);

/// Removes the squeeze of an anamorphic image by linear interpolation.
///
/// @param image    the image
/// @param squeeze  squeeze(lens): the factor by which the image is widened. Below 1, the height is divided by `squeeze`
///                 instead, to keep all detail
/// @throws Error   if the image has no pixels or is inconsistent, the squeeze is not positive and finite, or the result
///                 has more than 2^30 pixels
PETZVAL_API RgbImage desqueezed(const RgbImage& image, double squeeze);

/// Converts linear light times `exposure` to 8-bit sRGB. Values are clipped to 0 to 1; NaN becomes black.
PETZVAL_API Rgb8Image to_srgb8(const RgbImage& image, float exposure = 1.0f);

}  // namespace petzval
