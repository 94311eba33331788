// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/prescription.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"

namespace prescription_test {

using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
using petzval::testing::message;
using petzval::testing::Token;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Prescription singlet() {
  Prescription p;
  p.name = "singlet";
  p.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
                {.radius = -50, .thickness = 48, .semi_diameter = 12}};
  return p;
}

/// The message of validate for the singlet after a change.
std::string refusal(const std::function<void(Prescription&)>& change) {
  Prescription p = singlet();
  change(p);
  return message([&] { petzval::validate(p, "s"); });
}

/// Checks that the changed lens is refused by a message with its name and these tokens.
void expect_refused(const std::function<void(Prescription&)>& change, const std::vector<Token>& tokens,
                    int line = __builtin_LINE()) {
  const std::string said = refusal(change);
  expect_tokens(said, {"s"}, __FILE__, line);
  expect_tokens(said, tokens, __FILE__, line);
}

TEST(Validate, AcceptsEveryLensOfTheData) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) EXPECT_NO_THROW(petzval::validate(p, p.id));
}

TEST(Validate, RefusesInvalidNumbersByNameAndSurface) {
  for (const double value : {nan, infinity, -infinity}) {
    expect_refused([&](auto& p) { p.surfaces[1].radius = value; }, {"surface 1", "radius", value});
    expect_refused([&](auto& p) { p.surfaces[0].thickness = value; }, {"surface 0", "thickness", value});
    expect_refused([&](auto& p) { p.surfaces[1].conic = value; }, {"surface 1", "conic", value});
    expect_refused([&](auto& p) { p.surfaces[0].medium.nd = value; }, {"surface 0", "nd", value});
    expect_refused([&](auto& p) { p.surfaces[0].medium.vd = value; }, {"surface 0", "vd", value});
    expect_refused([&](auto& p) { p.surfaces[0].obscuration_semi_diameter = value; },
                   {"surface 0", "inner_semi_diameter", value});
    expect_refused(
        [&](auto& p) {
          p.surfaces[0].aspheric = {{6, 0.0}, {4, value}};
        },
        {"surface 0", "aspheric", 4, value});
    expect_refused([&](auto& p) { p.f_number = value; }, {"f_number", value});
    expect_refused([&](auto& p) { p.focal_length_mm = value; }, {"focal_length_mm", value});
    expect_refused([&](auto& p) { p.reference_wavelength_nm = value; }, {"reference_wavelength_nm", value});
    expect_refused([&](auto& p) { p.object_space.nd = value; }, {"object_space", "nd", value});
  }
  expect_refused([](auto& p) { p.surfaces[0].radius = 5e-324; }, {"surface 0", "radius", "5e-324"});
  expect_refused([](auto& p) { p.surfaces[0].thickness = 1e10; }, {"surface 0", "thickness", "1e+10"});
  for (const char* conic : {"1e+34", "-1e+34", "1e+300"}) {
    expect_refused([&](auto& p) { p.surfaces[1].conic = std::stod(conic); }, {"surface 1", "conic", conic});
  }
  expect_refused([](auto& p) { p.surfaces[0].medium.nd = 0; }, {"surface 0", "nd", 0});
  expect_refused([](auto& p) { p.surfaces[0].medium.nd = -1.5; }, {"surface 0", "nd", -1.5});
  expect_refused([](auto& p) { p.surfaces[0].medium.nd = 5.1; }, {"surface 0", "nd", 5.1});
  expect_refused([](auto& p) { p.surfaces[0].semi_diameter = -1; }, {"surface 0", "semi_diameter", -1});
  expect_refused([](auto& p) { p.surfaces[0].semi_diameter = nan; }, {"surface 0", "semi_diameter", "nan"});
  expect_refused([](auto& p) { p.reference_wavelength_nm = 0.5876; }, {"reference_wavelength_nm", 0.5876});
}

