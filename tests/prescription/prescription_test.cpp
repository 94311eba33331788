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
#include "../message.hpp"
#include "core/text.hpp"

namespace {

using petzval::Prescription;
using petzval::testing::message;

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

TEST(Validate, AcceptsEveryLensOfTheData) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) EXPECT_NO_THROW(petzval::validate(p, p.id));
}

TEST(Validate, NumbersThatNoSurfaceHasAreRefusedByNameAndSurface) {
  const std::string finite_radius = ", wanted a finite length of at least 1e-12 mm, or 0 for a plane";
  const std::string finite_thickness = ", wanted a finite length below 1e10 mm";
  for (const double value : {nan, infinity, -infinity}) {
    const std::string is = " is " + petzval::to_text(value);
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[1].radius = value; }), "s: surface 1: radius" + is + finite_radius);
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].thickness = value; }),
              "s: surface 0: thickness" + is + finite_thickness);
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[1].conic = value; }),
              "s: surface 1: conic" + is + ", wanted a finite number");
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].medium.nd = value; }),
              "s: surface 0: nd" + is + ", wanted an index of 0.1 to 5");
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].medium.vd = value; }).find("s: surface 0: vd = "), 0u);
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].obscuration_semi_diameter = value; }),
              "s: surface 0: inner_semi_diameter" + is + ", wanted a finite length of 0 mm or more");
    EXPECT_EQ(refusal([&](auto& p) {
                p.surfaces[0].aspheric = {{6, 0.0}, {4, value}};
              }),
              "s: surface 0: aspheric coefficient of order 4" + is + ", wanted a finite number");
    EXPECT_EQ(refusal([&](auto& p) { p.f_number = value; }),
              "s: f_number" + is + ", wanted a finite number above 0 or no value");
    EXPECT_EQ(refusal([&](auto& p) { p.focal_length_mm = value; }),
              "s: focal_length_mm" + is + ", wanted a finite number or no value");
    EXPECT_EQ(refusal([&](auto& p) { p.reference_wavelength_nm = value; }),
              "s: reference_wavelength_nm" + is + ", wanted 10 to 100000 nm");
    EXPECT_EQ(refusal([&](auto& p) { p.object_space.nd = value; }),
              "s: object_space: nd" + is + ", wanted an index of 0.1 to 5");
  }
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].radius = 5e-324; }), "s: surface 0: radius is 5e-324" + finite_radius);
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].thickness = 1e10; }),
            "s: surface 0: thickness is 1e+10" + finite_thickness);
  for (const char* conic : {"1e+34", "-1e+34", "1e+300"}) {
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[1].conic = std::stod(conic); }),
              "s: surface 1: conic is " + std::string(conic) +
                  ", wanted one with a radius / sqrt|1 + conic| of at least 1e-15 mm");
  }
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium.nd = 0; }),
            "s: surface 0: nd is 0, wanted an index of 0.1 to 5");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium.nd = -1.5; }),
            "s: surface 0: nd is -1.5, wanted an index of 0.1 to 5");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium.nd = 5.1; }),
            "s: surface 0: nd is 5.1, wanted an index of 0.1 to 5");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].semi_diameter = -1; }),
            "s: surface 0: semi_diameter is -1, wanted 0 mm or more");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].semi_diameter = nan; }),
            "s: surface 0: semi_diameter is nan, wanted 0 mm or more");
  EXPECT_EQ(refusal([](auto& p) { p.reference_wavelength_nm = 0.5876; }),
            "s: reference_wavelength_nm is 0.5876, wanted 10 to 100000 nm");
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
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium = {.vd = 64.2}; }).find("s: surface 0: vd = 64.2"), 0u);
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].medium.vd = -1; }).find("s: surface 0: vd = -1"), 0u);
}

TEST(Validate, MirrorInAGlassWithoutAnIndex_HasTheSameMedium) {
  const auto behind = [](const petzval::Medium& medium) {
    return refusal([&](auto& p) {
      p.surfaces[0].medium = {.glass = "N-BK7"};
      p.surfaces[1].mirror = true, p.surfaces[1].thickness = -5, p.surfaces[1].medium = medium;
    });
  };
  EXPECT_EQ(behind({.glass = "N-BK7"}), "no error");
  const std::string other = behind({.glass = "N-SF5"});
  EXPECT_EQ(other.find("s: surface 1: "), 0u) << other;
  EXPECT_NE(other.find("N-SF5"), std::string::npos) << other;
  EXPECT_NE(other.find("N-BK7"), std::string::npos) << other;
  EXPECT_NE(behind({}), "no error");
}

