// SPDX-License-Identifier: Apache-2.0
#include "layers/jpeg.hpp"

#include "petzval/core/error.hpp"

#ifdef PETZVAL_HAS_JPEG
#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <jpeglib.h>  // after <cstdio>

#include <jerror.h>

#include "support/cli.hpp"
#include "support/files.hpp"

namespace lens_blur {
namespace {

using petzval::Error;

constexpr int exif_marker = JPEG_APP0 + 1, profile_marker = JPEG_APP0 + 2;

/// A JPEG file being read. No member has a destructor, because libjpeg leaves functions by longjmp if an error occurs.
struct Decoder {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  char message[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void leave(j_common_ptr info) {
  auto& decoder = *static_cast<Decoder*>(info->client_data);
  (*info->err->format_message)(info, decoder.message);
  std::longjmp(decoder.back, 1);
}

/// Treats warnings, such as a missing end, as errors; bytes between segments do no harm.
void warned(j_common_ptr info, int level) {
  if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) leave(info);
}

bool read_head(Decoder& decoder, std::string_view bytes) noexcept {
  decoder.info.err = jpeg_std_error(&decoder.errors);
  decoder.errors.error_exit = leave, decoder.errors.emit_message = warned;
  decoder.info.client_data = &decoder;
  if (setjmp(decoder.back)) return false;
  jpeg_create_decompress(&decoder.info);
  decoder.info.client_data = &decoder;
  jpeg_mem_src(&decoder.info, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  for (const int marker : {exif_marker, profile_marker}) jpeg_save_markers(&decoder.info, marker, 0xffff);
  jpeg_read_header(&decoder.info, TRUE);
  return true;
}
bool start(Decoder& decoder) noexcept {
  if (setjmp(decoder.back)) return false;
  decoder.info.out_color_space = JCS_RGB;
  jpeg_start_decompress(&decoder.info);
  return true;
}
bool read_row(Decoder& decoder, JSAMPLE* row) noexcept {
  if (setjmp(decoder.back)) return false;
  jpeg_read_scanlines(&decoder.info, &row, 1);
  return true;
}

/// The orientation in the first directory of EXIF data, 1 to 8; 1 (upright) if there is none.
int orientation(std::string_view exif) {
  using namespace std::string_view_literals;
  if (!exif.starts_with("Exif\0\0"sv)) return 1;
  exif.remove_prefix(6);
  const bool little = exif.starts_with("II");
  const auto number = [&](std::size_t at, std::size_t size) {
    std::size_t value = 0;
    for (std::size_t i = 0; i < size && at + size <= exif.size(); ++i) {
      value = value << 8 | static_cast<unsigned char>(exif[little ? at + size - 1 - i : at + i]);
    }
    return value;
  };
  const std::size_t directory = number(4, 4), entries = number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i, value = number(entry + 8, 2);
    if (number(entry, 2) == 0x112) return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

/// Turns a picture upright.
petzval::RgbImage upright(const petzval::RgbImage& image, int orientation) {
  if (orientation == 1) return image;
  const int w = image.width, h = image.height;
  const bool turned = orientation >= 5;
  petzval::RgbImage result(turned ? h : w, turned ? w : h);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      int column = turned ? y : x, row = turned ? x : y;
      if (orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8) column = w - 1 - column;
      if (orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7) row = h - 1 - row;
      std::copy_n(image.pixel(column, row), 3, result.pixel(x, y));
    }
  }
  return result;
}

/// True for a part of an ICC profile that is named sRGB, in bytes or in UTF-16.
bool names_srgb(std::string profile) {
  std::erase(profile, '\0');
  return profile.find("sRGB") != std::string::npos;
}

}  // namespace

petzval::RgbImage read_jpeg(const std::filesystem::path& file) {
  const std::string bytes = examples::read_text(file);
  Decoder decoder;
  const auto end = [](Decoder* own) { jpeg_destroy_decompress(&own->info); };
  const std::unique_ptr<Decoder, decltype(end)> ended(&decoder, end);
  const auto refuse = [&] {
    throw Error(file.string() + ": cannot be read (" + decoder.message + "); must be a complete JPEG file");
  };
  if (!read_head(decoder, bytes)) refuse();
  if (decoder.info.num_components != 1 && decoder.info.num_components != 3) {
    throw Error(file.string() + ": components = " + std::to_string(decoder.info.num_components) +
                "; must be 1 (grey) or 3 (RGB), not inks (CMYK)");
  }
  constexpr std::size_t max_pixels = std::size_t(1) << 26;
  const std::size_t width = decoder.info.image_width, height = decoder.info.image_height;
  if (width * height > max_pixels) {
    throw Error(file.string() + ": size = " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels; must be at most " + std::to_string(max_pixels) + " pixels");
  }
  int turn = 1;
  bool profiled = false, srgb = false;
  for (const jpeg_marker_struct* m = decoder.info.marker_list; m; m = m->next) {
    const std::string_view data(reinterpret_cast<const char*>(m->data), m->data_length);
    if (m->marker == exif_marker && turn == 1) turn = orientation(data);
    if (m->marker == profile_marker && data.starts_with("ICC_PROFILE")) {
      profiled = true, srgb = srgb || names_srgb(std::string(data));
    }
  }
  if (profiled && !srgb) examples::note(file.string() + ": the colour profile is ignored; colours are read as sRGB");

  std::array<float, 256> linear;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const double v = static_cast<double>(i) / 255;
    linear[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  if (!start(decoder)) refuse();
  petzval::RgbImage image(static_cast<int>(width), static_cast<int>(height));
  std::vector<JSAMPLE> row(3 * width);
  for (int y = 0; y < image.height; ++y) {
    if (!read_row(decoder, row.data())) refuse();
    for (std::size_t i = 0; i < row.size(); ++i) image.pixel(0, y)[i] = linear[row[i]];
  }
  return upright(image, turn);
}

}  // namespace lens_blur
#else

namespace lens_blur {

petzval::RgbImage read_jpeg(const std::filesystem::path& file) {
  throw petzval::Error(file.string() + ": petzval was built without libjpeg; must be PNG, PFM or EXR");
}

}  // namespace lens_blur
#endif