TEST(Medium, WithoutGlassAndIndex_IsAir) {
  using petzval::Medium;
  EXPECT_TRUE(Medium{}.is_air());
  EXPECT_TRUE(Medium{.nd = 1}.is_air());
  EXPECT_FALSE(Medium{.nd = 1.5}.is_air());
  EXPECT_FALSE(Medium{.glass = "N-BK7"}.is_air());
  EXPECT_EQ(Medium{}, Medium{.nd = 1});
  EXPECT_NE(Medium{}, Medium{.nd = 1.5});
  EXPECT_NE(Medium{}, Medium{.glass = "N-BK7"});
  EXPECT_NE(Medium{.glass = "N-BK7"}, (Medium{.glass = "N-BK7", .nd = 1.5168}));
  EXPECT_EQ(Medium{.glass = "N-BK7"}, Medium{.glass = "N-BK7"});
}

TEST(Validate, MediumWithoutAnIndex_IsAirOrAGlass) {
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium = {.glass = "N-BK7"}; }), "no error");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium = {.glass = "N-BK7", .vd = 64.2}; }), "no error");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium = {.nd = 4, .vd = 0}; }), "no error");
  expect_refused([](auto& p) { p.surfaces[0].medium = {.vd = 64.2}; }, {"surface 0", "vd", 64.2});
  expect_refused([](auto& p) { p.surfaces[0].medium.vd = -1; }, {"surface 0", "vd", -1});
}

TEST(Validate, MirrorInAGlassWithoutAnIndex_HasTheSameMedium) {
  const auto behind = [](const petzval::Medium& medium) {
    return refusal([&](auto& p) {
      p.surfaces[0].medium = {.glass = "N-BK7"};
      p.surfaces[1].mirror = true, p.surfaces[1].thickness = -5, p.surfaces[1].medium = medium;
    });
  };
  EXPECT_EQ(behind({.glass = "N-BK7"}), "no error");
  expect_tokens(behind({.glass = "N-SF5"}), {"s", "surface 1", "N-SF5", "N-BK7"});
  EXPECT_NE(behind({}), "no error");
}

TEST(Validate, FieldsThatContradictEachOtherAreRefused) {
  expect_refused([](auto& p) { p.surfaces.clear(); }, {"no surfaces"});
  expect_refused([](auto& p) { p.surfaces.resize(10'001); }, {10001});
  expect_refused([](auto& p) { p.surfaces[0].obscuration_semi_diameter = 12; },
                 {"surface 0", "inner_semi_diameter", 12});
  expect_refused([](auto& p) { p.surfaces[1].mirror = true; }, {"surface 1", "mirror", "nd", 1.5168});
  expect_refused([](auto& p) { p.surfaces[0].aspheric = {{1, 0.5}}; }, {"surface 0", "aspheric", 1});
  expect_refused([](auto& p) { p.surfaces[0].aspheric = {{41, 0.5}}; }, {"surface 0", "aspheric", 41});
  for (const petzval::AsphereTerm term : {petzval::AsphereTerm{2, -1e307}, {2, 6e11}, {3, 1e24}}) {
    expect_refused([&](auto& p) { p.surfaces[0].aspheric = {term}; }, {"surface 0", "aspheric", term.order});
  }
  for (const petzval::AsphereTerm term : {petzval::AsphereTerm{2, -4e11}, {3, 1e23}, {40, 1e300}}) {
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].aspheric = {term}; }), "no error") << term.order;
  }
  expect_refused([](auto& p) { p.surfaces[0].aspheric = {{4, 0.5}, {4, 0.5}}; }, {"surface 0", "aspheric", 4});
  expect_refused([](auto& p) { p.configurations = {{.name = "wide", .changes = {{.surface = 2, .thickness = 5}}}}; },
                 {"configuration 0", "changed", 2});
  expect_refused([](auto& p) { p.configurations = {{.name = "wide", .changes = {{.surface = 1, .thickness = nan}}}}; },
                 {"configuration 0", "surface 1", "thickness", "nan"});
  expect_refused([](auto& p) { p.configurations = {{}}; }, {"configuration", 0});
  expect_refused(
      [](auto& p) {
        p.configurations = {{.name = "a"}, {.name = "a"}};
      },
      {"configuration 1", "name", "\"a\""});
  expect_refused(
      [](auto& p) {
        p.configurations = {{.name = "a"}, {.name = "b", .focus_of = "c"}};
      },
      {"configuration 1", "\"c\""});
  expect_refused(
      [](auto& p) {
        p.configurations = {{.name = "a", .changes = {{.surface = 1}, {.surface = 1}}}};
      },
      {"configuration 0", "surface", 1});
  expect_refused([](auto& p) { p.design.wavelengths = {{.nm = 0.5876}}; }, {"design", "wavelength 0", 0.5876});
}

