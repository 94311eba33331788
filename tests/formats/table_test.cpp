// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "../expect_error.hpp"
#include "lens_text.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace table_test {

using petzval::Prescription;
using petzval::testing::expect_tokens;
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

TEST(Table, DeclaredFNumberDecidesBetweenDiameterAndSemiDiameter) {
  const std::string radii =
      with(with(with(table, "1.5168  25.4", "1.5168  12.7"), "1       25.4", "1       12.7"), "9.4", "4.7");
  const Prescription p = read(radii);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 12.7);
  EXPECT_EQ(p.surfaces[2].semi_diameter, 4.7);
  expect_tokens(warning(p, "aperture"), {"semi-diameters"});
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

TEST(Table, GlassWithoutThicknessShowsGapsInFront) {
  const Prescription p = read("50.6 0 1.5168 25.4\n-50.6 5.2 1 25.4\n0 1 0 9.7\n");
  EXPECT_EQ(p.surfaces[0].thickness, 5.2);
  EXPECT_EQ(p.surfaces[1].thickness, 1);
  EXPECT_NE(warning(p, "thickness"), "no warning");
  EXPECT_NEAR(p.surfaces[2].thickness, petzval::first_order(compile(p)).back_focal_distance, 1e-9);
}

TEST(Table, PlanesOfGlassAreNoStops) {
  const Prescription p = read("50.6 5.2 1.5168 25.4\n0 1 1 25.4\n0 47 0 9.7\n");
  EXPECT_FALSE(p.surfaces[1].stop);
  EXPECT_TRUE(p.surfaces[2].stop);
}

TEST(Table, BadRowsAreRefusedWithTheirLine) {
  expect_tokens(refusal(with(table, "1.5168", "1,5168")), {"x:3", "n", "\"1,5168\""});
  expect_tokens(refusal(with(table, "-50.6  1    1       25.4", "-50.6 1 1")), {"x:4", "row", 3});
  EXPECT_NE(refusal(with(table, "5.2", "nan")), "no error");
  EXPECT_NE(refusal(with(table, "5.2", "1e400")), "no error");
  expect_tokens(refusal(with(table, "25.4", "-25.4")), {"x:3", "aperture", -25.4});
  expect_tokens(refusal(with(table, "1.5168", "6.01")), {"x:3", "index", 6.01});
  expect_tokens(refusal(with(table, "5.2", "d5")), {"x:3", "thickness", "\"d5\""});
  expect_tokens(refusal(with(table, "5.2", "inf")), {"x:3", "thickness", "\"inf\""});
  expect_tokens(refusal(with(table, "-50.6  1 ", "-50.6  - ")), {"x:4", "thickness"});
  EXPECT_EQ(refusal(table + "end of the table\n"), "no error");  // text of a page
  expect_tokens(refusal(table + "r d n ap\n"), {"x:6", "row"});
  expect_tokens(refusal(table + "stop\n"), {"x:6"});
}

// The first row of a lens may be a plane, in every spelling.
TEST(Table, PlaneInAnyRowIsASurface) {
  const double focal_length = 50 / 0.5168;
  for (const char* plane : {"Infinity", "inf", "INF", "-inf", "+Infinity", "\u221e", "-\u221e", "plano", "flat",
                            "infinite", "0", "-0.0", "pl", "\u2212inf"}) {
    const std::string word = plane;
    const Prescription first = read(word + " 5 1.5168 25\n-50 90 1 25\n");
    ASSERT_EQ(first.surfaces.size(), 2u) << plane;
    EXPECT_EQ(first.surfaces[0].radius, 0) << plane;
    EXPECT_EQ(first.surfaces[0].thickness, 5) << plane;
    EXPECT_NEAR(petzval::first_order(compile(first)).effective_focal_length, focal_length, 1e-9);
    const Prescription last = read("50 5 1.5168 25\n" + word + " 90 1 25\n");
    ASSERT_EQ(last.surfaces.size(), 2u) << plane;
    EXPECT_EQ(last.surfaces[1].radius, 0) << plane;
    EXPECT_NEAR(petzval::first_order(compile(last)).effective_focal_length, focal_length, 1e-9);
  }
}

/// The lens of the tables below: a lens, a stop, a lens.
std::vector<petzval::SurfaceRow> two_lenses() {
  return {{.radius = 40, .thickness = 4, .medium = {.nd = 1.62041, .vd = 60.3}, .semi_diameter = 9.5},
          {.radius = -300, .thickness = 5, .semi_diameter = 9.25},
          {.radius = 0, .thickness = 3, .semi_diameter = 7, .stop = true},
          {.radius = -30, .thickness = 2, .medium = {.nd = 1.67270, .vd = 32.2}, .semi_diameter = 7.5},
          {.radius = 0, .thickness = 60, .semi_diameter = 8}};
}

