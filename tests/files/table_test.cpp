// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "lens_text.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace {

using petzval::Prescription;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

/// 49.83 mm, f/4.98 by diameters.
const std::string table = R"(# A singlet 50 mm f/5
// radius  thickness  n  aperture
50.6   5.2  1.5168  25.4
-50.6  1    1       25.4
0      47   0       9.4
)";

TEST(Table, FourColumnsAreRadiusThicknessIndexAndDiameter) {
  const Prescription p = read(table);
  EXPECT_EQ(p.imported->format, "table");
  EXPECT_EQ(p.imported->title, "A singlet 50 mm f/5");
  EXPECT_EQ(p.focal_length_mm, 50);
  EXPECT_EQ(p.f_number, 5);
  EXPECT_TRUE(p.imported->warnings.empty());
  ASSERT_EQ(p.surfaces.size(), 3u);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 12.7);
  EXPECT_EQ(p.surfaces[0].medium.nd, 1.5168);
  EXPECT_TRUE(p.surfaces[2].stop);
  EXPECT_EQ(p.surfaces[2].medium.nd, 1);
  EXPECT_EQ(p.surfaces[2].semi_diameter, 4.7);
}

TEST(Table, SemiDiametersAreToldByTheDeclaredFNumber) {
  const std::string radii =
      with(with(with(table, "1.5168  25.4", "1.5168  12.7"), "1       25.4", "1       12.7"), "9.4", "4.7");
  const Prescription p = read(radii);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 12.7);
  EXPECT_EQ(p.surfaces[2].semi_diameter, 4.7);
  EXPECT_NE(warning(p, "aperture").find("taken as semi-diameters"), std::string::npos);
}

TEST(Table, FiveColumnsHaveVNumbersInEitherOrder) {
  const std::string five = "50.6 5.2 1.5168 64.17 25.4\n-50.6 1 1 0 25.4\n0 47 1 0 9.7\n";
  const Prescription p = read(five);
  EXPECT_EQ(p.surfaces[0].medium.vd, 64.17);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 12.7);
  EXPECT_TRUE(p.surfaces[2].stop);  // a plane in air where no index is 0
  const Prescription other = read("50.6 5.2 1.5168 12 64.17\n-50.6 1 1 12 0\n0 47 1 9.7 0\n");
  EXPECT_EQ(other.surfaces[0].medium.vd, 64.17);
  EXPECT_NE(warning(other, "columns"), "no warning");
}

TEST(Table, GapsInFrontAreToldByAGlassWithoutThickness) {
  const Prescription p = read("50.6 0 1.5168 25.4\n-50.6 5.2 1 25.4\n0 1 0 9.7\n");
  EXPECT_EQ(p.surfaces[0].thickness, 5.2);
  EXPECT_EQ(p.surfaces[1].thickness, 1);
  EXPECT_NE(warning(p, "thickness"), "no warning");
  EXPECT_NEAR(p.surfaces[2].thickness, petzval::first_order(compile(p)).back_focal_distance, 1e-9);
}

TEST(Table, APlaneOfGlassIsNoStop) {
  const Prescription p = read("50.6 5.2 1.5168 25.4\n0 1 1 25.4\n0 47 0 9.7\n");
  EXPECT_FALSE(p.surfaces[1].stop);
  EXPECT_TRUE(p.surfaces[2].stop);
}

TEST(Table, BadRowsAreRefusedWithTheirLine) {
  EXPECT_EQ(refusal(with(table, "1.5168", "1,5168")),
            "x: line 3: index is \"1,5168\", wanted a finite number with a decimal point");
  EXPECT_EQ(refusal(with(table, "-50.6  1    1       25.4", "-50.6 1 1")),
            "x: line 4: row is 3 columns, wanted 4: radius, thickness, index, aperture");
  EXPECT_NE(refusal(with(table, "5.2", "nan")), "no error");
  EXPECT_NE(refusal(with(table, "5.2", "1e400")), "no error");
  EXPECT_NE(refusal(with(table, "25.4", "-25.4")).find("aperture is -25.4"), std::string::npos);
}

}  // namespace
