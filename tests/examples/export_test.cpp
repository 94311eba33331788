// SPDX-License-Identifier: Apache-2.0
// The files of `petzval export`, read back.
#include <gtest/gtest.h>

#include <cmath>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

class Export : public Programs {};

TEST_F(Export, TablesOfOmniverseAreFiles) {
  const std::string stem = path("out/fisheye_6.3mm_f2.8");
  const Outcome outcome =
      run("export", {lens("fisheye_6.3mm_f2.8"), "--focus", "inf", "--size", "96", "--calibration", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("omniverse_lut"), std::string::npos) << outcome.out;
  EXPECT_NE(read(stem + ".usda.txt").find("@./fisheye_6.3mm_f2.8.omniverse.exit.exr@"), std::string::npos);
  const petzval::RgbImage enter = petzval::read_exr(stem + ".omniverse.enter.exr"),
                          exit = petzval::read_exr(stem + ".omniverse.exit.exr");
  ASSERT_EQ(enter.width, 96);
  ASSERT_EQ(enter.height, 64);
  const float* const up = enter.pixel(48, 20);
  EXPECT_GT(up[1], 0.1f);
  EXPECT_LT(up[2], 0.0f);
  EXPECT_NEAR(std::hypot(up[0], up[1], up[2]), 1, 1e-6);
  const float* const centre = exit.pixel(exit.width / 2, exit.height / 2);
  EXPECT_NEAR(centre[0], 0.5, 1e-6);
  EXPECT_NEAR(centre[1], 0.5, 1e-6);
  EXPECT_LT(exit.pixel(exit.width / 2, exit.height * 3 / 4)[1], 0.5f);  // towards +y: the upper half of the picture
}

}  // namespace