TEST(Validate, RefusesInvalidDesignsAndPositions) {
  using petzval::ApertureSetting;
  for (const double value : {nan, infinity, -1.0}) {
    expect_refused(
        [&](auto& p) {
          p.design.aperture = {ApertureSetting::f_number, value};
        },
        {"design", "aperture", value});
  }
  expect_refused([](auto& p) { p.design.object_distance_mm = nan; }, {"design", "object", "nan"});
  expect_refused([](auto& p) { p.design.fields = {{}, {.y = infinity}}; }, {"design", "field 1", "value", "inf"});
  expect_refused([](auto& p) { p.design.wavelengths = {{500, nan}}; }, {"design", "wavelength 0", "weight", "nan"});
  expect_refused(
      [](auto& p) {
        p.design.wavelengths = {{500, 1}};
        p.design.primary_wavelength = 1;
      },
      {"design", "primary", 1});
  for (const double distance : {nan, 0.0, -5.0}) {
    expect_refused([&](auto& p) { p.configurations = {{.name = "a", .subject_distance_mm = distance}}; },
                   {"configuration 0", "subject_distance_mm", distance});
  }
  expect_refused([](auto& p) { p.configurations = {{.name = "a", .stop = 2}}; }, {"configuration 0", "stop", 2});
  expect_refused([](auto& p) { p.configurations = {{.name = "a", .changes = {{.surface = -1}}}}; },
                 {"configuration 0", "changed", -1});
  expect_refused([](auto& p) { p.configurations = {{.name = "a", .focus_of = "a"}}; }, {"configuration", 0});
  expect_refused([](auto& p) { p.configurations.resize(1001); }, {1001, "configurations"});
}

TEST(Validate, StrangeButLegalLensesPass) {
  const std::vector<std::function<void(Prescription&)>> changes = {
      [](auto& p) { p.surfaces[0].thickness = 0; },
      [](auto& p) { p.surfaces[0].thickness = -3; },
      [](auto& p) { p.surfaces[0].radius = 0; },
      [](auto& p) { p.surfaces[0].radius = -0.0; },
      [](auto& p) { p.surfaces[0].radius = 1e300; },
      [](auto& p) { p.surfaces[0].semi_diameter = 0; },
      [](auto& p) { p.surfaces[0].semi_diameter = infinity; },
      [](auto& p) { p.surfaces[0].semi_diameter.reset(); },
      [](auto& p) { p.surfaces[0].medium.nd = 0.8; },
      [](auto& p) { p.surfaces[0].stop = false; },
      [](auto& p) { p.surfaces[1].stop = true; },
      [](auto& p) { p.surfaces.pop_back(); },
      [](auto& p) { p.surfaces[0].curved_in = petzval::Section::x; },
      [](auto& p) { p.object_space.nd = 1.333; },
      [](auto& p) {
        p.surfaces = {{.radius = -100, .thickness = -50, .mirror = true, .curved_in = petzval::Section::y}};
      },
      [](auto& p) {
        p.surfaces[0].aspheric = {{2, 1e-3}, {3, 1e-4}, {40, 1e-50}};
      }};
  for (std::size_t i = 0; i < changes.size(); ++i) EXPECT_EQ(refusal(changes[i]), "no error") << "change " << i;
}

