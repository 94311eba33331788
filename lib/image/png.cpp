// SPDX-License-Identifier: Apache-2.0
#include "image/png.hpp"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <memory>
#include <string>

#include "core/open_file.hpp"
#include "image/file_capacity.hpp"
#include "petzval/core/error.hpp"

namespace petzval::image_detail {
namespace {

/// The rows of an open PNG file, 16 bits per channel. No member has a destructor, because libpng leaves functions by
/// longjmp if an error occurs.
struct PngRows {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::uint32_t width = 0, height = 0, channels = 0;
  std::size_t stored_row = 0;  ///< uncompressed bytes of a row in the file
};
bool read_head(std::FILE* file, PngRows& rows) noexcept {
  rows.png = png_create_read_struct(
      PNG_LIBPNG_VER_STRING, nullptr, [](png_structp png, png_const_charp) { png_longjmp(png, 1); },
      [](png_structp, png_const_charp) {});
  if (rows.png) rows.info = png_create_info_struct(rows.png);
  if (!rows.info || setjmp(png_jmpbuf(rows.png))) return false;
  png_init_io(rows.png, file);
  png_read_info(rows.png, rows.info);
  rows.stored_row = png_get_rowbytes(rows.png, rows.info);
  png_set_expand_16(rows.png);
  png_set_strip_alpha(rows.png);
  png_set_interlace_handling(rows.png);
  png_read_update_info(rows.png, rows.info);
  rows.width = png_get_image_width(rows.png, rows.info), rows.height = png_get_image_height(rows.png, rows.info);
  rows.channels = png_get_channels(rows.png, rows.info);
  return true;
}
bool read_rows(PngRows& rows, png_bytepp to) noexcept {
  if (setjmp(png_jmpbuf(rows.png))) return false;
  png_read_image(rows.png, to);
  return true;
}

}  // namespace

void check_size(std::size_t width, std::size_t height, const std::filesystem::path& file) {
  constexpr std::size_t max_pixels = std::size_t(1) << 26;
  if (width <= max_pixels / height) return;
  throw Error(file.string() + ": size = " + std::to_string(width) + " x " + std::to_string(height) +
              " pixels; must be at most " + std::to_string(max_pixels) + " pixels");
}

PngPicture read_png_picture(const std::filesystem::path& file) {
  core_detail::refuse_folder(file, "a picture");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> open(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!open) throw Error(file.string() + ": cannot be opened (" + core_detail::reason() + "); must be a picture");
  PngRows rows;
  const auto end = [](PngRows* own) { png_destroy_read_struct(&own->png, &own->info, nullptr); };
  const std::unique_ptr<PngRows, decltype(end)> ended(&rows, end);
  const auto refuse = [&] { throw Error(file.string() + ": cannot be read; must be a complete PNG file"); };
  if (!read_head(open.get(), rows)) refuse();
  check_size(rows.width, rows.height, file);
  // Deflate expands a byte to at most 1032 bytes.
  if (!fits_in_file(rows.stored_row * rows.height, 1 << 11, file)) refuse();
  const std::size_t row_bytes = std::size_t{2} * rows.channels * rows.width;
  std::vector<std::uint8_t> bytes(row_bytes * rows.height);
  std::vector<png_bytep> row_begins;
  for (std::size_t y = 0; y < rows.height; ++y) row_begins.push_back(&bytes[y * row_bytes]);
  if (!read_rows(rows, row_begins.data())) refuse();
  PngPicture picture{rows.width, rows.height, rows.channels, {}};
  picture.values.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    picture.values.push_back(static_cast<std::uint16_t>(bytes[i] << 8 | bytes[i + 1]));
  }
  return picture;
}

}  // namespace petzval::image_detail