/// Rows without the semi-diameters that were computed.
std::vector<petzval::SurfaceRow> as_typed(std::vector<petzval::SurfaceRow> rows) {
  for (petzval::SurfaceRow& row : rows) {
    if (row.semi_diameter_computed) row.semi_diameter.reset();
    row.semi_diameter_computed = false;
  }
  return rows;
}

void expect_two_lenses(const std::string& text, bool apertures = true, bool abbe = true) {
  SCOPED_TRACE(text);
  Prescription p;
  ASSERT_EQ(petzval::testing::message([&] { p = read(text); }), "no error");
  std::vector<petzval::SurfaceRow> expected = two_lenses();
  for (petzval::SurfaceRow& row : expected) {
    if (!apertures) row.semi_diameter.reset();
    if (!abbe) row.medium.vd.reset();
  }
  std::vector<petzval::SurfaceRow> found = as_typed(p.surfaces);
  for (petzval::SurfaceRow& row : found) row.comment.reset();
  EXPECT_EQ(found, expected) << petzval::testing::warning(p, "stop");
}

TEST(Table, HeadsNameTheColumns) {
  expect_two_lenses(
      "r d nd vd semi\n40 4 1.62041 60.3 9.5\n-300 5 1 0 9.25\nstop 3 1 0 7\n-30 2 1.6727 32.2 7.5\ninf 60 1 0 8\n");
  expect_two_lenses(
      "# | Radius (mm) | Thickness | n_d | V_d | Diameter\n1 | 40 | 4 | 1.62041 | 60.3 | 19\n2 | -300 | 5 | | | 18.5\n"
      "3 | STO | 3 | | | 14\n4 | -30 | 2 | 1.6727 | 32.2 | 15\n5 | inf | 60 | | | 16\n");
  expect_two_lenses(
      "| no | R | d | nd | vd | semi-diameter |\n|---|:-:|---|---|---|--:|\n| 1 | 40 | 4 | 1.62041 | 60.3 | 9.5 |\n"
      "| 2 | -300 | 5 | 1 | - | 9.25 |\n| stop | inf | 3 | | | 7 |\n| 3 | -30 | 2 | 1.6727 | 32.2 | 7.5 |\n"
      "| 4 | flat | 60 | 1 | | 8 |\n");
  expect_two_lenses(
      "comment,SD,abbe,ior,T,ROC\nfront,9.5,60.3,1.62041,4,40\n,9.25,,,5,-300\nStop,7,,,3,Infinity\n"
      ",7.5,32.2,1.6727,2,-30\nrear,8,,,60,Infinity\n");
  expect_two_lenses(
      "R;d;nd;vd;\u03c6;stop\n40,0;4,0;1,62041;60,3;19;\n-300;5;;;18,5;\n0;3;;;14;x\n-30;2;1,6727;32,2;15;\n"
      "inf;60;1;0;16;\n");
  expect_two_lenses(
      "surf\tradius\tthickness\tn (d)\tAbbe number\tclear diameter\n1\t40\t4\t1.62041\t60.3\t19\n2\t-300\t5\t\t\t18.5\n"
      "3*\tstop\t3\t\t\t14\n4\t-30\t2\t1.6727\t32.2\t15\n5\tplano\t60\t\t\t16\n");
  const Prescription cm = read("r d n V D\n4 0.4 1.62041 60.3 1.9\n-30 0.5\ninf 6\n");
  EXPECT_EQ(cm.surfaces.at(0).medium.vd, 60.3);
  EXPECT_EQ(cm.surfaces.at(0).semi_diameter, 0.95);
}

TEST(Table, GapsInFrontHaveAHead) {
  for (const char* text : {"# radius, gap before, n\n50.6 0 1.5168\n-50.6 5.2 1\n0 1 0\n",
                           "# radius, gap before, n, aperture\n50.6 0 1.5168 25.4\n-50.6 5.2 1 25.4\n0 1 0 9.4\n"}) {
    const Prescription p = read(text);
    ASSERT_EQ(p.surfaces.size(), 3u) << text;
    EXPECT_EQ(p.surfaces[0].thickness, 5.2) << text;
    EXPECT_EQ(p.surfaces[1].thickness, 1) << text;
  }
}

