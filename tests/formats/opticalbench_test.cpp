// SPDX-License-Identifier: Apache-2.0
// Tables of Photons to Photos.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "said.hpp"

namespace opticalbench_test {

using petzval::AsphereTerm;
using petzval::parse_lens;
using petzval::testing::expect_error;
using petzval::testing::expect_said;
using petzval::testing::expect_tokens;
using petzval::testing::message;
using petzval::testing::read_sample;
using petzval::testing::said;
using petzval::testing::with;
using Said = std::vector<std::string>;

TEST(OpticalBench, ZoomHasItsFocalLengthInEachPosition) {
  const auto lens = read_sample("opticalbench_zoom.txt");
  EXPECT_EQ(lens.imported->format, "opticalbench");
  EXPECT_EQ(lens.name, "Zoom 70-210 mm f/4");
  EXPECT_EQ(lens.imported->notes, Said{"The stop is estimated."});
  EXPECT_TRUE(said(lens).empty());
  ASSERT_EQ(lens.configurations.size(), 3u);
  const std::vector<double> focal_lengths = {70.55, 137.04, 205.31};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lens.configurations[i].name, std::vector<std::string>({"70.55 mm", "137.04 mm", "205.31 mm"})[i]);
    EXPECT_FALSE(lens.configurations[i].focus_of.has_value());
    EXPECT_EQ(lens.configurations[i].focal_length_mm, focal_lengths[i]);
    const auto compiled = compile(configured(lens, static_cast<double>(i)));
    EXPECT_NEAR(first_order(compiled).effective_focal_length, focal_lengths[i],
                3e-4 * focal_lengths[i]);  // rounding of the patent
    EXPECT_NEAR(real_f_number(compiled), 4.0, 1e-4);
  }
  EXPECT_TRUE(lens.configurations[0].changes.empty());
  EXPECT_EQ(lens.configurations[2].changes.size(), 5u);  // four distances and the stop
  EXPECT_EQ(lens.image_diagonal_mm, 43.27);
  EXPECT_EQ(lens.half_field_deg, 34.1 / 2);
}

TEST(OpticalBench, EveryWordOfTheFormIsReadOrReported) {
  const auto lens = read_sample("opticalbench_macro.txt");
  EXPECT_EQ(lens.name, "Two groups that focus");
  EXPECT_EQ(lens.focal_length_mm, 100);
  EXPECT_EQ(lens.f_number, 4);
  EXPECT_EQ(lens.half_field_deg, 10);
  EXPECT_EQ(lens.imported->notes, (Said{"patent none", "Some words.", "number 0"}));
  ASSERT_EQ(lens.surfaces.size(), 9u);
  const auto& s = lens.surfaces;
  EXPECT_EQ(s[0].radius, 60);
  EXPECT_EQ(s[0].semi_diameter, 15);
  EXPECT_EQ(s[0].medium.glass, "N-BK7");
  EXPECT_EQ(s[0].medium.catalogue, "schott");
  EXPECT_EQ(s[1].medium.glass, "F2");
  EXPECT_EQ(s[2].radius, 0);
  EXPECT_EQ(s[3].comment, "field stop");
  EXPECT_FALSE(s[3].semi_diameter);
  EXPECT_EQ(s[3].thickness, 10);
  EXPECT_TRUE(s[4].stop);
  EXPECT_EQ(s[4].semi_diameter, 10);
  EXPECT_EQ(s[5].medium, (petzval::Medium{.nd = 1.6, .vd = 50}));
  EXPECT_EQ(s[6].medium, petzval::Medium{});
  EXPECT_EQ(s[7].comment, "cover glass");
  EXPECT_EQ(s[8].thickness, 70);
  // One odd power: 3, then 4, 6, 8.
  EXPECT_EQ(s[0].conic, 0.5);
  EXPECT_EQ(s[0].aspheric, (std::vector<AsphereTerm>{{3, 1e-7}, {4, -2e-6}, {6, 3e-9}}));
  EXPECT_EQ(s[5].aspheric, (std::vector<AsphereTerm>{{6, 4e-12}}));
  expect_said(said(lens), {{"7 Unknown", "unknown"},
                           {"30 6", "asphere", -200.5, -200},
                           {"16 d9", "surface"},
                           {"0 f_number", "f-number", 4.50026, 4}});
  ASSERT_EQ(lens.configurations.size(), 3u);
  EXPECT_EQ(lens.configurations[0].name, "far");
  EXPECT_EQ(lens.configurations[1].name, "near");
  EXPECT_EQ(lens.configurations[1].focus_of, "far");
  EXPECT_EQ(lens.configurations[1].subject_distance_mm, 1100);
  EXPECT_EQ(lens.configurations[1].changes.size(), 2u);
  EXPECT_EQ(lens.configurations[2].focus_of, "far");
}

