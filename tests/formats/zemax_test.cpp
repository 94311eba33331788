// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "../digits.hpp"
#include "../expect_error.hpp"
#include "lens_text.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace zemax_test {

using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

/// A singlet of model glass: a front stop, a biconvex lens, the image.
const std::string singlet = R"(VERS 140730 0 0
MODE SEQ
NAME A singlet
NOTE 0 first pa
NOTE 0 rt
NOTE 4
NOTE 0 second
UNIT MM X W X CM MR CPMM
ENPD 10
ENVD 20 1 0
GCAT SCHOTT
RAIM 0 0 1 1 0 0 0 0 0 1
FTYP 0 0 2 2 0 0 0
XFLN 0 1 0 0 0 0 0 0 0 0 0 0
YFLN 0 5 0 0 0 0 0 0 0 0 0 0
FWGN 1 2 1 1 1 1 1 1 1 1 1 1
VDXN 0 0.1 0
VDYN 0 0.2 0
VCXN 0 0.3 0
VCYN 0 0.4 0
VANN 0 15 0
WAVM 1 0.4861327 1
WAVM 2 0.5875618 3
WAVM 3 0.55 1
PWAV 2
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  COMM the stop
  CURV 0.0 0 0 0 0 ""
  DISZ 2
SURF 2
  TYPE STANDARD
  CURV 0.02 0 0 0 0 ""
  DISZ 4
  GLAS ___BLANK 1 0 1.5 60 0 0 0 0 0 0
  DIAM 8 1 0 0 1 ""
SURF 3
  TYPE STANDARD
  CURV -0.02 0 0 0 0 ""
  DISZ 48
  DIAM 7 0 0 0 1 ""
SURF 4
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0
)";

/// One more line in the block of surface 2.
std::string with_line(const std::string& line) { return with(singlet, "  DISZ 4\n", "  DISZ 4\n  " + line + "\n"); }

TEST(Zemax, HasTheValuesOfTheFile) {
  const Prescription p = read(singlet);
  EXPECT_EQ(p.imported->format, "zemax");
  EXPECT_EQ(p.imported->title, "A singlet");
  EXPECT_EQ(p.imported->notes, (std::vector<std::string>{"first part", "second"}));
  EXPECT_TRUE(p.imported->warnings.empty());
  EXPECT_EQ(p.name, "A singlet");
  ASSERT_EQ(p.surfaces.size(), 3u);
  EXPECT_TRUE(p.surfaces[0].stop);
  EXPECT_EQ(p.surfaces[0].comment, "the stop");
  EXPECT_EQ(p.surfaces[1].radius, 50);
  EXPECT_EQ(p.surfaces[1].thickness, 4);
  EXPECT_EQ(p.surfaces[1].medium, (petzval::Medium{.nd = 1.5, .vd = 60}));
  EXPECT_EQ(p.surfaces[1].semi_diameter, 8);
  EXPECT_EQ(p.surfaces[2].semi_diameter, 7);
  EXPECT_NEAR(*p.surfaces[0].semi_diameter, 5, 1e-12);  // the entrance pupil itself
  EXPECT_EQ(p.design.aperture, (petzval::DesignAperture{petzval::ApertureSetting::entrance_pupil_diameter, 10}));
  ASSERT_EQ(p.design.fields.size(), 2u);
  EXPECT_EQ(p.design.fields[1], (petzval::DesignField{1, 5, 2, 0.1, 0.2, 0.3, 0.4, 15}));
  ASSERT_EQ(p.design.wavelengths.size(), 2u);
  EXPECT_EQ(p.design.wavelengths[1], (petzval::DesignWavelength{587.5618, 3}));
  EXPECT_EQ(p.design.primary_wavelength, 1u);
  EXPECT_NEAR(*p.half_field_deg, std::hypot(1, 5), 1e-12);
}