TEST(Table, HeadsGiveTheUnits) {
  for (const char* head : {"R (in) d (cm) nd semi (in)", "radius thickness index semi\n(in) cm - in"}) {
    const Prescription p = read(std::string(head) + "\n2 0.5 1.5 0.5\n-2 9 1 0.5\n");
    EXPECT_NEAR(p.surfaces.at(0).radius, 50.8, 1e-12) << head;
    EXPECT_NEAR(p.surfaces.at(0).thickness, 5, 1e-12) << head;
    EXPECT_NEAR(p.surfaces.at(0).semi_diameter.value(), 12.7, 1e-12) << head;
  }
  const Prescription c = read("c d nd\n0.025 4 1.5\n0 60 1\n-0.01 10 1.5\n-0.05 50 1\n");
  EXPECT_NEAR(c.surfaces.at(0).radius, 40, 1e-12);
  EXPECT_EQ(c.surfaces.at(1).radius, 0);
  EXPECT_NEAR(c.surfaces.at(3).radius, -20, 1e-12);
}

TEST(Table, ConicsAndAsphericTermsHaveHeads) {
  const Prescription p = read("r d nd k A4 A6 A10 semi\n50 5 1.5 -1 1e-6 -2e-9 0 10\n-50 90 1 0 - 3D-9 1e-16 10\n");
  EXPECT_EQ(p.surfaces.at(0).conic, -1);
  EXPECT_EQ(p.surfaces.at(0).aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-6}, {6, -2e-9}}));
  EXPECT_EQ(p.surfaces.at(1).aspheric, (std::vector<petzval::AsphereTerm>{{6, 3e-9}, {10, 1e-16}}));
  const Prescription cm = read("r (cm) d nd A4 (cm)\n5 5 1.5 1e-3\n-5 90 1 0\n");
  EXPECT_NEAR(cm.surfaces.at(0).aspheric.at(0).coefficient, 1e-6, 1e-18);
}

TEST(Table, UnknownHeadsAreNamedOrRefused) {
  const std::string rows = "\n50 5 1.5 60 3 12\n-50 90 1 0 4 12\n";
  expect_tokens(warning("r d nd vd transmission semi" + rows, "head"), {"\"transmission\""});
  EXPECT_EQ(read("r d nd vd transmission semi" + rows).surfaces.at(0).semi_diameter, 12);
  expect_tokens(refusal("r d foo vd bar semi" + rows), {"x:1", "head", "\"foo\"", "\"bar\""});
  expect_tokens(refusal("r d nd vd n semi" + rows), {"x:1", "head", "\"nd\""});
  expect_tokens(refusal("r d nd vd dia semi" + rows), {"x:1", "head"});
  expect_tokens(refusal("d nd vd x y semi" + rows), {"x:1", "head"});
  expect_tokens(warning("r d nd vd n(e) semi" + rows, "head"), {"\"n(e)\""});  // the index at another spectral line
  expect_tokens(warning("Cooke triplet of 1893\n" + table, "line"), {"\"Cooke triplet of 1893\""});
  EXPECT_EQ(read("My lens\n50 5 1.5 12\n-50 90 1 12\n").imported->title, "My lens");
}

// A mark behind the number of a row, a title with numbers, and a last row without a distance.
TEST(Table, MarksTitlesAndLastRowsAreTypedInManyWays) {
  const std::string rows =
      "1 40 4 1.62041 60.3 9.5\n2 -300 5 1 - 9.25\n3X inf 3 1 - 7\n4 -30 2 1.6727 32.2 7.5\n5 inf 60 Air - 8\n";
  for (const char* mark : {"(stop)", "S", "STO", "stop"}) {
    expect_two_lenses("No r d nd vd semi\n" + with(rows, "X", mark));
    expect_two_lenses("50 mm f/5\nNo r d nd vd semi\n" + with(rows, "X", mark));
  }
  EXPECT_EQ(read("50 mm f/5\nr d nd vd\n40 4 1.62041 60.3\n-300 50\n").f_number, 5);
  expect_tokens(refusal("40 4 1.62041 60.3\nr d nd vd\n-300 50\n"), {"x:2", "row"});
  for (const char* end : {"-300", "-300 BF", "-300 (variable)"}) {
    const Prescription p = read("r d nd vd\n40 4 1.62041 60.3\n" + std::string(end) + "\n");
    EXPECT_NEAR(p.surfaces[1].thickness, petzval::paraxial_image_z(compile(p), -HUGE_VAL) - 4, 1e-9) << end;
  }
}

// A marked stop without a size stays the stop.
TEST(Table, MarkedStopWithoutASizeHasTheWidthOfTheBeam) {
  const Prescription p = read("40 4 1.62041 60.3\n-300 5\nstop 3\n-30 2 1.6727 32.2\ninf 60\n");
  const petzval::Pupils pupils = petzval::pupils(compile(p));
  EXPECT_FALSE(pupils.stop_inferred);
  EXPECT_EQ(pupils.stop, 2u);
  EXPECT_TRUE(p.surfaces[2].semi_diameter_computed);
}