// A position with a magnification only is focused to this magnification.
TEST(OpticalBench, MagnificationGivesTheSubject) {
  const auto lens = read_sample("opticalbench_macro.txt");
  const auto& near = lens.configurations.at(2);
  petzval::Prescription rows = lens;
  for (const auto& change : near.changes) {
    rows.surfaces[static_cast<std::size_t>(change.surface)].thickness = change.thickness.value();
  }
  rows.configurations.clear();
  const auto first = first_order(compile(rows));
  // Newton: the subject is f / m in front of the front focal point.
  EXPECT_NEAR(*near.subject_distance_mm - first.effective_focal_length / 0.2,
              first.effective_focal_length - first.front_principal_z, 1e-9);
}

const std::string plain =
    "[descriptive data]\ntitle\tplain\n[variable distances]\nFocal Length\t100\nF-Number\t5\nd2\t97\n[lens data]\n"
    "1\tAS\t1\t\t20\n2\t50\t5\t1.5\t30\t60\n3\tInfinity\td2\t\t30\n[aspherical data]\n2\t50\t0\t1\t2\t3\t4\t5\n";

// A continuous zoom states hundreds of positions.
TEST(OpticalBench, EightHundredPositionsAreRead) {
  std::string focal_lengths = "Focal Length", f_numbers = "F-Number", distances = "d2";
  for (int i = 0; i < 800; ++i) {
    focal_lengths += '\t' + std::to_string(100 + i);
    f_numbers += "\t5", distances += '\t' + std::to_string(97 + i);
  }
  const std::string text =
      with(with(with(plain, "Focal Length\t100", focal_lengths), "F-Number\t5", f_numbers), "d2\t97", distances);
  const auto lens = parse_lens(text, "x.txt");
  ASSERT_EQ(lens.configurations.size(), 800u);
  EXPECT_EQ(lens.configurations[799].focal_length_mm, 899);
  EXPECT_EQ(configured(lens, 799).surfaces[2].thickness, 97 + 799);
}

std::vector<int> orders(const std::string& constant) {
  const auto lens = parse_lens(with(plain, "[variable", "[constants]\n" + constant + "\n[variable"), "x.txt");
  std::vector<int> result;
  for (const auto& term : lens.surfaces[1].aspheric) {
    EXPECT_EQ(term.coefficient, static_cast<double>(result.size() + 1));
    result.push_back(term.order);
  }
  return result;
}

TEST(OpticalBench, ConstantsGiveThePowersOfCoefficients) {
  using Orders = std::vector<int>;
  EXPECT_EQ(orders(""), (Orders{4, 6, 8, 10, 12}));
  EXPECT_EQ(orders("AsphericalA2"), (Orders{2, 4, 6, 8, 10}));
  EXPECT_EQ(orders("AsphericalOddCount\t0"), (Orders{4, 6, 8, 10, 12}));
  EXPECT_EQ(orders("AsphericalOddCount\t1"), (Orders{3, 4, 6, 8, 10}));
  EXPECT_EQ(orders("AsphericalOddCount\t2"), (Orders{3, 4, 5, 6, 8}));
  EXPECT_EQ(orders("AsphericalOddCount\t20"), (Orders{3, 4, 5, 6, 7}));
}

