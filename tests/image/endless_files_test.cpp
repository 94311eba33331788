// SPDX-License-Identifier: Apache-2.0
// No reader takes more memory from an endless or huge file than its stated limit.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/core/files.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "petzval/image/psf.hpp"

namespace petzval {
namespace endless_files_test {

using testing::expect_error;

namespace fs = std::filesystem;
using Read = std::function<void(const fs::path&)>;

/// Readers that take whole files into memory.
const std::vector<std::pair<std::string, Read>> of_bytes = {
    {"lens", [](const fs::path& file) { read_lens(file); }},
    {"glasses", [](const fs::path& file) { read_glasses(file); }},
    {"glass table",
     [](const fs::path& file) {
       const fs::path folder = fs::path(::testing::TempDir()) / ("petzval_endless_glass_" + std::to_string(getpid()));
       fs::create_directories(folder);
       fs::remove(folder / "glass_x.csv");
       fs::create_symlink(fs::absolute(file), folder / "glass_x.csv");
       GlassCatalogue::load(folder);
     }},
    {"floats", [](const fs::path& file) { read_floats(file); }},
    {"spectrum", [](const fs::path& file) { Spectrum::load(file); }},
    {"colour matching functions", [](const fs::path& file) { ColourMatching::load(file); }},
};
/// Image readers; the header states the size to read.
const std::vector<std::pair<std::string, Read>> of_pictures = {
    {"PFM", [](const fs::path& file) { read_pfm(file); }},
    {"PNG", [](const fs::path& file) { read_png(file); }},
    {"EXR", [](const fs::path& file) { read_exr(file); }},
    {"EXR parts", [](const fs::path& file) { read_exr_parts(file); }},
    {"deep EXR", [](const fs::path& file) { read_deep_exr(file); }},
    {"PSF set", [](const fs::path& file) { read_psf_set(file); }},
};

TEST(EndlessFiles, OfBytes_AreRefusedWithSizeAndLimit) {
  const fs::path huge = fs::path(::testing::TempDir()) / ("petzval_huge_" + std::to_string(getpid()));
  std::ofstream(huge) << "x";
  fs::resize_file(huge, largest_file_bytes + 1);
  for (const auto& [kind, read] : of_bytes) {
    SCOPED_TRACE(kind);
    for (const fs::path& file : {fs::path("/dev/zero"), huge}) {
      expect_error([&, &reader = read] { reader(file); }, {largest_file_bytes});
    }
  }
  fs::remove(huge);
}

TEST(EndlessFiles, OfPictures_AreRefusedByTheirHeads) {
  for (const auto& [kind, read] : of_pictures) {
    SCOPED_TRACE(kind);
    expect_error([&reader = read] { reader("/dev/zero"); }, {"/dev/zero"});
  }
  const fs::path digits = fs::path(::testing::TempDir()) / ("petzval_digits_" + std::to_string(getpid()));
  for (const std::string& endless : {std::string(1 << 20, '1'), std::string(1 << 20, ' ')}) {
    std::ofstream(digits) << "PF\n3 " << endless;
    expect_error([&] { read_pfm(digits); }, {digits});
  }
  fs::remove(digits);
}

}  // namespace endless_files_test
}  // namespace petzval