// Patents print no apertures, and nothing for air.
TEST(Table, PatentsAreTypedAsTheyArePrinted) {
  expect_two_lenses("40 4 1.62041 60.3\n-300 5\nstop 3\n-30 2 1.6727 32.2\ninf 60\n", false);
  expect_two_lenses("r d nd vd\n40 4 1.62041 60.3\n-300 5\nstop inf 3\n-30 2 1.6727 32.2\ninf 60\n", false);
  expect_two_lenses("1 40 4 1.62041 60.3\n2 -300 5\n3 inf 3 stop\n4 -30 2 1.6727 32.2\n5 inf 60\n", false);
  expect_two_lenses("S1 40 4 1.62041 60.3\nS2 -300 5 - -\nSTO inf 3 - -\nS3 -30 2 1.6727 32.2\nS4 inf 60 - -\n", false);
  expect_two_lenses("1* 40 4 1.62041 60.3\n2 -300 5 1 -\nASP 0 3 1 -\n3* -30 2 1.6727 32.2\n4 inf 60 1 -\n", false);
  expect_two_lenses("1 40 4 1.62041 60.3\n2 -300 5\n  * inf 3\n3 -30 2 1.6727 32.2\n4 inf 60\n", false);
  expect_two_lenses("40, 4, 1.62041, 60.3\n-300, 5\n0, 3, stop\n-30, 2, 1.6727, 32.2\nplano, 60\n", false);
  expect_two_lenses(
      "OBJ inf inf - -\n1 40 4 1.62041 60.3\n2 -300 5\nSTO inf 3\n4 -30 2 1.6727 32.2\n5 inf 60\nIMA inf -\n", false);
  expect_two_lenses("object inf inf\n40 4 1.62041 60.3\n-300 5\nstop 3\n-30 2 1.6727 32.2\ninf 60\nimage inf\n", false);
  expect_two_lenses(
      "R,t,n,v,type\ninf,inf,,,OBJ\n40,4,1.62041,60.3,ASP\n-300,5,,,\ninf,3,,,STO\n-30,2,1.6727,32.2,\ninf,60\n"
      "inf,,,,image\n",
      false);
  const Prescription p = read("1 40 4 1.62041 60.3\n2 -300 5\n3 inf 3 stop\n4 -30 2 1.6727 32.2\n5 inf 60\n");
  for (const char* assumed : {"columns", "index", "aperture"}) EXPECT_NE(warning(p, assumed), "no warning") << assumed;
  EXPECT_NE(warning(p, "stop"), "no warning");
}

TEST(Table, GlassesHaveNames) {
  const std::vector<std::string> tables = {
      "22.01359 3.25896 SK16 9\n-435.76044 6.00755 air 9\n-22.21328 0.99997 F2 5\n20.29192 4.75041 - 5\n"
      "79.6836 2.95208 SK16 8\n-18.39533 42.20778 - 8\n",
      "22.01359 3.25896 SK16 9\n-435.76044 6.00755 9\n-22.21328 0.99997 F2 5\n20.29192 4.75041 5\n"
      "79.6836 2.95208 SK16 8\n-18.39533 42.20778 8\n",
      "r d glass semi\n22.01359 3.25896 SK16 4.5\n-435.76044 6.00755 4.5\n-22.21328 0.99997 F2 2.5\n20.29192 4.75041 "
      "2.5\n"
      "79.6836 2.95208 SK16 4\n-18.39533 42.20778 4\n",
      "22.01359 3.25896 SK16 1.62041 60.3 9\n-435.76044 6.00755 - - - 9\n-22.21328 0.99997 F2 1.62004 36.4 5\n"
      "20.29192 4.75041 air 1 - 5\n79.6836 2.95208 SK16 1.62041 60.3 8\n-18.39533 42.20778 - - - 8\n",
      "22.01359 3.25896 1.62041 60.3 SK16\n-435.76044 6.00755\n-22.21328 0.99997 1.62004 36.4 F2\n20.29192 4.75041\n"
      "79.6836 2.95208 1.62041 60.3 SK16\n-18.39533 42.20778\n",
      "radius,thickness,material,catalogue\n22.01359,3.25896,SK16,schott\n-435.76044,6.00755\n-22.21328,0.99997,F2,"
      "schott\n"
      "20.29192,4.75041\n79.6836,2.95208,SK16,schott\n-18.39533,42.20778\n"};
  for (const std::string& text : tables) {
    SCOPED_TRACE(text);
    const Prescription p = read(text);
    ASSERT_EQ(p.surfaces.size(), 6u);
    for (const std::size_t glass : {0u, 4u}) EXPECT_EQ(p.surfaces[glass].medium.glass, "SK16");
    EXPECT_EQ(p.surfaces[2].medium.glass, "F2");
    for (const std::size_t air : {1u, 3u, 5u}) EXPECT_EQ(p.surfaces[air].medium, petzval::Medium{});
    EXPECT_NEAR(petzval::first_order(compile(p)).effective_focal_length, 50.0213, 1e-3);
    const bool rims = text.find("SK16 9") != std::string::npos || text.find(" 9\n") != std::string::npos ||
                      text.find(" 4.5") != std::string::npos;
    EXPECT_EQ(as_typed(p.surfaces)[0].semi_diameter, rims ? std::optional(4.5) : std::nullopt);
  }
  expect_tokens(refusal("50 5 NOGLASS9\n-50 90\n"), {"NOGLASS9"});
  // F2 of Schott and of CDGM are two glasses.
  expect_tokens(warning("50 5 F2\n-50 90\n", "F2"), {"cdgm"});
  EXPECT_NEAR(read("50 5 F2\n-50 90\n").surfaces[0].medium.nd.value(), 1.62004, 1e-5);
  EXPECT_NEAR(read("r d glass catalogue\n50 5 F2 cdgm\n-50 90 - -\n").surfaces[0].medium.nd.value(), 1.61293, 1e-5);
  EXPECT_EQ(warning("r d glass nd vd\n50 5 F2 1.62004 36.4\n-50 90 - 1 -\n", "F2"), "no warning");
  const Prescription code = read("r d glass\n50 5 517642\n-50 90 -\n");
  EXPECT_NEAR(petzval::first_order(compile(code)).effective_focal_length,
              petzval::first_order(compile(read("50 5 1.517 64.2\n-50 90\n"))).effective_focal_length, 1e-9);
  const Prescription mirror = read("r d glass\n-100 -50 mirror\n-50 40 refl\n");
  EXPECT_TRUE(mirror.surfaces[0].mirror && mirror.surfaces[1].mirror);
}

