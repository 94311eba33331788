// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/files.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/io/json.hpp"

namespace petzval::testing {

struct Writer {
  std::string name;
  std::function<void(const std::filesystem::path&)> write;
};

/// A writer for each kind of file. Each writes more than 256 bytes.
inline std::vector<Writer> writers() {
  const Prescription lens = data_prescription("double_gauss_100mm_f2_28deg");
  const Lens compiled = compile(lens);
  RgbImage image(32, 24);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i % 101) / 101;
  FragmentLists lists{.columns = 8, .rows = 6, .offsets = {0}, .fragments = {}};
  for (std::size_t i = 0; i < 48; ++i) {
    for (std::size_t k = 0; k <= i % 3; ++k) lists.fragments.push_back({1000.0f + static_cast<float>(i * k), 1, 2, 3});
    lists.offsets.push_back(lists.fragments.size());
  }
  PsfKernel kernel{.pixels = 9, .pixel_mm = 0.01};
  kernel.light.assign(81, 0.25f), kernel.hits_x.assign(81, 0.5f), kernel.hits_y.assign(81, -0.5f);
  const PsfSetPoint point{.field_deg = 7, .distance_mm = 1000, .wavelength_nm = 587.5618, .f_number = 2};
  return {
      {"lens.json", [=](const auto& file) { write_prescription(lens, file); }},
      {"image.exr", [=](const auto& file) { write_exr(image, file); }},
      {"psf_set.exr",
       [=](const auto& file) {
         const ExrPart part = to_exr_part(kernel, point);
         write_exr({&part, 1}, file);
       }},
      {"deep.exr", [=](const auto& file) { write_deep_exr(lists, file); }},
      {"image.png", [=](const auto& file) { write_png(to_srgb8(image), file); }},
      {"image.pfm", [=](const auto& file) { write_pfm(image, file); }},
      {"figure.svg",
       [=](const auto& file) {
         write_file(footprint_figure(compiled, -2000, std::array{0.0, 0.1}), file);
       }},
      {"tables.f32", [=](const auto& file) { write_floats(image.pixels, file); }},
  };
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

}  // namespace petzval::testing
