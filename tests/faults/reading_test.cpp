// SPDX-License-Identifier: Apache-2.0
// Failing allocations while a lens is read or written as text.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "allocations.hpp"
#include "petzval/core/error.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace reading_test {

using testing::data_prescription;
using testing::expect_all_or_nothing;
using testing::expect_all_or_nothing_at_first;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string sample(const char* name) { return bytes_of(std::filesystem::path(PETZVAL_TEST_SAMPLES) / name); }

const std::string lentil =
    R"({"1": {"product-name": "singlet", "focal-length-mm-patent": 50, "fstop": 5, "optical-elements-patent": [
  {"radius": 0, "thickness": [2, 3, 4], "material": "iris", "ior": 1, "abbe": 0, "housing-radius": 4.9, "lens-geometry": "planar"},
  {"radius": 50.6, "thickness": 5.2, "material": "BK7", "ior": 1.5168, "abbe": 64.2, "housing-radius": 12, "lens-geometry": "spherical"},
  {"radius": -50.6, "thickness": 47, "material": "air", "ior": 1, "abbe": 0, "housing-radius": 12, "lens-geometry": "spherical"}]}})";

const std::string optiland = R"({"version": 1.0,
  "aperture": {"type": "EPD", "value": 10},
  "wavelengths": {"wavelengths": [{"value": 0.5876, "is_primary": true, "unit": "um"}]},
  "surface_group": {"surfaces": [
    {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"z": -Infinity}, "radius": Infinity}, "material_post": {"type": "IdealMaterial", "index": 1.0}},
    {"type": "Surface", "geometry": {"type": "StandardGeometry", "cs": {"z": 0}, "radius": 50, "conic": -0.5}, "is_stop": true,
     "material_post": {"type": "Material", "filename": "data/glass/schott/N-BK7.yml", "name": "N-BK7"}},
    {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 4}, "radius": Infinity}, "material_post": {"type": "IdealMaterial", "index": 1.0}},
    {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 90}, "radius": Infinity}, "material_post": {"type": "IdealMaterial", "index": 1.0}}]}})";

/// A short lens with catalogue glasses in each format.
std::vector<std::pair<std::string, std::string>> files() {
  const Prescription lens = data_prescription("double_gauss_100mm_f2_28deg"), simple = testing::open_singlet(8);
  return {{"petzval", format_prescription(data_prescription("phone_5.6mm_f3.5"))},
          {"zemax", format_zemax(lens).text},
          {"codev", format_codev(lens).text},
          {"oslo", sample("oslo_words.len")},
          {"opticalbench", sample("opticalbench_macro.txt")},
          {"table", format_table(simple).text},
          {"lentil", lentil},
          {"optiland", optiland}};
}

TEST(MemoryEnds, WhileALensOfAnyFormatIsRead) {
  for (const auto& [format, text] : files()) {
    SCOPED_TRACE(format);
    expect_all_or_nothing([&bytes = text] { return format_prescription(parse_lens(bytes, "x")); });
  }
}

/// Messages of errors are complete as well.
TEST(MemoryEnds, WhileALensIsRefused) {
  for (const auto& [format, text] : files()) {
    SCOPED_TRACE(format);
    const std::string cut = text.substr(0, text.size() / 2);
    expect_all_or_nothing([&]() -> std::string {
      try {
        return format_prescription(parse_lens(cut, "x"));
      } catch (const Error& error) {
        return error.what();
      }
    });
  }
}

TEST(MemoryEnds, WhileTheGlassesAreReadForTheFirstLens) {
  const std::string text =
      bytes_of(std::filesystem::path(PETZVAL_TEST_DATA) / "lenses/double_gauss_100mm_f2_28deg.json");
  expect_all_or_nothing_at_first([&] {
    const Lens lens = compile(parse_lens(text, "x"));
    return std::to_string(first_order(lens).effective_focal_length);
  });
}

TEST(MemoryEnds, WhileACatalogueIsRead) {
  expect_all_or_nothing([] {
    const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
    return std::to_string(glasses.glasses().size()) + glasses.glasses().back().name;
  });
}

TEST(MemoryEnds, WhileALensIsWrittenInOtherFormats) {
  const Prescription lens = data_prescription("double_gauss_100mm_f2_28deg");
  expect_all_or_nothing([&] { return format_zemax(lens).text; });
  expect_all_or_nothing([&] { return format_codev(lens).text; });
  expect_all_or_nothing([&] { return format_table(lens).text; });
}

}  // namespace reading_test
}  // namespace petzval