TEST(Table, FirstOfSeveralStopsIsUsed) {
  const Prescription p = read("r d nd semi\n50 5 1.5 9\n-50 2 1 9\nstop 1 1 5\nstop 90 1 6\n");
  EXPECT_TRUE(p.surfaces[2].stop);
  EXPECT_FALSE(p.surfaces[3].stop);
  EXPECT_NE(warning(p, "stop"), "no warning");
  // The stars mark aspheres, not the stop.
  const Prescription stars = read("r d nd semi note\n50 5 1.5 9 *\n-50 2 1 9 *\n0 90 1 5 -\n");
  EXPECT_TRUE(stars.surfaces[2].stop);
  EXPECT_NE(warning(stars, "*"), "no warning");
  EXPECT_TRUE(read("50 5 1.5168 18 stop\n-50 90 1 18\n").surfaces[0].stop);  // a stop on a lens
  EXPECT_TRUE(read("50 5 1.5168 18\n-50 90 1 18 diaphragm\n").surfaces[1].stop);
  // A stop inside glass has glass on both sides.
  EXPECT_EQ(read("r d nd semi\n50 5 1.5 9\nstop 2 - 5\n-50 90 1 9\n").surfaces[1].medium.nd, 1.5);
}

// Patents mark aspheres after the row number; only a separate mark of a plane may be the stop.
TEST(Table, AsphereMarks_BesideRowNumbers_AreNotTheStop) {
  const std::string rows =
      "no R d nd vd\n1 -46.6 3.78 1.5814 40.9\n2 40.4 7.54 1.7292 54.7\n3 -58.4 0.4 1 -\n4 32.4 1.6 1.8467 23.8\n"
      "5 24 5.4 1.768 49.2\n6 127.5 2.8 1 -\n7 inf 11 1 -\n8 -25.6 1.5 1.7 30\n9 30.5 5 1.77 49\n10 -40 30 1 -\n";
  const Prescription plain = read(rows);
  ASSERT_TRUE(plain.surfaces.at(6).stop);
  for (const char* mark : {"10(ASP)", "10 (ASP)", "10ASPH", "10 ASPHERE", "10*", "10 *", "*10", "10(ASPH)"}) {
    for (const bool headless : {false, true}) {
      const std::string text = with(rows, "10 -40", std::string(mark) + " -40");
      const Prescription p = read(headless ? with(text, "no R d nd vd\n", "") : text);
      EXPECT_EQ(p.surfaces, plain.surfaces) << mark;
      EXPECT_TRUE(std::ranges::any_of(p.imported->warnings, [](const auto& w) {
        return w.message.find("asphere") != std::string::npos;
      })) << mark;
    }
  }
  const Prescription both = read(with(with(rows, "3 -58.4", "3(ASP) -58.4"), "7 inf", "7(STO) inf"));
  EXPECT_EQ(both.surfaces, plain.surfaces);
  EXPECT_EQ(warning(both, "stop").find("second"), std::string::npos);
  // A mark that ends a row with a radius, and a mark that has a column of its own.
  EXPECT_TRUE(read("40 4 1.62041 60.3\n-300 5 - - ASP\n0 3\n-30 2 1.6727 32.2\n0 60\n").surfaces.at(2).stop);
  EXPECT_TRUE(read("r d nd stop\n50 5 1.5 -\n-50 90 1 ASP\n").surfaces.at(1).stop);
}

