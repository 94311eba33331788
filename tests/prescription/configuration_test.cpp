// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../data_lenses.hpp"
#include "../message.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace {

using petzval::Configuration;
using petzval::configured;
using petzval::Prescription;
using petzval::testing::data_prescription;
using petzval::testing::message;

/// Two zoom positions, each with one that focuses it at 500 mm.
Prescription zoom() {
  Prescription p;
  p.name = "z";
  p.f_number = 4;
  p.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                {.radius = -50, .thickness = 20},
                {.radius = 0, .thickness = 30}};
  p.configurations = {
      {.name = "wide",
       .focal_length_mm = 50,
       .changes = {{.surface = 1, .thickness = 20}, {.surface = 2, .radius = 80}}},
      {.name = "tele",
       .stop = 1,
       .focal_length_mm = 60,
       .f_number = 5,
       .changes = {{.surface = 1, .thickness = 30, .semi_diameter = 8}, {.surface = 2, .radius = 100}}},
      {.name = "wide, near",
       .focus_of = "wide",
       .subject_distance_mm = 500,
       .changes = {{.surface = 1, .thickness = 22}, {.surface = 2, .thickness = 28, .radius = 80}}},
      {.name = "tele, near",
       .focus_of = "tele",
       .subject_distance_mm = 500,
       .stop = 1,
       .changes = {{.surface = 1, .thickness = 34, .semi_diameter = 8}, {.surface = 2, .radius = 100}}}};
  return p;
}

TEST(Configured, AppliesOneByNameOrNumber) {
  const Prescription tele = configured(zoom(), "tele");
  EXPECT_EQ(tele.name, "z, tele");
  EXPECT_EQ(tele.surfaces[1].thickness, 30);
  EXPECT_EQ(tele.surfaces[1].semi_diameter, 8);
  EXPECT_EQ(tele.surfaces[2].radius, 100);
  EXPECT_FALSE(tele.surfaces[0].stop);
  EXPECT_TRUE(tele.surfaces[1].stop);
  EXPECT_EQ(tele.focal_length_mm, 60);
  EXPECT_EQ(tele.f_number, 5);
  EXPECT_EQ(configured(zoom(), 1), tele);
  EXPECT_EQ(configured(zoom(), 0).surfaces[1].thickness, 20);
  EXPECT_EQ(configured(zoom(), 0).f_number, 4);
  EXPECT_EQ(message([] { configured(zoom(), "far"); }),
            "z: configuration \"far\" does not exist, wanted 0 to 3 or one of wide, tele, wide, near, tele, near");
  EXPECT_EQ(message([] { configured(zoom(), 4); }).find("z: configuration 4 does not exist"), 0u);
  EXPECT_EQ(message([] { configured(zoom(), -0.5); }).find("z: configuration -0.5 does not exist"), 0u);
}

TEST(Configured, TwiceIsOnce) {
  for (const char* name : {"wide", "tele", "wide, near"}) {
    const Prescription once = configured(zoom(), name);
    EXPECT_EQ(configured(once, 0), once) << name;
  }
  const Prescription prime = petzval::testing::data_prescription("double_gauss_100mm_f2.0");
  EXPECT_EQ(configured(prime, 0), prime);
}

TEST(Configured, ThicknessesAreLinearBetweenZoomPositions) {
  Prescription p = zoom();
  p.configurations[1].stop.reset();
  p.configurations[3].stop.reset();
  const Prescription between = configured(p, 0.25);
  EXPECT_EQ(between.surfaces[1].thickness, 22.5);
  EXPECT_EQ(between.surfaces[2].radius, 85);
  EXPECT_FALSE(between.focal_length_mm);
  ASSERT_EQ(between.configurations.size(), 2u);
  EXPECT_EQ(configured(between, 1).surfaces[1].thickness, 25);  // 22 and 34
  EXPECT_NE(message([] { configured(zoom(), 0.25); }).find("the stop changes"), std::string::npos);
  EXPECT_NE(message([&] { configured(p, 1.5); }).find("focuses another"), std::string::npos);
}

TEST(Configured, CompilesTheChosenOne) {
  const Prescription p = data_prescription("zoom_70-210mm_f4");
  const auto focal_length = [&](const petzval::ConfigurationChoice& choice) {
    return petzval::first_order(compile(p, {.configuration = choice})).effective_focal_length;
  };
  EXPECT_NEAR(focal_length("wide"), 70.552, 1e-3);
  EXPECT_NEAR(focal_length("middle"), 137.028, 1e-3);
  EXPECT_NEAR(focal_length(2), 205.265, 1e-3);
  EXPECT_EQ(focal_length("wide"), petzval::first_order(petzval::compile(p)).effective_focal_length);
  double last = 0;
  for (double at = 0; at <= 2; at += 0.125) {
    EXPECT_GT(focal_length(at), last) << at;
    last = focal_length(at);
  }
}

TEST(Configured, ScalesAndReverses) {
  const Prescription scaled = petzval::scale(zoom(), 2);
  EXPECT_EQ(configured(scaled, "tele").surfaces[1].thickness, 60);
  EXPECT_EQ(scaled.configurations[2].subject_distance_mm, 1000);
  const Prescription reversed = petzval::reverse(zoom());
  EXPECT_EQ(reversed.configurations.size(), 2u);
  EXPECT_EQ(configured(reversed, "tele").surfaces[0].thickness, 30);
  EXPECT_EQ(configured(reversed, "tele").surfaces[0].radius, -100);
  EXPECT_TRUE(configured(reversed, "tele").surfaces[1].stop);
}

}  // namespace