TEST(OpticalBench, PlanesHaveASignAndLinesHaveComments) {
  const auto lens = parse_lens(plain, "x.txt");
  for (const char* word : {"-Infinity", "+Infinity", "inf"}) {
    EXPECT_EQ(parse_lens(with(plain, "3\tInfinity", "3\t" + std::string(word)), "x.txt"), lens) << word;
  }
  const std::string commented = with(with(plain, "1\tAS", "// a comment\n1\tAS"), "d2\t97\n", "d2\t97 // mm\n");
  EXPECT_EQ(parse_lens(commented, "x.txt"), lens);
  EXPECT_EQ(parse_lens(with(plain, "title\tplain", "title\thttps://x"), "x.txt").imported->title, "https://x");
}

TEST(OpticalBench, OnePositionGivesNoConfigurations) {
  const auto lens = parse_lens(plain, "x.txt");
  EXPECT_TRUE(lens.configurations.empty());
  EXPECT_TRUE(said(lens).empty());
  EXPECT_EQ(lens.surfaces[2].thickness, 97);
}

TEST(OpticalBench, UnknownFilmIsPlacedAtTheFocus) {
  auto lens = parse_lens(with(plain, "d2\t97", "d2\tundefined"), "x.txt");
  EXPECT_NEAR(lens.surfaces[2].thickness, 100 - 5 / 1.5 + 5 * (1 - 1 / 1.0), 1e-9);
  ASSERT_EQ(said(lens).size(), 1u);
  EXPECT_EQ(lens.imported->warnings[0].line, 10);
  expect_tokens(said(lens)[0], {96.66667});
  lens = parse_lens(with(plain, "3\tInfinity\td2", "3\tInfinity\t"), "x.txt");
  EXPECT_NEAR(lens.surfaces[2].thickness, 96.66667, 1e-5);
}

TEST(OpticalBench, EachPositionHasItsOwnUnknownFilm) {
  const auto lens = parse_lens(
      "[descriptive data]\n[variable distances]\nd2\t10\t20\t30\nBf\tundefined\t60\tundefined\n[lens data]\n"
      "1\tAS\t1\t\t9\n2\t50\td2\t\t30\n3\t40\t5\t1.5\t30\t60\n4\tInfinity\tBf\t\t30\n",
      "x.txt");
  ASSERT_EQ(lens.configurations.size(), 3u);
  EXPECT_EQ(configured(lens, 1).surfaces.back().thickness, 60);
  for (const int position : {0, 2}) {
    const petzval::Prescription rows = configured(lens, position);
    EXPECT_NEAR(rows.surfaces.back().thickness, first_order(petzval::compile(rows)).back_focal_distance, 1e-9);
  }
  EXPECT_EQ(std::ranges::count(lens.imported->warnings, "thickness", &petzval::ImportWarning::command), 2);
}

// Two zoom positions with two focus settings each; near settings are named by their distances.
TEST(OpticalBench, NearPositionsFocusTheirZoomPosition) {
  const auto lens = parse_lens(
      "[descriptive data]\n[variable distances]\nFocal Length\t50\t70\n"
      "d0\tInfinity\tInfinity\t900\t300\t900\nd2\t10\t20\t20.5\t9\t11\nBf\t60\t80\t81\t62\t61\n[lens data]\n"
      "1\tAS\t1\t\t9\n2\t50\td2\t\t30\n3\t40\t5\t1.5\t30\t60\n4\tInfinity\tBf\t\t30\n",
      "x.txt");
  ASSERT_EQ(lens.configurations.size(), 5u);
  Said names;
  for (const auto& c : lens.configurations) names.push_back(c.name + " < " + c.focus_of.value_or("-"));
  EXPECT_EQ(names, (Said{"50 mm < -", "70 mm < -", "70 mm at 900 mm < 70 mm", "50 mm at 300 mm < 50 mm",
                         "50 mm at 900 mm < 50 mm"}));
  EXPECT_EQ(said(lens).size(), 4u);  // the focal length is declared only
  expect_tokens(said(lens)[0], {"4 d0", "position", 900, 70});
}