TEST(Table, NumbersOfFileNamesAreNotDeclared) {
  const std::string rows = "r d nd vd\n40 4 1.62041 60.3\n-300 5\nstop 3\n-30 2 1.6727 32.2\ninf 60\n";
  for (const char* name : {"nikon-50mm-f14.txt", "lens-f1p4.txt", "50mm_F1-4.txt", "85mmf18.txt", "lens_f1.4.txt"}) {
    const Prescription p = petzval::parse_lens(rows, name);
    EXPECT_FALSE(p.f_number) << name;
    EXPECT_FALSE(p.focal_length_mm) << name;
    EXPECT_EQ(as_typed(p.surfaces), as_typed(read(rows).surfaces)) << name;
  }
  const Prescription titled = read("# 50 mm f/4\nr d nd vd\n50 5 1.5168 64\n-50 1\nstop 45\n");
  expect_tokens(warning(titled, "stop"), {"f/4"});
  EXPECT_NEAR(petzval::real_f_number(compile(titled)), 4, 1e-6);
  // Rays of this beam miss a surface.
  const Prescription fast = read("# 50 mm f/0.6\nr d nd vd\n50 5 1.5168 64\n-50 1\nstop 45\n");
  expect_tokens(warning(fast, "stop"), {"does not set it"});
}

TEST(Table, KappaIsOneForASphere) {
  for (const char* head : {"kappa", "\u03ba", "Kappa"}) {
    const Prescription p = read(std::string("r d nd ") + head + " A4\n50 5 1.5 1 0\n-50 90 1 0.25 1e-6\n");
    EXPECT_EQ(p.surfaces.at(0).conic, 0) << head;
    EXPECT_EQ(p.surfaces.at(1).conic, -0.75) << head;
    EXPECT_NE(warning(p, head), "no warning");
  }
  EXPECT_EQ(read("r d nd k\n50 5 1.5 1\n-50 90 1 0.25\n").surfaces.at(1).conic, 0.25);
}

TEST(Table, FilmMayBeARow) {
  const Prescription lens = read("r d nd semi\n50 5 1.5 9\n-50 47.5 1 9\n0 0 1 12\n");
  EXPECT_EQ(lens.surfaces.size(), 2u);
  EXPECT_EQ(lens.surfaces[1].thickness, 47.5);
  EXPECT_NE(warning(lens, "row"), "no warning");
  // The last row is a stop, not the film.
  EXPECT_EQ(read("r d nd semi\n50 5 1.5 9\n-50 10 1 9\n0 0 1 5\n").surfaces.size(), 3u);
}

TEST(Table, AssumptionsAreReported) {
  const std::string plain = "50 5 1.5168 25\n-50 90 1 25\n";
  for (const char* assumed : {"columns", "aperture", "stop"})
    EXPECT_NE(warning(plain, assumed), "no warning") << assumed;
  const std::string headed = "r d nd semi\n50 5 1.5168 12\nstop 90 1 5\n";
  EXPECT_TRUE(read(headed).imported->warnings.empty()) << warning(headed, "aperture");
  EXPECT_NE(warning("r d nd aperture\n50 5 1.5168 25\n-50 90 1 25\n", "aperture"), "no warning");
  EXPECT_NE(warning("r d nd semi\n50 5 1.5168 12\nstop 90 1 -\n", "aperture"), "no warning");
  EXPECT_NE(warning("r;d;nd\n50;5;1,5168\n-50;90,5;1\n", "numbers"), "no warning");
}

/// A number as typed by hand; 0 is written as a random word for a plane.
std::string typed_radius(double radius, std::mt19937& random) {
  static const std::vector<std::string> planes = {"0", "inf", "Infinity", "plano", "flat", "\u221e", "-inf"};
  return radius != 0 ? petzval::testing::digits(radius) : planes[random() % planes.size()];
}

