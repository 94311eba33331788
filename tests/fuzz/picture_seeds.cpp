// SPDX-License-Identifier: Apache-2.0
// Images of a few pixels, written by the library.
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "petzval/image/psf.hpp"
#include "scratch_file.hpp"
#include "seeds.hpp"

namespace petzval::fuzz {
namespace {

RgbImage picture() {
  RgbImage image(5, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.1f * static_cast<float>(i);
  return image;
}

std::string written(const auto& write) {
  const ScratchFile file(".seed");
  write(file.path());
  return file.bytes();
}

}  // namespace

std::vector<std::string> exr_files() {
  PsfKernel kernel{.pixels = 3, .pixel_mm = 0.1, .light = std::vector<float>(9, 1.0f)};
  kernel.hits_x = kernel.hits_y = kernel.light;
  const std::vector<ExrPart> parts{to_exr_part(kernel, {0, 1000, 587.5618, 2}),
                                   to_exr_part(kernel, {10, 1000, 587.5618, 2})};
  return {written([](const auto& file) { write_exr(picture(), file); }),
          written([&](const auto& file) { write_exr(parts, file); })};
}

std::vector<std::string> deep_exr_files() {
  FragmentLists lists{.columns = 3, .rows = 2, .offsets = {0, 1, 3, 3, 4, 4, 6}, .fragments = {}};
  for (int i = 0; i < 6; ++i)
    lists.fragments.push_back({1000.0f + 100.0f * static_cast<float>(i), 1, 0.5f, 0.2f, 0.7f});
  return {written([&](const auto& file) { write_deep_exr(lists, file); })};
}

std::vector<std::string> png_files() {
  return {written([](const auto& file) { write_png(to_srgb8(picture(), 0.2f), file); })};
}

std::vector<std::string> pfm_files() {
  const RgbImage image = picture();
  return {written([&](const auto& file) { write_pfm(image, file); }),
          written([&](const auto& file) { write_pfm(5, 4, std::span(image.pixels).first(20), file); })};
}

}  // namespace petzval::fuzz