TEST(Zemax, UnitsScaleEveryLength) {
  const Prescription mm =
      read(with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE EVENASPH\n  PARM 2 1e-5\n  CURV 0.02"));
  for (const auto& [unit, factor] : {std::pair("CM", 10.0), std::pair("IN", 25.4), std::pair("METER", 1000.0)}) {
    std::string text = with(singlet, "UNIT MM", std::string("UNIT ") + unit);
    text = with(text, "TYPE STANDARD\n  CURV 0.02", "TYPE EVENASPH\n  PARM 2 1e-5\n  CURV 0.02");
    const Prescription p = read(text);
    EXPECT_NEAR(p.surfaces[1].radius, factor * mm.surfaces[1].radius, 1e-9 * factor) << unit;
    EXPECT_NEAR(p.surfaces[1].thickness, factor * 4, 1e-9 * factor);
    EXPECT_NEAR(*p.surfaces[1].semi_diameter, factor * 8, 1e-9 * factor);
    EXPECT_NEAR(p.design.aperture->value, factor * 10, 1e-9 * factor);
    EXPECT_NEAR(p.surfaces[1].aspheric[0].coefficient, 1e-5 / std::pow(factor, 3), 1e-18);
    EXPECT_NEAR(*p.surfaces[0].semi_diameter, factor * 5, 1e-9 * factor);
  }
  expect_tokens(refusal(with(singlet, "UNIT MM", "UNIT FURLONG")), {"x", "line 8", "UNIT", "\"FURLONG\""});
}

TEST(Zemax, IgnoresEncodingsAndLineEnds) {
  const Prescription p = read(singlet);
  const auto utf16 = [](const std::string& text, bool big, bool mark) {
    std::string bytes = mark ? (big ? "\xFE\xFF" : "\xFF\xFE") : "";
    for (const char c : text) bytes += big ? std::string{'\0', c} : std::string{c, '\0'};
    return bytes;
  };
  std::string crlf, cr;
  for (const char c : singlet) {
    if (c == '\n') crlf += '\r', cr += '\r';
    if (c != '\n') cr += c;
    crlf += c;
  }
  for (const std::string& text : {utf16(singlet, false, true), utf16(singlet, true, true), utf16(singlet, false, false),
                                  utf16(singlet, true, false), "\xEF\xBB\xBF" + singlet, crlf, cr}) {
    EXPECT_EQ(read(text).surfaces, p.surfaces);
    EXPECT_EQ(read(text).imported->title, "A singlet");
  }
  const Prescription latin = read(with(singlet, "A singlet", "f\xFCnf M\xB5"));
  EXPECT_EQ(latin.imported->title, "f\xC3\xBCnf M\xC2\xB5");
}

TEST(Zemax, AspheresAreTheirTerms) {
  const auto terms = [](const std::string& type, const std::string& lines) {
    return read(with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE " + type + "\n" + lines + "  CONI -0.5\n  CURV 0.02"))
        .surfaces[1];
  };
  const auto even =
      terms("EVENASPH", "  PARM 1 1e-4\n  PARM 2 2e-5\n  PARM 8 3e-15\n  PARM 9 4e-18\n  PARM 10 5e-20\n");
  EXPECT_EQ(even.conic, -0.5);
  EXPECT_EQ(even.aspheric,
            (std::vector<petzval::AsphereTerm>{{2, 1e-4}, {4, 2e-5}, {16, 3e-15}, {18, 4e-18}, {20, 5e-20}}));
  for (const char* type : {"EVENASPH", "ODDASPHE"}) {
    const std::string refused = refusal(
        with(singlet, "TYPE STANDARD\n  CURV 0.02", std::string("TYPE ") + type + "\n  PARM 11 1e-30\n  CURV 0.02"));
    expect_tokens(refused, {"PARM", 11, "1e-30"});
  }
  EXPECT_EQ(terms("ODDASPHE", "  PARM 3 2e-5\n  PARM 4 1e-6\n").aspheric,
            (std::vector<petzval::AsphereTerm>{{3, 2e-5}, {4, 1e-6}}));
  // Terms in r / 2: XDAT 2 is the normalisation radius.
  const auto extended = terms("XASPHERE", "  XDAT 1 3 0 0 1 0 0 \"\"\n  XDAT 2 2 0 0 1 0 0 \"\"\n  XDAT 4 1.6e-5 0\n");
  EXPECT_EQ(extended.aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-6}}));
  EXPECT_EQ(terms("XOSPHERE", "  XDAT 1 3\n  XDAT 2 1\n  XDAT 5 1.5e-5\n").aspheric,
            (std::vector<petzval::AsphereTerm>{{3, 1.5e-5}}));
  expect_tokens(refusal(with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE ODDASPHE\n  PARM 1 1e-3\n  CURV 0.02")),
                {"order 1"});
  EXPECT_EQ(
      read(with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE TOROIDAL\n  PARM 1 0\n  CURV 0.02")).surfaces[1].curved_in,
      petzval::Section::y);
  expect_tokens(refusal(with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE TOROIDAL\n  PARM 1 30\n  CURV 0.02")),
                {"TOROIDAL"});
}

TEST(Zemax, MissingSurfacesAreRefusedByName) {
  for (const char* type : {"PARAXIAL", "BICONICX", "DGRATING", "USERSURF", "FRESNELS"}) {
    expect_tokens(refusal(with(singlet, "TYPE STANDARD\n  CURV 0.02", std::string("TYPE ") + type + "\n  CURV 0.02")),
                  {"x", "line 36", "TYPE", type});
  }
  expect_tokens(refusal(with(singlet, "MODE SEQ", "MODE NSC")), {"x", "line 2", "MODE", "\"NSC\""});
}

TEST(Zemax, AperturesAreRims) {
  EXPECT_EQ(read(with_line("CLAP 0 6 0")).surfaces[1].semi_diameter, 6);
  EXPECT_EQ(read(with_line("FLAP 1 6 0")).surfaces[1].obscuration_semi_diameter, 1);
  EXPECT_EQ(read(with_line("OBSC 0 2 0")).surfaces[1].obscuration_semi_diameter, 2);
  EXPECT_NE(warning(with_line("OBDC 1 0"), "OBDC"), "no warning");
  EXPECT_EQ(warning(with_line("OBDC 0 0"), "OBDC"), "no warning");
  for (const char* shape : {"SQAP", "SQOB", "ELAP", "ELOB", "SPID", "UDAP"}) {
    EXPECT_NE(warning(with_line(std::string(shape) + " 3 4 0"), shape), "no warning");
  }
}

TEST(Zemax, OpaqueRings_ReachTheRimOrAreRefused) {
  // A ring up to the rim of 8 mm, or beyond it, leaves the opening inside.
  for (const char* ring : {"OBSC 3 8 0", "OBSC 3 20 0"}) {
    const Prescription p = read(with_line(ring));
    EXPECT_EQ(p.surfaces[1].semi_diameter, 3) << ring;
    EXPECT_FALSE(p.surfaces[1].obscuration_semi_diameter);
    EXPECT_TRUE(p.imported->warnings.empty());
  }
  expect_tokens(refusal(with_line("OBSC 3 5 0")), {"x", "line 40", "OBSC", 3, 5, 8});
  EXPECT_EQ(read(with_line("OBSC 3 3 0")).surfaces, read(singlet).surfaces);  // no ring
}

TEST(Zemax, DummyPlanes_ClipByClearAperturesOnly) {
  // Behind the lens, with a semi-diameter of the user.
  const auto dummy = [](const std::string& lines) {
    return read(with(with(singlet, "SURF 4\n", "SURF 5\n"), "  DIAM 7 0 0 0 1 \"\"\n",
                     "  DIAM 7 0 0 0 1 \"\"\nSURF 4\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n" + lines));
  };
  EXPECT_FALSE(dummy("  DIAM 1E-6 1 0 0 1 \"\"\n").surfaces[3].semi_diameter);
  EXPECT_EQ(dummy("  DIAM 2 1 0 0 1 \"\"\n  CLAP 0 2 0\n").surfaces[3].semi_diameter, 2);
  EXPECT_EQ(dummy("  DIAM 2 1 0 0 1 \"\"\n  FLAP 0 2 0\n").surfaces[3].semi_diameter, 2);
  EXPECT_EQ(dummy("  DIAM 6 0 0 0 1 \"\"\n  OBSC 2 6 0\n").surfaces[3].semi_diameter, 2);
}

TEST(Zemax, DeclaredBeams_AreClippedByTheRimOfTheStop) {
  const auto stop = [](const std::string& aperture, const std::string& lines) {
    return read(with(with(singlet, "ENPD 10", aperture), "  DISZ 2\n", "  DISZ 2\n" + lines));
  };
  const std::string wide = "  DIAM 7 1 0 0 1 \"\"\n  FLAP 0 7 0\n", narrow = "  DIAM 3 1 0 0 1 \"\"\n";
  for (const char* aperture : {"ENPD 10", "FNUM 5 0"}) {
    const double declared = *stop(aperture, "").surfaces[0].semi_diameter;
    const Prescription launched = stop(aperture, wide), clipped = stop(aperture, narrow);
    EXPECT_EQ(launched.surfaces[0].semi_diameter, declared) << aperture;
    EXPECT_TRUE(launched.imported->warnings.empty());
    EXPECT_EQ(clipped.surfaces[0].semi_diameter, 3);
    ASSERT_EQ(clipped.imported->warnings.size(), 1u);
    expect_tokens(warning(clipped, "stop"), {3, petzval::testing::digits(declared, 6)});
  }
  // The size of the stop launches the beam, automatic or not; a clear aperture clips the beam.
  EXPECT_EQ(stop("FLOA 0", wide).surfaces[0].semi_diameter, 7);
  EXPECT_EQ(stop("FLOA 0", "  DIAM 4 0 0 0 1 \"\"\n").surfaces[0].semi_diameter, 4);
  EXPECT_EQ(stop("FLOA 0", narrow + "  CLAP 0 6 0\n").surfaces[0].semi_diameter, 3);
  EXPECT_EQ(stop("FLOA 0", wide + "  CLAP 0 6 0\n").surfaces[0].semi_diameter, 6);
  EXPECT_EQ(stop("ENPD 10", "  DIAM 4 0 0 0 1 \"\"\n").surfaces[0].semi_diameter, 5);  // the width of a beam
}

const petzval::GlassCatalogue& glasses() {
  static const auto tables = petzval::GlassCatalogue::load(petzval::data_directory() / "glass");
  return tables;
}

// A Cooke triplet of 50 mm that is published as f/5: its rims are wider than the beam.
TEST(Zemax, TripletHasTheFNumberOfItsEntrancePupil) {
  std::string text =
      "VERS 140730 0 0\nMODE SEQ\nNAME triplet\nUNIT MM X W X CM\nENPD 10\nGCAT SCHOTT\n"
      "FTYP 0 0 1 1\nYFLN 0\nWAVM 1 0.55 1\nPWAV 1\nSURF 0\n  CURV 0\n  DISZ INFINITY\n";
  struct Surface {
    double radius, thickness;
    const char* glass;
    double rim;
  };
  int number = 0;
  for (const Surface& s : {Surface{22.01359, 3.25896, "SK16", 9.5}, Surface{-435.76044, 6.00755, "", 9.5},
                           Surface{-22.21328, 0.99997, "F2", 5}, Surface{20.29192, 4.75041, "", 5},
                           Surface{79.6836, 2.95208, "SK16", 7.5}, Surface{-18.39533, 42.20778, "", 7.5}}) {
    const std::string rim = petzval::testing::digits(s.rim);
    ++number;
    text += "SURF " + std::to_string(number) + "\n" + (number == 4 ? "  STOP\n" : "") + "  CURV " +
            petzval::testing::digits(1 / s.radius) + " 0 0 0\n  DISZ " + petzval::testing::digits(s.thickness) + "\n" +
            (*s.glass ? std::string("  GLAS ") + s.glass + " 0 0 0 0 0 0 0 0 0 0\n" : "") + "  DIAM " + rim +
            " 1 0\n  FLAP 0 " + rim + " 0\n";
  }
  const Prescription p = read(text + "SURF 7\n  CURV 0\n  DISZ 0\n");
  EXPECT_NEAR(petzval::real_f_number(compile(p, std::array{550.0}, {.glasses = &glasses()})), 5, 1e-4);
  EXPECT_TRUE(p.imported->warnings.empty());
}

TEST(Zemax, StopOfEachPositionFollowsItsBeam) {
  const std::string rim = "  DISZ 2\n  DIAM 6 1 0 0 1 \"\"\n";
  const Prescription p = read(with(singlet, "  DISZ 2\n", rim) +
                              "MNUM 4 1\nAPER 0 1 10\nAPER 0 2 8\nAPER 0 3 14\nAPER 0 4 12\nSDIA 1 4 2\n");
  ASSERT_EQ(p.configurations.size(), 4u);
  const double sizes[] = {5, 4, 6, 2};  // a front stop: half of the beam, or the rim
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(*configured(p, i).surfaces[0].semi_diameter, sizes[i], 1e-12) << i;
  expect_tokens(warning(p, "stop"), {"position 3"});
  EXPECT_EQ(p.imported->warnings.size(), 1u);
}

TEST(Zemax, TiltsOfObjectAndImageAreRefused) {
  const auto tilted = [](std::string text, const std::string& surface, double tangent) {
    text = with(std::move(text), "DISZ INFINITY", "DISZ 98");
    if (surface == "SURF 0") {
      return with(std::move(text), "SURF 0\n  TYPE STANDARD\n",
                  "SURF 0\n  TYPE TILTSURF\n  PARM 1 0\n  PARM 2 " + petzval::testing::digits(tangent) + "\n");
    }
    return with(std::move(text), "SURF 4\n  TYPE STANDARD\n",
                "SURF 4\n  TYPE TILTSURF\n  PARM 1 " + petzval::testing::digits(tangent) + "\n");
  };
  expect_tokens(refusal(tilted(singlet, "SURF 0", 1)), {"x", "line 26", "TYPE", 45, "y"});
  expect_tokens(refusal(tilted(singlet, "SURF 4", -1)), {"x", "line 47", "TYPE", -45, "x"});
  const Prescription upright = read(with(singlet, "DISZ INFINITY", "DISZ 98"));
  for (const char* surface : {"SURF 0", "SURF 4"}) {
    EXPECT_EQ(read(tilted(singlet, surface, 0)).surfaces, upright.surfaces);
  }
  // A curved object is named, unless it is at infinity.
  const std::string curved = with(singlet, "  CURV 0.0 0", "  CURV 0.01 0");
  EXPECT_NE(warning(with(curved, "DISZ INFINITY", "DISZ 98"), "SURF"), "no warning");
  EXPECT_EQ(warning(curved, "SURF"), "no warning");
}

TEST(Zemax, TelecentricObjectSpacesAreRefusedUnlessTheStopMakesThem) {
  const std::string near = with(with(singlet, "ENPD 10", "OBNA 0.02 0"), "DISZ INFINITY", "DISZ 98");
  for (const std::string& text : {singlet, near}) {
    expect_tokens(refusal(with(text, "FTYP 0 0", "FTYP 1 1")), {"x", "line 13", "FTYP"});
  }
  // The stop behind the lens, in its focal plane.
  const double focus = petzval::first_order(compile(read(singlet))).back_focal_distance;
  std::string text = with(with(near, "FTYP 0 0", "FTYP 1 1"), "  STOP\n", "");
  text = with(with(text, "  DISZ 48\n", "  DISZ " + petzval::testing::digits(focus) + "\n"), "SURF 4\n",
              "SURF 4\n  STOP\n  CURV 0\n  DISZ 20\nSURF 5\n");
  EXPECT_TRUE(read(text).surfaces[3].stop);
}

TEST(Zemax, CommandsThatChangeNoLensAreSilent) {
  std::string header, lines;
  for (const char* command : {"CSUM 1693307950", "LUID 1", "AUTH somebody", "PUPD 11.5 10", "ZVDX 0 0", "ZVDY 0 0.1",
                              "ZVCX 0 0", "ZVCY 0 0.2", "ZVAN 0 0", "TCMM a tolerance"}) {
    header += std::string(command) + "\n";
  }
  for (const char* command : {"COAT", "SSID 1", "UDAD 0 1", "VPAR 2", "VCON", "VDSZ 0 0", "PPAR 2 1 1 0", "EDGE 2 5"}) {
    lines += std::string("  ") + command + "\n";
  }
  Prescription p = read(with(with(singlet, "  DISZ 4\n", "  DISZ 4\n" + lines), "MODE SEQ\n", "MODE SEQ\n" + header));
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings.front().command;
  EXPECT_EQ(p.surfaces, read(singlet).surfaces);
  EXPECT_TRUE(read(singlet + "MNUM 2 1\nCOTN 2 1 AR\nCOTN 2 2 AR\nFLWT 1 1 1\nFLWT 1 2 2\nCSUM 5\n")
                  .imported->warnings.empty());
}

/// The singlet with a coating on its front surface.
Prescription coated(const std::string& name) {
  return read(with(singlet, "  DISZ 4\n", "  DISZ 4\n  COAT " + name + "\n"));
}

TEST(Zemax, CoatingsOfKnownNamesAreTaken) {
  const Prescription plain = read(singlet);
  for (const auto& row : plain.surfaces) EXPECT_FALSE(row.coating);
  for (const char* name : {"AR", "ar", "I.99", "I.5", "I.0", "i.999", "I.00"}) {
    const Prescription p = coated(name);
    EXPECT_TRUE(p.imported->warnings.empty()) << name;
    ASSERT_TRUE(p.surfaces[1].coating) << name;
    EXPECT_FALSE(p.surfaces[0].coating || p.surfaces[2].coating);
    petzval::validate(*p.surfaces[1].coating, name);
  }
  // A quarter wave of the primary wavelength, here the second or the first.
  EXPECT_EQ(coated("AR").surfaces[1].coating, petzval::Coating::quarter_wave(1.38, 587.5618));
  const Prescription first = read(with(with(singlet, "PWAV 2", "PWAV 1"), "  DISZ 4\n", "  DISZ 4\n  COAT AR\n"));
  EXPECT_DOUBLE_EQ(first.surfaces[1].coating->layers.at(0).thickness_nm, 486.1327 / (4 * 1.38));
  const auto reflectance = [](const char* name, double nm) {
    return surface_light(coated(name).surfaces[1].coating.value(), 1, 1.5, 1, nm).reflectance();
  };
  for (const double nm : {300.0, 587.5618, 12000.0}) {
    EXPECT_EQ(reflectance("I.99", nm), 0.01);
    EXPECT_EQ(reflectance("I.5", nm), 0.5);
    EXPECT_EQ(reflectance("I.0", nm), 1);
    EXPECT_EQ(reflectance("i.999", nm), 0.001);
  }
}

TEST(Zemax, CoatingsOfOtherNamesAreNamed) {
  for (const char* name : {"HEAR1", "METAL", "NULL", "I", "I.", "I.9x", "I1.5", "I.-5", "ARX", "A"}) {
    const Prescription p = coated(name);
    EXPECT_FALSE(p.surfaces[1].coating) << name;
    ASSERT_EQ(p.imported->warnings.size(), 1u) << name;
    expect_tokens(warning(p, "COAT"), {name, "surface 1", "left out", "AR", "I.nn"});
    EXPECT_EQ(p.imported->warnings[0].line, 40) << name;
  }
  // Surfaces with the same coating share a warning.
  const Prescription both =
      read(with(with(singlet, "  DISZ 4\n", "  DISZ 4\n  COAT HEAR1\n"), "  DISZ 48\n", "  DISZ 48\n  COAT HEAR1\n"));
  ASSERT_EQ(both.imported->warnings.size(), 1u);
  expect_tokens(warning(both, "COAT"), {"HEAR1", "1, 2"});
  // A quarter wave on a mirror would be the substrate of the mirror; an ideal coating applies.
  const auto mirror = [](const std::string& name) {
    return read(with(
        with(with(singlet, "GLAS ___BLANK 1 0 1.5 60 0", "GLAS MIRROR\n  COAT " + name), "  DISZ 4\n", "  DISZ -4\n"),
        "  DISZ 48\n", "  DISZ -48\n"));
  };
  EXPECT_FALSE(mirror("AR").surfaces[1].coating);
  expect_tokens(warning(mirror("AR"), "COAT"), {"AR", "surface 1", "mirror"});
  EXPECT_TRUE(mirror("I.05").surfaces[1].coating);
  // Coatings that differ among configurations are named.
  expect_tokens(warning(read(singlet + "MNUM 2 1\nCOTN 2 1 AR\nCOTN 2 2 I.99\n"), "COTN"),
                {"configurations", "left out"});
}

TEST(Zemax, SolvesWhoseSolutionIsStatedAreSilent) {
  for (const std::string& text :
       {with(singlet, "CURV -0.02 0", "CURV -0.02 11"), with(singlet, "CURV 0.02 0", "CURV 0.02 2 -0.1"),
        with(singlet, "___BLANK 1 0 1.5 60 0", "N-BK7 3 0 1.5168 64.17 0"),
        with(singlet, "  DISZ 4\n", "  DISZ 4\n  MAZH 1 0\n"), with(singlet, "  DISZ 48\n", "  DISZ 48\n  MAZH 1 0\n"),
        with(singlet, "  DISZ 48\n", "  DISZ 49.33\n  MAZH 0 0\n")}) {
    EXPECT_TRUE(read(text).imported->warnings.empty()) << text;
  }
  // A film that contradicts its solve is kept, with a warning that states both distances.
  const Prescription p = read(with(singlet, "  DISZ 48\n", "  DISZ 48\n  MAZH 0 0\n"));
  EXPECT_EQ(p.surfaces[2].thickness, 48);
  const double focus = petzval::first_order(compile(p)).back_focal_distance;
  expect_tokens(warning(p, "MAZH"), {48, petzval::testing::digits(focus, 8)});
  // A near object is imaged by the same solve.
  const Prescription near =
      read(with(with(singlet, "  DISZ 48\n", "  DISZ 0\n  MAZH 0 0\n"), "DISZ INFINITY", "DISZ 200"));
  const petzval::Lens lens = compile(near);
  EXPECT_NEAR(near.surfaces[2].thickness, petzval::paraxial_image_z(lens, -200) - lens.surfaces()[2].vertex_z, 1e-9);
}

TEST(Zemax, StopFollowsTheDeclaredAperture) {
  const auto paraxial = [](const std::string& line) {
    const petzval::Lens lens = compile(read(with(singlet, "ENPD 10", line)));
    return petzval::real_f_number(lens);
  };
  EXPECT_NEAR(paraxial("FNUM 6 0"), 6, 1e-6);
  EXPECT_NEAR(paraxial("ENPD 5"), petzval::first_order(compile(read(singlet))).effective_focal_length / 5, 1e-6);
  // The stop has its own size.
  const auto fixed =
      read(with(with(singlet, "ENPD 10", "FLOA 0"), "  DISZ 2\n", "  DISZ 2\n  DIAM 3.5 1 0 0 1 \"\"\n"));
  EXPECT_EQ(fixed.surfaces[0].semi_diameter, 3.5);
  // The cone from the object: n sin u of the ray to the rim of the stop, at a distance of 98 mm.
  const auto near = read(with(with(singlet, "ENPD 10", "OBNA 0.1 0"), "DISZ INFINITY", "DISZ 98"));
  EXPECT_EQ(near.design.object_distance_mm, 98);
  EXPECT_NEAR(*near.surfaces[0].semi_diameter, 98 * std::tan(std::asin(0.1)), 1e-9);
}

TEST(Zemax, PickupsAndSumsAreEvaluated) {
  const std::string text = with(singlet, "CURV -0.02 0 0 0 0", "CURV -0.02 4 2 -1 0");
  EXPECT_TRUE(read(text).imported->warnings.empty());
  const Prescription stale = read(with(text, "CURV -0.02 4", "CURV -0.03 4"));
  EXPECT_EQ(stale.surfaces[2].radius, -50);
  expect_tokens(warning(stale, "CURV"), {-0.03});
  const Prescription thick = read(with(singlet, "  DISZ 48\n", "  DISZ 48\n  PZUP 2 3 1\n"));
  EXPECT_EQ(thick.surfaces[2].thickness, 13);
  EXPECT_EQ(read(with(singlet, "  DISZ 48\n", "  DISZ 1\n  TCOM 2 20\n")).surfaces[2].thickness, 16);
  EXPECT_EQ(read(with(singlet, "  DISZ 48\n", "  DISZ 1\n  TOLE 1 20\n")).surfaces[2].thickness, 14);
  expect_tokens(refusal(with(text, "4 2 -1", "4 7 -1")), {"CURV", 7});
  const Prescription glass = read(with(singlet, "  DISZ 48\n", "  DISZ 48\n  GLAS ___BLANK 2 2 1.5 60 0\n"));
  EXPECT_EQ(glass.surfaces[2].medium.nd, 1.5);
  // The marginal height of the last surface is the focus.
  const double focus = petzval::first_order(compile(read(singlet))).back_focal_distance;
  const Prescription solved = read(with(singlet, "  DISZ 48\n", "  DISZ 0\n  MAZH 0 0\n"));
  EXPECT_NEAR(solved.surfaces[2].thickness, focus, 1e-9);
  EXPECT_NE(warning(solved, "MAZH"), "no warning");
  EXPECT_EQ(warning(with(singlet, "  DISZ 48\n", "  DISZ 49.324\n  MAZH 0 0\n"), "MAZH"), "no warning");
}

// A file without a number in its surfaces: pickups and operands keep the numbers of the file.
TEST(Zemax, NumbersOfSurfacesMayHaveGaps) {
  const std::string pickup = "  DISZ 48\n  PZUP 2 3 1\n", sum = "  DISZ 1\n  TCOM 2 20\n";
  for (const std::string& solve : {std::string("  DISZ 48\n"), pickup, sum}) {
    const std::string text = with(singlet, "  DISZ 48\n", solve) + "MNUM 2 1\nCRVT 3 1 -0.02\nCRVT 3 2 -0.025\n";
    std::string gap = text;
    for (const auto& [from, to] :
         {std::pair("SURF 4", "SURF 7"), std::pair("SURF 3", "SURF 6"), std::pair("SURF 2", "SURF 5"),
          std::pair("PZUP 2", "PZUP 5"), std::pair("TCOM 2", "TCOM 5"), std::pair("CRVT 3 1", "CRVT 6 1"),
          std::pair("CRVT 3 2", "CRVT 6 2")}) {
      if (gap.find(from) != std::string::npos) gap = with(gap, from, to);
    }
    const Prescription p = read(gap);
    EXPECT_EQ(p.surfaces, read(text).surfaces) << solve;
    EXPECT_EQ(p.configurations, read(text).configurations) << solve;
    expect_tokens(warning(p, "SURF"), {5, 1});
  }
  expect_tokens(refusal(with(singlet, "SURF 4", "SURF 2")), {"SURF", 2});
  expect_tokens(refusal(with(singlet, "SURF 0", "SURF 1")), {"SURF", 1});
}

TEST(Zemax, GlassesAreFoundOrReported) {
  const auto glass = [](const std::string& line) {
    return with(singlet, "GLAS ___BLANK 1 0 1.5 60 0 0 0 0 0 0", "GLAS " + line);
  };
  const petzval::Medium bk7 = read(glass("N-BK7 0 0 1.5 40 0 0 0 0 0 0")).surfaces[1].medium;
  EXPECT_EQ(bk7.catalogue, "schott");
  const double formula = petzval::refractive_index(*petzval::glass_tables().find("N-BK7"), petzval::d_line_nm);
  EXPECT_EQ(bk7.nd, formula);
  EXPECT_EQ(read(glass("NBK7 0 0 0 0 0")).surfaces[1].medium.glass, "N-BK7");
  // The placeholder index of an unknown glass.
  expect_tokens(refusal(glass("XYZ12 0 0 1.5 40 0 0 0 0 0 0")), {"x", "line 40", "XYZ12"});
  expect_tokens(refusal(glass("XYZ12 0 0 1.5 40 0")), {"--glasses FILE"});
  const Prescription known = read(glass("XYZ12 0 0 1.62 60.3 0 0 0 0 0 0"));
  EXPECT_EQ(known.surfaces[1].medium, (petzval::Medium{.glass = "XYZ12", .nd = 1.62, .vd = 60.3}));
  expect_tokens(warning(known, "XYZ12"), {620603});
  EXPECT_EQ(read(glass("517642 0 0 1.5 40 0")).surfaces[1].medium.nd, 1.517);
  EXPECT_NEAR(read(glass("N-BK7 4 0 0 0 0 0 0 0 0.001 0")).surfaces[1].medium.nd.value(), formula + 0.001, 1e-12);
  EXPECT_EQ(read(glass("AIR 0 0 0 0 0")).surfaces[1].medium, petzval::Medium{});
  EXPECT_EQ(read(glass("N-BK7 0 0 1.7 40 0")).surfaces[1].medium, bk7);
}

TEST(Zemax, MirrorsKeepTheMediumInFront) {
  const Prescription p =
      read(with(with(with(singlet, "GLAS ___BLANK 1 0 1.5 60 0 0 0 0 0 0", "GLAS MIRROR 0 0 1.5 40 0"), "  DISZ 4\n",
                     "  DISZ -4\n"),
                "  DISZ 48\n", "  DISZ -48\n"));
  EXPECT_TRUE(p.surfaces[1].mirror);
  EXPECT_EQ(p.surfaces[1].medium, petzval::Medium{});
}

/// A coordinate break on each side of surface 2.
std::string with_breaks(const std::string& first, const std::string& between, const std::string& second) {
  const auto surface = [](int n, const std::string& lines) { return "SURF " + std::to_string(n) + "\n" + lines; };
  const std::size_t start = singlet.find("SURF 2");
  std::string rest = singlet.substr(start);
  std::string head = singlet.substr(0, start) + surface(2, first) + surface(3, between) + surface(4, second);
  for (int n = 4; n >= 2; --n) rest = with(rest, "SURF " + std::to_string(n), "SURF x" + std::to_string(n + 3));
  for (int n = 5; n <= 7; ++n) rest = with(rest, "SURF x" + std::to_string(n), "SURF " + std::to_string(n));
  return head + rest;
}

TEST(Zemax, CoordinateBreaksWithoutEffectAreRemoved) {
  const Prescription p = read(singlet);
  const auto moved = [](double by) { return "  TYPE COORDBRK\n  PARM 3 " + std::to_string(by) + "\n  DISZ 0\n"; };
  const std::string plane = "  TYPE STANDARD\n  CURV 0\n  DISZ 0\n";
  EXPECT_EQ(read(with_breaks(moved(5), plane, moved(-5))).surfaces, p.surfaces);
  EXPECT_EQ(read(with_breaks("  TYPE COORDBRK\n  DISZ 0\n", plane, "  TYPE COORDBRK\n  DISZ 0\n")).surfaces.size(), 4u);
  const std::string curved = "  TYPE COORDBRK\n  CURV 0.01\n  GLAS N-BK7 0 0 1.5 40 0\n  DISZ 0\n";
  expect_tokens(warning(read(with_breaks(curved, plane, "  TYPE COORDBRK\n  DISZ 0\n")), "COORDBRK"),
                {"CURV", "GLAS N-BK7"});
  expect_tokens(refusal(with_breaks(moved(5), plane, moved(5))), {"COORDBRK", 2});
  // A fold by a plane mirror is unfolded: light runs on as before.
  const Prescription straight = read(with(singlet, "  DISZ 2\n", "  DISZ 12\n"));
  std::string folded = with_breaks("  TYPE COORDBRK\n  PARM 3 45\n  DISZ 0\n",
                                   "  TYPE STANDARD\n  CURV 0\n  DISZ 0\n  GLAS MIRROR 0 0\n",
                                   "  TYPE COORDBRK\n  PARM 3 45\n  DISZ -10\n");
  for (const auto& [old, now] :
       {std::pair("CURV 0.02", "CURV -0.02"), std::pair("  DISZ 4\n", "  DISZ -4\n"),
        std::pair("CURV -0.02 0 0 0 0 \"\"\n  DISZ 48", "CURV 0.02 0 0 0 0 \"\"\n  DISZ -48")}) {
    folded = with(folded, old, now);
  }
  const Prescription unfolded = read(folded);
  ASSERT_EQ(unfolded.surfaces.size(), straight.surfaces.size());
  for (std::size_t i = 0; i < unfolded.surfaces.size(); ++i) {
    EXPECT_EQ(unfolded.surfaces[i].radius, straight.surfaces[i].radius) << i;
    EXPECT_EQ(unfolded.surfaces[i].thickness, straight.surfaces[i].thickness) << i;
  }
  EXPECT_NE(warning(unfolded, "COORDBRK"), "no warning");
}

TEST(Zemax, ConfigurationsAreReadByOperand) {
  const std::string table = R"(MNUM 3 1
LTTL 0 1 "wide" 0 0 0 1 1 0 0.0 "" 0
LTTL 0 2 "tele" 0 0 0 1 1 0 0.0 "" 0
THIC 2 1 4 0 0 0 1 1 1 0 0 "" 0
THIC 2 2 5 0 0 0 1 1 1 0 0 "" 0
THIC 2 3 6 0 0 0 1 1 1 0 0 "" 0
CRVT 3 1 -0.02 0 0 0 1 1 1 0 0 "" 0
CRVT 3 2 -0.025 0 0 0 1 1 1 0 0 "" 0
YFIE 1 1 5 0 0 0 1 1 1 0 0 "" 0
YFIE 1 2 6 0 0 0 1 1 1 0 0 "" 0
)";
  const Prescription p = read(singlet + table);
  ASSERT_EQ(p.configurations.size(), 3u);
  EXPECT_EQ(p.configurations[0].name, "wide");
  EXPECT_EQ(p.configurations[2].name, "position 3");
  EXPECT_EQ(configured(p, "tele").surfaces[1].thickness, 5);
  EXPECT_EQ(configured(p, "tele").surfaces[2].radius, -40);
  EXPECT_EQ(configured(p, 1.5).surfaces[1].thickness, 5.5);
  EXPECT_NE(warning(p, "YFIE"), "no warning");
  expect_tokens(refusal(singlet + table + "THIC 9 1 4\n"), {"surface", 9});
  expect_tokens(refusal(singlet + table + "THIC 2 4 4\n"), {"configuration", 4});
  // One position is at infinity; the others focus.
  const Prescription near = read(singlet + "MNUM 2 1\nTHIC 0 1 1e10\nTHIC 0 2 500\nTHIC 3 1 48\nTHIC 3 2 53\n");
  EXPECT_EQ(near.configurations[1].focus_of, "position 1");
  EXPECT_EQ(near.configurations[1].subject_distance_mm, 500);
  EXPECT_EQ(compile(near).focus_positions().size(), 2u);
}

TEST(Zemax, TruncatedFilesAndRepeatedCommandsAreReported) {
  expect_tokens(refusal(singlet.substr(0, singlet.find("  DIAM 8"))), {"x"});
  EXPECT_NE(warning(singlet.substr(0, singlet.find("  DISZ 48")), "SURF"), "no warning");
  EXPECT_NE(warning(with(singlet, "  DISZ 4\n", ""), "DISZ"), "no warning");
  EXPECT_NE(warning(with(singlet, "  DISZ 4\n", "  DISZ 4\n  DISZ 5\n"), "DISZ"), "no warning");
  EXPECT_NE(warning(with(singlet, "SURF 3\n", "SURF 3\n  STOP\n"), "STOP"), "no warning");
  EXPECT_NE(warning(with(singlet, "PWAV 2", "PWAV 9"), "PWAV"), "no warning");
}

TEST(Zemax, ImagesAtInfinityAndMissingUnitsAreReported) {
  const Prescription p = read(with(singlet, "DISZ 48", "DISZ INFINITY"));
  EXPECT_NEAR(p.surfaces[2].thickness, petzval::first_order(compile(p)).back_focal_distance, 1e-9);
  EXPECT_NE(warning(p, "DISZ"), "no warning");
  expect_tokens(refusal(with(singlet, "DISZ 4\n", "DISZ INFINITY\n")), {"DISZ"});
  EXPECT_NE(warning(with(singlet, "UNIT MM X W X CM MR CPMM\n", ""), "UNIT"), "no warning");
}

TEST(Zemax, StopOpensAsTheLensZooms) {
  const std::string text = with(singlet, "ENPD 10", "FNUM 5 0") + "MNUM 2 1\nCRVT 2 1 0.02\nCRVT 2 2 0.03\n";
  const Prescription p = read(text);
  for (const int i : {0, 1}) {
    EXPECT_NEAR(petzval::real_f_number(compile(p, {.configuration = i})), 5, 1e-6) << i;
  }
}

TEST(Zemax, EveryCommandIsReadOrReported) {
  EXPECT_NE(warning(singlet + "XYZZ 1 2 3\n", "XYZZ"), "no warning");
  EXPECT_NE(warning(with_line("ABCD 1"), "ABCD"), "no warning");
  const Prescription p = read(with_line("ABCD 1"));
  EXPECT_EQ(p.imported->warnings[0].line, 40);
  // Once for each command.
  const Prescription twice = read(with_line("ABCD 1\n  EFGH\n  ABCD 2\n  ABCD 3"));
  ASSERT_EQ(twice.imported->warnings.size(), 2u);
  EXPECT_EQ(twice.imported->warnings[0].line, 40);
  expect_tokens(warning(twice, "ABCD"), {2, "lines"});
  // The merit function, tolerances and windows change nothing.
  EXPECT_TRUE(read(singlet + "EFFL 0 2 0 0 0 0 50 1 0 0\nREAY 4 2 0 1 0 0 2.25 0 0 0\nTOL TOFF 0 0 0 0\n")
                  .imported->warnings.empty());
  expect_error([] { petzval::parse_lens(with_line("ABCD 1"), "x", {.strict = true}); }, {"x", "line 40", "ABCD"});
  EXPECT_NE(warning(with(singlet, "ENVD 20 1 0", "ENVD 35 1 0"), "ENVD"), "no warning");
}

TEST(Zemax, ConfigurationsChangeShapesGlassesAndFNumbers) {
  const Prescription p = read(with(singlet, "ENPD 10", "FNUM 5 0") +
                              "MNUM 2 1\nLTTL 0 1 \"a\"\nLTTL 0 2 \"a\"\nMOFF 0 1 x\nTHIC 0 1 INFINITY\nTHIC 0 2 400\n"
                              "CONN 2 1 0\nCONN 2 2 -0.5\nSDIA 3 1 0\nSDIA 3 2 6\nAPER 0 1 5\nAPER 0 2 8\n"
                              "GLSS 2 1 \"N-BK7\"\nGLSS 2 2 \"AIR\"\nWLWT 1 1 1\nWLWT 1 2 1\n");
  ASSERT_EQ(p.configurations.size(), 2u);
  EXPECT_EQ(p.configurations[0].name, "a");
  EXPECT_EQ(p.configurations[1].name, "a (2)");
  EXPECT_EQ(p.configurations[1].focus_of, "a");
  EXPECT_EQ(p.configurations[1].f_number, 8);
  const Prescription near = configured(p, 1);
  EXPECT_EQ(near.surfaces[1].conic, -0.5);
  EXPECT_EQ(near.surfaces[1].medium, petzval::Medium{});
  EXPECT_EQ(near.surfaces[2].semi_diameter, 6);
  EXPECT_EQ(configured(p, 0).surfaces[2].semi_diameter, 7);
  EXPECT_EQ(configured(p, 0).surfaces[1].medium.glass, "N-BK7");
  EXPECT_EQ(warning(p, "WLWT"), "no warning");  // the same in both
}

TEST(Zemax, MarginalHeightsUseTheZoneOfThePupil) {
  const auto thickness = [](const std::string& aperture, const std::string& solve) {
    return read(with(with(singlet, "  DISZ 48\n", "  DISZ 0\n  " + solve + "\n"), "ENPD 10", aperture))
        .surfaces[2]
        .thickness;
  };
  const double focus = petzval::first_order(compile(read(singlet))).back_focal_distance;
  const double focal_length = petzval::first_order(compile(read(singlet))).effective_focal_length;
  EXPECT_LT(thickness("ENPD 10", "MAZH 0 1"), thickness("ENPD 10", "MAZH 0 0.5"));
  EXPECT_LT(thickness("ENPD 10", "MAZH 0 0.5"), focus);
  EXPECT_NEAR(thickness("FNUM " + petzval::testing::digits(focal_length / 10) + " 0", "MAZH 0 1"),
              thickness("ENPD 10", "MAZH 0 1"), 1e-9);
  EXPECT_EQ(thickness("FLOA 0", "MAZH 0 1"), 0);    // without a pupil
  EXPECT_EQ(thickness("ENPD 300", "MAZH 0 1"), 0);  // the ray misses
}

TEST(Zemax, TextsAreCutBetweenCharacters) {
  const std::string title = std::string(4095, 'a');
  EXPECT_EQ(read(with(singlet, "NAME A singlet", "NAME " + title + "\xC3\xA9")).imported->title, title);
  EXPECT_EQ(read(with(singlet, "NOTE 0 first pa", "NOTE 0\xC3\xA9 pa")).imported->notes[0], "\xC3\xA9 part");
}

TEST(Zemax, NamesASecondAperture) {
  const Prescription p = read(with(singlet, "ENPD 10", "ENPD 10\nFNUM 4 0"));
  ASSERT_TRUE(p.design.aperture);
  EXPECT_EQ(p.design.aperture->setting, petzval::ApertureSetting::f_number);
  ASSERT_FALSE(p.imported->warnings.empty());
  EXPECT_EQ(p.imported->warnings[0].command, "FNUM");
}

TEST(Zemax, InvalidLensesAreRefused) {
  const auto of_type = [](const std::string& type, const std::string& lines) {
    return with(singlet, "TYPE STANDARD\n  CURV 0.02", "TYPE " + type + "\n" + lines + "  CURV 0.02");
  };
  expect_tokens(refusal(of_type("XASPHERE", "  XDAT 1 2000\n")), {"XASPHERE", 2000});
  expect_tokens(refusal(of_type("XASPHERE", "  XDAT 1 1\n  XDAT 3 1\n")), {"XASPHERE", 0});
  expect_tokens(refusal(of_type("XASPHERE", "  XDAT 1 21\n  XDAT 2 1\n  XDAT 23 1e-60\n")), {"XASPHERE", 42});
  expect_tokens(refusal(of_type("TOROIDAL", "  PARM 1 0\n  CONI -1\n")), {"TYPE", "TOROIDAL"});
  expect_tokens(refusal(with(singlet, "SURF 0\n", "SURF 0\n  STOP\n")), {"STOP"});
  expect_tokens(refusal(with(singlet, "SURF 4\n", "SURF 4\n  STOP\n")), {"STOP"});
  expect_tokens(refusal(with(singlet, "___BLANK 1 0 1.5 60 0 0 0 0 0 0", "___BLANK 1")), {"GLAS", "n_d"});
  // A command without its number is not 0.
  for (const char* command : {"CURV", "CONI", "DISZ", "DIAM", "PARM 1", "XDAT 1"}) {
    const std::string name = std::string(command).substr(0, 4);
    expect_tokens(refusal(with_line(command)), {name, "number"});
  }
  for (const char* command : {"ENPD", "FNUM", "OBNA"}) {
    expect_tokens(refusal(with(singlet, "ENPD 10", command)), {command, "number"});
  }
  // The glass picked up from air is air.
  EXPECT_EQ(read(with(singlet, "  DISZ 48\n", "  DISZ 48\n  GLAS ___BLANK 2 1 1.5 60 0\n")).surfaces[2].medium,
            petzval::Medium{});
}

TEST(Zemax, UnevaluatedCommandsAreReported) {
  expect_tokens(
      warning(with(singlet, "GLAS ___BLANK 1 0 1.5 60 0 0 0 0 0 0", "GLAS N-BK7 4 0 0 0 0 0 0 0 0 0.5"), "GLAS"),
      {"V_d", 0.5, "N-BK7"});
  EXPECT_NE(warning(with(singlet, "  DISZ 48\n", "  DISZ 0\n  MAZH 1 0\n"), "MAZH"), "no warning");
  expect_tokens(warning(with(singlet, "FTYP 0", "FTYP 7"), "FTYP"), {"field", 7});
  expect_tokens(refusal(singlet + "MNUM 1 1\n" + petzval::testing::repeated(100'001, "THIC 2 1 4\n")),
                {100000, "values"});
}

TEST(Zemax, NumbersAreFiniteAndHaveDecimalPoints) {
  expect_tokens(refusal(with(singlet, "CURV 0.02", "CURV 0,02")), {"x", "line 38", "CURV", "\"0,02\""});
  for (const char* number : {"nan", "1e400", "inf", "--5", "0x10", "\"\""}) {
    EXPECT_NE(refusal(with(singlet, "DISZ 4", std::string("DISZ ") + number)), "no error") << number;
  }
}

TEST(Zemax, TruncatedTextsAreReadOrRefused) {
  int refused = 0;
  for (std::size_t length = 0; length < singlet.size(); ++length) {
    refused += refusal(singlet.substr(0, length)) != "no error";  // any other exception would end the test
  }
  EXPECT_GT(refused, 500);
}

}  // namespace zemax_test