/// Any lens with exactly one stop: planes, air, cemented glasses; every number has few digits.
Prescription random_lens(std::mt19937& random) {
  const auto number = [&](double from, double to, double digits) {
    return std::round(std::uniform_real_distribution(from, to)(random) * digits) / digits;
  };
  Prescription p;
  const std::size_t count = 2 + random() % 12, stop = random() % count;
  for (std::size_t i = 0; i < count; ++i) {
    petzval::SurfaceRow row{.radius = random() % 4 == 0 ? 0 : (random() % 2 == 0 ? 1 : -1) * number(20, 500, 1000),
                            .thickness = number(0.5, 20, 100)};
    if (random() % 2 == 0 && i + 1 < count) row.medium = {.nd = number(1.45, 2, 1e5), .vd = number(20, 90, 10)};
    row.semi_diameter = number(3, 15, 100);
    row.stop = i == stop;
    p.surfaces.push_back(row);
  }
  return p;
}

/// A column of a table: its heads, and its cell in a row.
struct TypedColumn {
  std::vector<std::string> heads;
  std::function<std::string(const petzval::SurfaceRow&)> cell;
};

// With columns in any order, any separators, words for planes, rows for air and one stop, every row and number is read.
TEST(Table, LensIsIndependentOfTheOrderOfColumns) {
  std::mt19937 random(7);
  for (int i = 0; i < 600; ++i) {
    Prescription lens = random_lens(random);
    std::shuffle(lens.surfaces.begin(), lens.surfaces.end(), random);
    const std::vector<std::string> separators = {"  ", "\t", ",", " ; ", " | "};
    const std::string separator = separators[random() % separators.size()];
    const std::string none = separator == "  " || random() % 2 == 0 ? "-" : "";
    int row_number = 0;
    std::vector<TypedColumn> columns = {
        {{"r", "R", "Radius", "ROC", "radius(mm)"}, [&](const auto& row) { return typed_radius(row.radius, random); }},
        {{"d", "t", "TH", "thickness", "Distance"},
         [](const auto& row) { return petzval::testing::digits(row.thickness); }},
        {{"n", "nd", "n_d", "index", "IOR"},
         [&](const auto& row) {
           return row.medium.vd ? petzval::testing::digits(row.medium.nd.value_or(1)) : random() % 2 ? none : "1";
         }},
        {{"v", "vd", "V", "Abbe"},
         [&](const auto& row) {
           return row.medium.vd ? petzval::testing::digits(*row.medium.vd) : random() % 2 ? none : "0";
         }},
        {{"semi", "SD", "semi_diameter"}, [](const auto& row) { return petzval::testing::digits(*row.semi_diameter); }},
        {{"stop"}, [&](const auto& row) { return row.stop ? std::string("stop") : none; }},
    };
    if (random() % 2 == 0)
      columns[4] = {{"dia", "Diameter", "\u00d8"},
                    [](const auto& row) { return petzval::testing::digits(2 * *row.semi_diameter); }};
    if (random() % 2 == 0) {
      columns.push_back({{"no", "surf", "#"}, [&](const auto&) { return std::to_string(++row_number); }});
      if (columns.back().heads[0] != "no") row_number = 0;
    }
    std::shuffle(columns.begin(), columns.end(), random);
    std::string text;
    for (const TypedColumn& column : columns) {
      // A "#" in front of words begins a comment.
      const std::string head = column.heads[random() % column.heads.size()];
      const bool comment = head == "#" && (text.empty() || separator == "  ");
      text += (text.empty() ? "" : separator) + (comment ? "no" : head);
    }
    for (const auto& row : lens.surfaces) {
      std::string line;
      for (std::size_t c = 0; c < columns.size(); ++c) line += (c == 0 ? "" : separator) + columns[c].cell(row);
      text += '\n' + line;
    }
    SCOPED_TRACE(text);
    Prescription back;
    ASSERT_EQ(petzval::testing::message([&] { back = read(text + "\n"); }), "no error") << i;
    ASSERT_EQ(back.surfaces, lens.surfaces) << i;
  }
}

