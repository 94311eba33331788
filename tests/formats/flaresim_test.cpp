// SPDX-License-Identifier: Apache-2.0
// The .lens files of FlareSim.
#include <gtest/gtest.h>

#include <string>

#include "lens_text.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace flaresim_test {

using petzval::Prescription;
using petzval::testing::expect_tokens;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

/// 49.83 mm, f/4.98 by semi-diameters.
const std::string lens = R"(# A singlet 50mm f/4.98
#
# Patent: none
# 3 surfaces, 1 glass element, f/5.0

name: Singlet 50mm f/4.98
focal_length: 49.83

surfaces:
# radius       thickness    ior      abbe     semi_ap   coating
  50.6         5.2          1.5168   64.2     12.7      1      # front
  -50.6        1            1.00000  0.00     12.7      0
  stop         46.1         1.00000  0.00     4.7       0
)";

TEST(FlareSim, HasTheValuesOfTheFile) {
  const Prescription p = read(lens);
  EXPECT_EQ(p.imported->format, "flaresim");
  EXPECT_EQ(p.imported->title, "Singlet 50mm f/4.98");
  EXPECT_EQ(p.focal_length_mm, 49.83);
  EXPECT_EQ(p.f_number, 4.98);  // from the name; comments round the f-number
  EXPECT_EQ(p.imported->notes.size(), 3u);
  EXPECT_TRUE(p.imported->warnings.empty());
  const std::vector<petzval::SurfaceRow> expected = {
      {.radius = 50.6,
       .thickness = 5.2,
       .medium = {.nd = 1.5168, .vd = 64.2},
       .semi_diameter = 12.7,
       .comment = "front"},
      {.radius = -50.6, .thickness = 1, .semi_diameter = 12.7},
      {.radius = 0, .thickness = 46.1, .semi_diameter = 4.7, .stop = true}};
  EXPECT_EQ(p.surfaces, expected);
  EXPECT_EQ(read(with(lens, "  stop  ", "  STOP  ")).surfaces, expected);
  EXPECT_EQ(read(with(with(lens, "# radius       thickness    ior      abbe     semi_ap   coating\n", ""), "# front",
                      "#front"))
                .surfaces,
            expected);
}

// The name of a lens with a converter has the f-number of the bare lens.
TEST(FlareSim, FNumberOfTheRowsBeatsTheName) {
  const Prescription p = read(with(with(lens, "name: Singlet 50mm f/4.98", "name: Singlet 35mm F3.5 with 1.4X TC"),
                                   "# A singlet 50mm f/4.98", "# A singlet 35mm F3.5"));
  EXPECT_EQ(p.f_number, 5);
  expect_tokens(warning(p, "f-number"), {"f/5", "f/3.5"});
}

// Most files of the public collection have diameters in the column of semi-diameters.
TEST(FlareSim, DiametersAreRecognisedByTheDeclaredFNumber) {
  std::string diameters = lens;
  for (const auto& [old, now] :
       {std::pair("12.7      1", "25.4  1"), std::pair("12.7      0", "25.4  0"), std::pair("4.7 ", "9.4 ")})
    diameters = with(diameters, old, now);
  EXPECT_EQ(read(diameters).surfaces, read(lens).surfaces);
  expect_tokens(warning(diameters, "aperture"), {"diameters", 4.98});
  // Without an f-number the name of the column decides, with a warning.
  std::string silent = lens;
  while (silent.find("f/") != std::string::npos) silent = with(silent, "f/", "n=");
  EXPECT_EQ(read(silent).surfaces, read(lens).surfaces);
  EXPECT_NE(warning(silent, "aperture"), "no warning");
}

TEST(FlareSim, PlanesAndCylindersHaveWords) {
  for (const char* plane : {"inf ", "0   ", "INF "}) EXPECT_EQ(read(with(lens, "-50.6", plane)).surfaces[1].radius, 0);
  const auto type = [](const std::string& word) { return with(lens, "12.7      0", "12.7      0   " + word); };
  EXPECT_EQ(read(type("cyl_y")).surfaces[1].curved_in, petzval::Section::x);
  EXPECT_EQ(read(type("cyl_x")).surfaces[1].curved_in, petzval::Section::y);
  EXPECT_EQ(read(type("sph")).surfaces, read(lens).surfaces);
  expect_tokens(refusal(type("toric")), {"x:12", "type", "\"toric\""});
  expect_tokens(refusal(type("toric -95")), {"x:12", "row"});
}

TEST(FlareSim, UnknownInputIsRefusedOrNamed) {
  expect_tokens(refusal(lens + "asphere 0 0 1e-6\n"), {"x:14", "row", "\"asphere\""});
  expect_tokens(refusal(with(lens, "5.2 ", "5,2 ")), {"x:11", "thickness", "\"5,2\""});
  expect_tokens(refusal(with(lens, "49.83", "long")), {"x:7", "focal_length", "\"long\""});
  expect_tokens(refusal(with(lens, "1.5168 ", "15168  ")), {"x:11", "index", 15168});
  expect_tokens(refusal(with(lens, "surfaces:", "all surfaces\nsurfaces:")), {"x:9"});
  EXPECT_NE(warning(with(lens, "name:", "maker: me\nname:"), "maker"), "no warning");
  expect_tokens(refusal(lens.substr(0, lens.find("  50.6"))), {"rows"});
}

}  // namespace flaresim_test
