// SPDX-License-Identifier: Apache-2.0
// EXR, PNG and PFM files, flat and deep: as many values as the file states, or an Error.
#include "petzval/blur/layers.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "petzval/image/psf.hpp"

#include <string>

#include "../png_checksums.hpp"
#include "laws.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  static const fuzz::ScratchFile file(".picture");
  // Fuzzers cannot guess the checksums of a PNG.
  const std::string read(reinterpret_cast<const char*>(data), size);
  const std::string bytes = read.starts_with("\x89PNG") ? testing::with_checksums(read) : read;
  const auto& path = file.holding(bytes);
  const auto whole = [](const RgbImage& image) {
    fuzz::require(image.pixels.size() == std::size_t(image.width) * std::size_t(image.height) * 3,
                  "an image has a value for each pixel and channel");
  };
  if (bytes.starts_with('P')) {
    fuzz::done([&] { whole(read_pfm(path)); });
  } else if (bytes.starts_with("\x89PNG")) {
    fuzz::done([&] { whole(read_png(path)); });
    fuzz::done([&] { read_iris_map(path); });
  } else {
    fuzz::done([&] { whole(read_exr(path)); });
    fuzz::done([&] {
      for (const ExrPart& part : read_exr_parts(path)) {
        for (const auto& [name, values] : part.channels) {
          fuzz::require(values.size() == std::size_t(part.width) * std::size_t(part.height),
                        "a channel has a value for each pixel");
        }
      }
    });
    fuzz::done([&] { read_psf_set(path); });
    fuzz::done([&] {
      const FragmentLists lists = read_deep_exr(path).lists;
      fuzz::require(lists.offsets.size() == std::size_t(lists.columns) * std::size_t(lists.rows) + 1,
                    "a deep picture has an offset for each pixel");
      fuzz::require(lists.offsets.back() == lists.fragments.size(),
                    "a deep picture has as many samples as its offsets state");
      LayerSet layers;
      layers.peel_fragments(lists, 1e-6, 4);
    });
  }
  return 0;
}