// Tables without column heads, as in patents and renderers.
TEST(Table, EveryRowWithoutHeadsIsASurface) {
  std::mt19937 random(8);
  for (int i = 0; i < 600; ++i) {
    Prescription lens = random_lens(random);
    const bool abbe = random() % 2 == 0, rims = random() % 2 == 0, labels = random() % 2 == 0;
    if (!abbe && !rims) continue;
    // The columns are distinct if there is a glass, and air in another row.
    auto& rows = lens.surfaces;
    rows.front().medium = {.nd = 1.5, .vd = 60};
    rows.front().stop = false;
    rows.back().stop = false;
    rows.back().medium = {};
    if (std::ranges::none_of(rows, &petzval::SurfaceRow::stop)) rows.front().stop = true;
    std::string text;
    int number = 0;
    for (petzval::SurfaceRow& row : rows) {
      const bool air = !row.medium.vd;
      if (!abbe) row.medium.vd.reset();
      if (!rims) row.semi_diameter.reset();
      std::string line = labels ? std::to_string(++number) + (random() % 5 == 0 ? "*  " : "  ") : "";
      line += typed_radius(row.radius, random) + ' ' + petzval::testing::digits(row.thickness);
      const bool brief = air && !rims && random() % 2 == 0;
      if (!brief) line += ' ' + (air ? "1" : petzval::testing::digits(row.medium.nd.value_or(1)));
      if (!brief && abbe) line += ' ' + (air ? (random() % 2 ? "0" : "-") : petzval::testing::digits(*row.medium.vd));
      if (rims) line += ' ' + petzval::testing::digits(2 * *row.semi_diameter);
      if (row.stop) line += random() % 2 ? " stop" : "  STO";
      text += line + '\n';
    }
    SCOPED_TRACE(text);
    Prescription back;
    ASSERT_EQ(petzval::testing::message([&] { back = read(text); }), "no error") << i;
    ASSERT_EQ(as_typed(back.surfaces), rows) << i;
  }
}

// Lenses of data/, typed as tables, are equal.
TEST(Table, LensesOfTheDataRoundTripAsTables) {
  int compared = 0;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const auto refused = [](const petzval::SurfaceRow& row) {
      return row.mirror || row.curved_in != petzval::Section::both || row.obscuration_semi_diameter.value_or(0) > 0;
    };
    if (std::ranges::any_of(p.surfaces, refused) || !(p.object_space == petzval::Medium{})) continue;
    std::vector<int> orders;
    for (const auto& row : p.surfaces) {
      for (const auto& term : row.aspheric) {
        if (std::ranges::find(orders, term.order) == orders.end()) orders.push_back(term.order);
      }
    }
    std::string text = "no,radius,thickness,nd,vd,semi,k";
    for (const int order : orders) text += ",A" + std::to_string(order);
    for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
      const auto& row = p.surfaces[i];
      const auto optional = [](const std::optional<double>& value) {
        return value && *value != 0 ? petzval::testing::digits(*value) : std::string();
      };
      text += '\n' + (row.stop ? "stop" : std::to_string(i)) + ',' + petzval::testing::digits(row.radius) + ',' +
              petzval::testing::digits(row.thickness) + ',' + petzval::testing::digits(row.medium.nd.value_or(1)) +
              ',' + optional(row.medium.vd) + ',' + optional(row.semi_diameter) + ',' +
              petzval::testing::digits(row.conic);
      for (const int order : orders) {
        const auto term = std::ranges::find(row.aspheric, order, &petzval::AsphereTerm::order);
        text += ',' + (term == row.aspheric.end() ? "" : petzval::testing::digits(term->coefficient));
      }
    }
    const Prescription back = read(text + '\n');
    ASSERT_EQ(back.surfaces.size(), p.surfaces.size()) << p.id;
    Prescription plain = p;  // without the names of glasses, and terms in the order of the columns
    plain.configurations.clear();
    const auto focal_length = [](const Prescription& lens) {
      return petzval::first_order(compile(lens)).effective_focal_length;
    };
    EXPECT_NEAR(focal_length(back) / focal_length(plain), 1, 1e-9) << p.id;
    for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
      EXPECT_EQ(back.surfaces[i].radius, p.surfaces[i].radius) << p.id;
      EXPECT_EQ(back.surfaces[i].semi_diameter, p.surfaces[i].semi_diameter) << p.id;
      EXPECT_EQ(back.surfaces[i].stop, p.surfaces[i].stop) << p.id << ' ' << i;
      EXPECT_EQ(back.surfaces[i].conic, p.surfaces[i].conic) << p.id;
      EXPECT_EQ(back.surfaces[i].aspheric.size(), p.surfaces[i].aspheric.size()) << p.id;
    }
    ++compared;
  }
  EXPECT_GE(compared, 55);
}

// The example of data/README.md: the first indented block after the heading.
TEST(Table, ExampleOfTheManualIsTheCookeTriplet) {
  std::ifstream file(std::filesystem::path(PETZVAL_TEST_DATA) / "README.md");
  std::string text, line;
  while (std::getline(file, line) && line != "## Lenses as tables") continue;
  while (std::getline(file, line) && line.substr(0, 3) != "## ") {
    if (line.starts_with("    ")) text += line.substr(4) + '\n';
  }
  const Prescription p = read(text);
  ASSERT_EQ(p.surfaces.size(), 6u) << text;
  EXPECT_EQ(p.f_number, 5);
  EXPECT_TRUE(p.surfaces[3].stop);
  EXPECT_NEAR(petzval::first_order(compile(p)).effective_focal_length, 50.0213, 1e-4);
}

}  // namespace table_test