TEST(OpticalBench, PositionsWithoutDistancesAreSkipped) {
  const auto lens = parse_lens(
      "[descriptive data]\n[variable distances]\nd2\t10\tundefined\nBf\t60\t80\n[lens data]\n"
      "1\tAS\t1\t\t9\n2\t50\td2\t\t30\n3\t40\t5\t1.5\t30\t60\n4\tInfinity\tBf\t\t30\n",
      "x.txt");
  EXPECT_TRUE(lens.configurations.empty());
  expect_tokens(said(lens).at(0), {0, "variable", "column", 2, "state"});
}

TEST(OpticalBench, RefusesLensesWithoutDistancesOrFocus) {
  const auto refusal = [](const std::string& text) { return message([&] { parse_lens(text, "x.txt"); }); };
  expect_tokens(refusal(with(with(plain, "\t5\t1.5", "\td1\t1.5"), "d2\t97", "d1\tundefined\nd2\t97")),
                {"x.txt", "variable distances"});
  const std::string afocal =
      with(with(plain, "2\t50\t5", "2\tInfinity\t5"), "[aspherical data]\n2\t50\t0\t1\t2\t3\t4\t5\n", "");
  expect_tokens(refusal(with(afocal, "d2\t97", "d2\tundefined")), {"x.txt", "line 10", "thickness"});
}

TEST(OpticalBench, InvalidInputIsRefusedWithItsLine) {
  const auto refusal = [](std::string_view old, std::string_view text) {
    return message([&] { parse_lens(with(plain, old, text), "x.txt"); });
  };
  expect_tokens(refusal("50\t5\t1.5", "5x\t5\t1.5"), {"x.txt", "line 9", "radius", "\"5x\""});
  expect_tokens(refusal("50\t5\t1.5", "50\t5\t1,5"), {"x.txt", "line 9", "index", "\"1,5\""});
  expect_tokens(refusal("50\t5\t1.5", "50\t5\t-1"), {"x.txt", "line 9", "index", -1});
  expect_tokens(refusal("50\t5\t1.5", "50\t1e400\t1.5"), {"x.txt", "line 9", "thickness", "\"1e400\""});
  expect_tokens(refusal("50\t5\t1.5", "50\td7\t1.5"), {"x.txt", "line 9", "thickness", "\"d7\""});
  expect_tokens(refusal("50\t5\t1.5", "50\t\t1.5"), {"x.txt", "line 9", "thickness"});
  expect_tokens(refusal("2\t50\t5", "1\t50\t5"), {"x.txt", "line 9", "row", 1});
  expect_tokens(refusal("2\t50\t5\t1.5\t30\t60", "2 50 5 1.5 30 60"), {"x.txt", "line 9", "row", 1});
  expect_tokens(refusal("2\t50\t0\t1", "9\t50\t0\t1"), {"x.txt", "line 12", "asphere", "\"9\""});
  expect_tokens(refusal("2\t50\t0\t1\t2\t3\t4\t5", "2\t50"), {"x.txt", "line 12", "asphere", 2});
  expect_tokens(refusal("d2\t97", "d2\tnan"), {"x.txt", "line 6", "value", "\"nan\""});
  expect_tokens(refusal("d2\t97", "d2\t97\nd2\t98"), {"x.txt", "line 7", "d2"});
  expect_tokens(refusal("[variable", "[constants]\nAsphericalOddCount\t1.5\n[variable"),
                {"x.txt", "line 4", "AsphericalOddCount", 1.5});
  expect_error([] { parse_lens("[lens data]\n", "x.txt"); }, {"x.txt", "rows"});
  expect_error([] { parse_lens("[lens data]\n1" + std::string(2000, '\t') + "5\n", "x.txt"); },
               {"x.txt", "line 2", "line", 1001});
}

}  // namespace opticalbench_test