TEST(Validate, FieldsThatContradictEachOtherAreRefused) {
  EXPECT_EQ(refusal([](auto& p) { p.surfaces.clear(); }), "s: no surfaces, wanted at least one");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces.resize(10'001); }), "s: 10001 surfaces, wanted at most 10000");
  EXPECT_EQ(refusal([](auto& p) { p.surfaces[0].obscuration_semi_diameter = 12; }),
            "s: surface 0: inner_semi_diameter is 12, wanted less than the semi_diameter of 12 mm");
  const std::string in_air = refusal([](auto& p) { p.surfaces[1].mirror = true; });
  EXPECT_EQ(in_air.find("s: surface 1: medium of the mirror"), 0u) << in_air;
  EXPECT_NE(in_air.find("nd 1.5168"), std::string::npos) << in_air;
  EXPECT_EQ(refusal([](auto& p) {
              p.surfaces[0].aspheric = {{1, 0.5}};
            }),
            "s: surface 0: aspheric order is 1, wanted 2 to 40");
  EXPECT_EQ(refusal([](auto& p) {
              p.surfaces[0].aspheric = {{41, 0.5}};
            }),
            "s: surface 0: aspheric order is 41, wanted 2 to 40");
  for (const petzval::AsphereTerm term : {petzval::AsphereTerm{2, -1e307}, {2, 6e11}, {3, 1e24}}) {
    EXPECT_NE(refusal([&](auto& p) { p.surfaces[0].aspheric = {term}; }).find(", wanted one whose slope is below 1 up"),
              std::string::npos)
        << term.order;
  }
  for (const petzval::AsphereTerm term : {petzval::AsphereTerm{2, -4e11}, {3, 1e23}, {40, 1e300}}) {
    EXPECT_EQ(refusal([&](auto& p) { p.surfaces[0].aspheric = {term}; }), "no error") << term.order;
  }
  EXPECT_EQ(refusal([](auto& p) {
              p.surfaces[0].aspheric = {{4, 0.5}, {4, 0.5}};
            }),
            "s: surface 0: aspheric coefficient of order 4 is given twice, wanted once");
  EXPECT_EQ(
      refusal([](auto& p) { p.configurations = {{.name = "wide", .changes = {{.surface = 2, .thickness = 5}}}}; }),
      "s: configuration 0: changed surface is 2, wanted one of 2");
  EXPECT_EQ(
      refusal([](auto& p) { p.configurations = {{.name = "wide", .changes = {{.surface = 1, .thickness = nan}}}}; }),
      "s: configuration 0: surface 1: thickness is nan, wanted a finite length below 1e10 mm");
  EXPECT_EQ(refusal([](auto& p) { p.configurations = {{}}; }), "s: configuration 0 has no name, wanted one");
  EXPECT_EQ(refusal([](auto& p) {
              p.configurations = {{.name = "a"}, {.name = "a"}};
            }),
            "s: configuration 1: name \"a\" is given twice, wanted once");
  EXPECT_EQ(refusal([](auto& p) {
              p.configurations = {{.name = "a"}, {.name = "b", .focus_of = "c"}};
            }),
            "s: configuration 1 focuses \"c\", wanted the name of a zoom position");
  EXPECT_EQ(refusal([](auto& p) {
              p.configurations = {{.name = "a", .changes = {{.surface = 1}, {.surface = 1}}}};
            }),
            "s: configuration 0: surface 1 is changed twice, wanted once");
  EXPECT_EQ(refusal([](auto& p) { p.design.wavelengths = {{.nm = 0.5876}}; }),
            "s: design: wavelength 0: it is 0.5876, wanted 10 to 100000 nm");
}

TEST(Validate, DesignsAndPositionsThatNoLensHasAreRefused) {
  using petzval::ApertureSetting;
  const std::string aperture = ", wanted a finite number of 0 or more";
  for (const double value : {nan, infinity, -1.0}) {
    EXPECT_EQ(refusal([&](auto& p) {
                p.design.aperture = {ApertureSetting::f_number, value};
              }),
              "s: design: aperture is " + petzval::to_text(value) + aperture);
  }
  EXPECT_EQ(refusal([](auto& p) { p.design.object_distance_mm = nan; }),
            "s: design: object distance is nan, wanted a length");
  EXPECT_EQ(refusal([](auto& p) {
              p.design.fields = {{}, {.y = infinity}};
            }),
            "s: design: field 1: a value is inf, wanted a finite number");
  EXPECT_EQ(refusal([](auto& p) {
              p.design.wavelengths = {{500, nan}};
            }),
            "s: design: wavelength 0: weight is nan, wanted a finite number");
  EXPECT_EQ(refusal([](auto& p) {
              p.design.wavelengths = {{500, 1}};
              p.design.primary_wavelength = 1;
            }),
            "s: design: primary wavelength is 1, wanted one of 1");
  for (const double distance : {nan, 0.0, -5.0}) {
    EXPECT_EQ(refusal([&](auto& p) { p.configurations = {{.name = "a", .subject_distance_mm = distance}}; }),
              "s: configuration 0: subject_distance_mm is " + petzval::to_text(distance) +
                  ", wanted a length above 0, or inf");
  }
  EXPECT_EQ(refusal([](auto& p) { p.configurations = {{.name = "a", .stop = 2}}; }),
            "s: configuration 0: stop is 2, wanted one of 2");
  EXPECT_EQ(refusal([](auto& p) { p.configurations = {{.name = "a", .changes = {{.surface = -1}}}}; }),
            "s: configuration 0: changed surface is -1, wanted one of 2");
  EXPECT_EQ(refusal([](auto& p) { p.configurations = {{.name = "a", .focus_of = "a"}}; }),
            "s: configuration 0 focuses another, wanted a zoom position first");
  EXPECT_EQ(refusal([](auto& p) { p.configurations.resize(1001); }), "s: 1001 configurations, wanted at most 1000");
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

TEST(Scale, PowersOfTwoComeBackBitForBit) {
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

TEST(Scale, LengthsFollowAndRatiosStay) {
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

TEST(Scale, TheDesignsLengthsFollow) {
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

TEST(Scale, RefusesFactorsThatMakeNoLens) {
  for (const double factor : {0.0, -1.0, nan, infinity}) {
    EXPECT_EQ(message([&] { petzval::scale(singlet(), factor); }),
              "singlet: scale factor is " + petzval::to_text(factor) + ", wanted a finite number above 0");
  }
  EXPECT_EQ(
      message([] { petzval::scale(singlet(), 0x1p-1060); }),
      "singlet: surface 0: 50 scaled by 8.095e-320 is 4.047386e-318, wanted a number in the normal range of double");
  EXPECT_EQ(message([] { petzval::scale(singlet(), 1e307); }),
            "singlet: surface 0: 50 scaled by 1e+307 is inf, wanted a number in the normal range of double");
}

}  // namespace
