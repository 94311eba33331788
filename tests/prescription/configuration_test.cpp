// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace configuration_test {

using petzval::Configuration;
using petzval::configured;
using petzval::Prescription;
using petzval::testing::data_prescription;
using petzval::testing::expect_error;
using petzval::testing::message;

/// Two zoom positions, each with a second configuration that is focused at 500 mm.
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

TEST(Configured, AppliesAConfigurationByNameOrNumber) {
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
  expect_error([] { configured(zoom(), "far"); }, {"z", "configuration", "\"far\""});
  expect_error([] { configured(zoom(), 4); }, {"z", "configuration 4"});
  expect_error([] { configured(zoom(), -0.5); }, {"z", "configuration", -0.5});
}

TEST(Configured, IsIdempotent) {
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
  expect_error([] { configured(zoom(), 0.25); }, {"z", 0.25, "stop"});
  expect_error([&] { configured(p, 1.5); }, {"configuration", 1.5});
}

TEST(Configured, CompilesTheChosenConfiguration) {
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

/// Validates the rows of each configuration as a separate lens; returns the first refusal.
std::string refusal_of_rows(const Prescription& p) {
  for (std::size_t i = 0; i < p.configurations.size(); ++i) {
    const std::string refusal = message([&] {
      Prescription alone = configured(p, i);
      alone.configurations.clear();
      validate(alone, "z: configuration " + std::to_string(i));
    });
    if (refusal != "no error") return refusal;
  }
  return "no error";
}

TEST(Validate, RefusesInvalidConfigurations) {
  using Fault = std::function<void(Prescription&, petzval::SurfaceChange&)>;
  const std::vector<Fault> faults = {
      [](auto&, auto&) {},
      [](auto&, auto& change) { change.thickness = HUGE_VAL; },
      [](auto&, auto& change) { change.radius = 1e-13; },
      [](auto&, auto& change) { change.conic = NAN; },
      [](auto&, auto& change) { change.semi_diameter = 1; },  // inside the obscuration
      [](auto&, auto& change) { change.medium = petzval::Medium{.nd = 6}; },
      [](auto&, auto& change) { change.medium = petzval::Medium{.nd = 1.7}; },  // differs from the next mirror
      [](auto& p, auto&) { p.configurations[1].f_number = 0; },
      [](auto& p, auto&) { p.configurations[2].half_field_deg = NAN; }};
  std::mt19937 random(7);
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Prescription p = zoom();
    for (int i = 0; i < 3; ++i) p.surfaces.push_back({.radius = 100.0 + i, .thickness = 5, .semi_diameter = 20});
    p.surfaces[1].obscuration_semi_diameter = 2;
    p.surfaces[3].obscuration_semi_diameter = 3;
    p.surfaces[4].mirror = true;
    ASSERT_EQ(message([&] { validate(p, "z"); }), "no error");
    Configuration& c = p.configurations[random() % p.configurations.size()];
    auto& change = c.changes[random() % c.changes.size()];
    if (random() % 2 == 0) change = {.surface = static_cast<int>(3 + random() % 3)};
    faults[random() % faults.size()](p, change);
    const std::string refusal = message([&] { validate(p, "z"); });
    EXPECT_EQ(refusal, refusal_of_rows(p)) << "trial " << trial;
    refused += static_cast<int>(refusal != "no error");
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 390);
}

// Copying all positions for each position would give 5e8 changes.
TEST(Configured, AcceptsTheMaximumOfPositions) {
  constexpr int positions = 1000, surfaces = 500;
  Prescription p;
  for (int i = 0; i < surfaces; ++i) p.surfaces.push_back({.radius = 1e4 + i, .thickness = 1, .semi_diameter = 10});
  p.surfaces[0].stop = true;
  for (int c = 0; c < positions; ++c) {
    Configuration& configuration = p.configurations.emplace_back();
    configuration.name = "position " + std::to_string(c);
    for (int i = 0; i < surfaces; ++i) configuration.changes.push_back({.surface = i, .thickness = 1 + 1e-3 * c});
  }
  validate(p, "zoom");
  for (int c = 0; c < positions; ++c) {
    const Prescription rows = configured(p, c);
    ASSERT_EQ(rows.configurations.size(), 1u);
    ASSERT_EQ(rows.surfaces.back().thickness, 1 + 1e-3 * c);
  }
  // All configurations focus the first position.
  for (int c = 1; c < positions; ++c) {
    p.configurations[static_cast<std::size_t>(c)].focus_of = p.configurations[0].name;
    p.configurations[static_cast<std::size_t>(c)].subject_distance_mm = 100 + c;
  }
  EXPECT_EQ(petzval::compile(p).focus_positions().size(), static_cast<std::size_t>(positions));
}

}  // namespace configuration_test