TEST(Scale, PowersOfTwoRoundTripToTheBit) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    for (const double factor : {2.0, 0x1p-10, 0x1p20}) {
      const Prescription scaled = petzval::scale(p, factor);
      EXPECT_EQ(petzval::scale(scaled, 1 / factor), p) << p.id << " times " << factor;
      EXPECT_EQ(scaled.surfaces.front().thickness, p.surfaces.front().thickness * factor);
    }
  }
}

// Similar surfaces have similar sags: scaling r and z by one factor keeps z = k r^m on the surface.
TEST(Scale, AspheresStaySimilar) {
  Prescription p = singlet();
  p.surfaces[0].aspheric = {{3, 2e-4}, {10, -3e-12}};
  const Prescription scaled = petzval::scale(p, 3);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [order, before] = p.surfaces[0].aspheric[i];
    const double after = scaled.surfaces[0].aspheric[i].coefficient, r = 7;
    EXPECT_NEAR(after * std::pow(3 * r, order), 3 * before * std::pow(r, order),
                1e-14 * std::abs(before) * std::pow(r, order));
  }
}

TEST(Scale, ScalesLengthsAndKeepsRatios) {
  const Prescription p = petzval::testing::data_prescription("zoom_14-30mm_f4:middle");
  const Prescription whole = petzval::testing::data_prescription("zoom_14-30mm_f4");
  const Prescription scaled = petzval::scale(p, 2);
  EXPECT_EQ(scaled.focal_length_mm, 40.0);
  EXPECT_EQ(scaled.image_diagonal_mm, 2 * 43.4);
  EXPECT_EQ(scaled.f_number, p.f_number);
  EXPECT_EQ(scaled.half_field_deg, p.half_field_deg);
  EXPECT_EQ(configured(petzval::scale(whole, 2), "middle"), scaled);
  EXPECT_EQ(scaled.surfaces[1].conic, -1);
  EXPECT_EQ(scaled.surfaces[0].semi_diameter, 2 * 29.285);
}

TEST(Scale, ScalesLengthsOfTheDesign) {
  using enum petzval::ApertureSetting;
  Prescription p = singlet();
  p.design.object_distance_mm = 300;
  p.design.fields = {{.x = 1, .y = 2}};
  for (const auto& [setting, scaled] : {std::pair(entrance_pupil_diameter, 12.0), std::pair(f_number, 4.0),
                                        std::pair(working_f_number, 4.0), std::pair(object_na, 4.0)}) {
    p.design.aperture = {setting, 4};
    EXPECT_EQ(petzval::scale(p, 3).design.aperture->value, scaled);
  }
  EXPECT_EQ(petzval::scale(p, 3).design.object_distance_mm, 900);
  EXPECT_EQ(petzval::scale(p, 3).design.fields[0].y, 2);  // degrees
  p.design.field_kind = petzval::FieldKind::object_height;
  EXPECT_EQ(petzval::scale(p, 3).design.fields[0].x, 3);
  EXPECT_EQ(petzval::scale(p, 3).design.fields[0].y, 6);
}

TEST(Scale, RefusesInvalidFactors) {
  for (const double factor : {0.0, -1.0, nan, infinity}) {
    expect_error([&] { petzval::scale(singlet(), factor); }, {"singlet", "scale", factor});
  }
  expect_error([] { petzval::scale(singlet(), 0x1p-1060); },
               {"singlet", "surface 0", 50, "8.095e-320", "4.047386e-318"});
  expect_error([] { petzval::scale(singlet(), 1e307); }, {"singlet", "surface 0", 50, "1e+307", "inf"});
}

}  // namespace prescription_test
