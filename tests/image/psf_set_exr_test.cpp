// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/psf.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "../expect_error.hpp"

namespace petzval {
namespace psf_set_exr_test {

using testing::expect_error;

const PsfSet::Axes axes{{0, 10.1}, {1000, HUGE_VAL}, {587.5618}, {2}};

PsfKernel kernel(float value) {
  PsfKernel result{.pixels = 3, .pixel_mm = 0.1};
  result.light.assign(9, value);
  result.hits_x = {0, 1, -2, std::nanf(""), 4, 5, 6, 7, value},
  result.hits_y = {1, 2, 3, std::nanf(""), 5, 6, 7, 8, -0.f};
  result.chief_ray = value > 1;
  result.anchor_mm = {0.25, -17.1};
  result.total = 9 * static_cast<double>(value);
  result.throughput = 1 / 3.0, result.error = 0.01, result.rays = 1024;
  result.diffraction = value > 2 ? Diffraction::visible : Diffraction::dominant;
  return result;
}

std::vector<std::uint32_t> bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> result;
  for (const float value : values) result.push_back(std::bit_cast<std::uint32_t>(value));
  return result;
}

TEST(PsfSetExr, KernelsRoundTripFromPartsInAnyOrder) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_psf_set.exr";
  std::vector<ExrPart> parts;
  for (const std::size_t node : {2u, 0u, 3u, 1u}) {
    parts.push_back(to_exr_part(kernel(static_cast<float>(node) + 0.1f), axes.point(node)));
  }
  EXPECT_EQ(parts[0].name, "0deg_inf_587.5618nm_f2");
  EXPECT_EQ(parts[3].name, "10.1deg_1000mm_587.5618nm_f2");
  write_exr(parts, file);
  const PsfSet set = read_psf_set(file);
  EXPECT_EQ(set.axes(), axes);
  for (std::size_t node = 0; node < axes.size(); ++node) {
    const PsfKernel &back = set.kernels()[node], wanted = kernel(static_cast<float>(node) + 0.1f);
    EXPECT_EQ(bits(back.light), bits(wanted.light));
    EXPECT_EQ(bits(back.hits_x), bits(wanted.hits_x));
    EXPECT_EQ(bits(back.hits_y), bits(wanted.hits_y));
    EXPECT_EQ(back.pixels, wanted.pixels);
    EXPECT_EQ(back.pixel_mm, wanted.pixel_mm);
    EXPECT_EQ(back.chief_ray, wanted.chief_ray);
    EXPECT_EQ(back.anchor_mm, wanted.anchor_mm);
    EXPECT_EQ(back.total, wanted.total);
    EXPECT_EQ(back.throughput, wanted.throughput);
    EXPECT_EQ(back.error, wanted.error);
    EXPECT_EQ(back.rays, wanted.rays);
    EXPECT_EQ(back.diffraction, wanted.diffraction);
  }

  parts.pop_back();
  write_exr(parts, file);
  expect_error([&] { read_psf_set(file); }, {file, "\"10.1deg_1000mm_587.5618nm_f2\""});
  std::filesystem::remove(file);
}

TEST(PsfSetExr, RefusesChangedAndOtherParts) {
  const auto refused = [&](auto&& change, const testing::Token& token) {
    ExrPart part = to_exr_part(kernel(1), axes.point(0));
    change(part);
    expect_error([&] { from_exr_part(part); }, {"part \"0deg_1000mm_587.5618nm_f2\"", token});
  };
  refused([](ExrPart& p) { p.channels.at("Y")[4] += 1e-6f; }, "file");
  refused([](ExrPart& p) { p.channels.at("hits.y")[8] = 0; }, "file");  // was -0
  refused([](ExrPart& p) { p.numbers["error"] += 1e-16; }, "file");
  refused([](ExrPart& p) { p.numbers["more"] = 1; }, "file");
  refused([](ExrPart& p) { p.texts["anchor"] = "chief_ray"; }, "file");
  refused([](ExrPart& p) { p.texts["diffraction"] = "none"; }, "file");
  refused([](ExrPart& p) { p.numbers.erase("total"); }, "total");
  refused([](ExrPart& p) { p.texts.erase("anchor"); }, "anchor");
  refused([](ExrPart& p) { p.channels.erase(p.channels.begin()); }, "channel");
}

}  // namespace psf_set_exr_test
}  // namespace petzval
