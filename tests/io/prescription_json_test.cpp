// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lens_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../message.hpp"
#include "../positioned.hpp"

namespace {

namespace fs = std::filesystem;
using petzval::format_prescription;
using petzval::parse_prescription;
using petzval::Prescription;
using petzval::testing::message;
using petzval::testing::positioned;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<fs::path> lens_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(PETZVAL_TEST_DATA) / "lenses"))
    files.push_back(entry.path());
  return files;
}

const std::string head = R"({"format": "petzval-lens 1", )";
const std::string row = R"({"radius": 50, "thickness": 5.5, "nd": 1.5})";

/// A lens file with these members and the format.
std::string file(const std::string& members) { return head + members + "}"; }
/// A lens of one valid surface and this one.
std::string with_surface(const std::string& surface) { return file("\"surfaces\": [" + row + ", " + surface + "]"); }
/// The same with one member added to a valid surface.
std::string with_member(const std::string& member) {
  return with_surface(R"({"radius": 50, "thickness": 5.5, "nd": 1.5, )" + member + "}");
}

std::string refusal(const std::string& text) {
  return message([&] { parse_prescription(text, "x.json"); });
}

TEST(PrescriptionJson, EveryLensOfTheDataIsWrittenBackByteForByte) {
  const auto files = lens_files();
  EXPECT_EQ(files.size(), 70u);
  for (const auto& lens : files)
    EXPECT_EQ(format_prescription(petzval::read_prescription(lens)), text_of(lens)) << lens;
}

TEST(PrescriptionJson, SaysWhatTheFileSays) {
  const auto lens =
      petzval::read_prescription(fs::path(PETZVAL_TEST_DATA) / "lenses" / "catadioptric_mangin_1000mm_f7.5.json");
  EXPECT_EQ(lens.id, "catadioptric_mangin_1000mm_f7.5");
  EXPECT_EQ(lens.source_design, "US 5,331,467, example 1");
  EXPECT_EQ(lens.focal_length_mm, 1000);
  EXPECT_FALSE(lens.image_diagonal_mm);
  EXPECT_EQ(lens.glass_names, "source (nearest modern glasses)");
  ASSERT_EQ(lens.surfaces.size(), 24u);
  EXPECT_EQ(lens.surfaces[1].obscuration_semi_diameter, 25);
  EXPECT_EQ(lens.surfaces[3].thickness, -15);
  EXPECT_TRUE(lens.surfaces[3].mirror && lens.surfaces[3].stop);
  EXPECT_EQ(lens.surfaces[8].medium.catalogue, "hikari");
  const auto zoom = petzval::read_prescription(fs::path(PETZVAL_TEST_DATA) / "lenses" / "zoom_14-30mm_f4.json");
  ASSERT_EQ(zoom.configurations.size(), 3u);
  EXPECT_EQ(zoom.configurations[1].name, "middle");
  EXPECT_EQ(zoom.configurations[1].focal_length_mm, 20);
  EXPECT_EQ(zoom.configurations[1].changes[0], (petzval::SurfaceChange{.surface = 7, .thickness = 12.942}));
  EXPECT_EQ(zoom.surfaces[1].aspheric[2], (petzval::AsphereTerm{8, 6.9126e-11}));
}

/// A double of any size that a lens may have.
double random_number(std::mt19937_64& random, double smallest, double largest) {
  std::uniform_real_distribution<double> exponent(std::log(smallest), std::log(largest));
  const double value = std::exp(exponent(random));
  return random() % 2 == 0 ? value : -value;
}

Prescription random_prescription(std::mt19937_64& random) {
  const auto often = [&] { return random() % 2 == 0; };
  const auto length = [&] { return random_number(random, 1e-9, 1e9); };
  const std::vector<std::string> texts = {"",
                                          "plain",
                                          "quote \" backslash \\ slash /",
                                          "tab\tline\nreturn\r",
                                          "\x01\x1f\x7f",
                                          "\u00b5 \u00e9 \u4f60 \U0001F4F7",
                                          "null"};
  const auto text = [&] { return texts[random() % texts.size()]; };
  const auto maybe_text = [&]() -> std::optional<std::string> {
    return often() ? std::optional(text()) : std::nullopt;
  };
  const auto maybe = [&]() -> std::optional<double> {
    return often() ? std::optional(std::abs(length())) : std::nullopt;
  };
  const auto medium = [&] {
    petzval::Medium m;
    m.glass = maybe_text();
    if (m.glass) m.catalogue = maybe_text();
    if (m.glass) m.glass_origin = maybe_text();
    if (!m.glass || often()) m.nd = 1 + 4 * std::generate_canonical<double, 53>(random);
    m.vd = often() ? maybe() : std::optional(0.0);
    return m;
  };

  Prescription p;
  p.id = text(), p.name = text(), p.source_design = text(), p.source_numbers = text();
  p.focal_length_mm = maybe(), p.f_number = maybe(), p.half_field_deg = maybe(), p.image_diagonal_mm = maybe();
  p.reference_wavelength_nm = 400 + std::generate_canonical<double, 53>(random);
  p.semi_diameters = maybe_text(), p.stop_size = maybe_text(), p.image_distance = maybe_text();
  p.glass_names = maybe_text(), p.notes = maybe_text();
  for (auto i = random() % 3; i > 0; --i) p.aliases.push_back(text());
  if (often()) p.object_space = medium();
  for (auto i = 1 + random() % 5; i > 0; --i) {
    petzval::SurfaceRow s;
    s.radius = often() ? length() : often() ? 0.0 : -0.0;
    s.thickness = often() ? length() : static_cast<double>(random() % 1000000);
    s.mirror = random() % 4 == 0;
    s.medium = !s.mirror ? medium() : p.surfaces.empty() ? p.object_space : p.surfaces.back().medium;
    s.semi_diameter = maybe();
    if (s.semi_diameter && often()) s.obscuration_semi_diameter = *s.semi_diameter / 3;
    s.conic = often() ? 0 : length();
    for (int order = 2; order <= 40 && often(); ++order) {
      // A slope of 1 within 1e-12 mm is refused.
      const double largest = std::min(1e300, std::pow(1e11, order - 1) / order);
      s.aspheric.push_back({order, random_number(random, 1e-300, largest)});
    }
    s.stop = often();
    s.curved_in = often() ? petzval::Section::both : often() ? petzval::Section::x : petzval::Section::y;
    p.surfaces.push_back(s);
  }
  if (often()) {
    p.imported = petzval::FileOrigin{
        "zemax", text(), "in", text(), {text(), text()}, {{7, text(), text()}, {0, text(), ""}}, text()};
  }
  if (often()) {
    p.design.aperture = {petzval::ApertureSetting::image_na, 0.25};
    if (often()) p.design.object_distance_mm = length();
    p.design.field_kind = petzval::FieldKind::paraxial_image;
    p.design.fields = {{.x = length(), .y = 2, .compress_y = 0.25}, {.decentre_x = length(), .angle_deg = 5}};
    p.design.wavelengths = {{500, 2}, {600.5, 1}};
    p.design.primary_wavelength = 1;
  }
  for (int i = 0; i < 3 && often(); ++i) {
    petzval::Configuration c{.name = std::to_string(i) + text()};
    if (i > 0 && often()) c.focus_of = p.configurations[0].name;
    if (often()) c.subject_distance_mm = std::abs(length());
    if (often()) c.stop = 0;
    c.focal_length_mm = maybe(), c.f_number = maybe();
    c.changes = {{.surface = 0, .thickness = length()}};
    if (often()) c.changes[0].radius = length(), c.changes[0].conic = length();
    p.configurations.push_back(c);
  }
  return p;
}

TEST(PrescriptionJson, AnyLensComesBackAsItWas) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Prescription p = random_prescription(random);
    const std::string text = format_prescription(p);
    const Prescription back = parse_prescription(text, "x.json");
    ASSERT_EQ(back, p) << text;
    ASSERT_EQ(format_prescription(back), text);
  }
}

TEST(PrescriptionJson, NumbersAreTheShortestThatReadBack) {
  Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  const auto written = [&p](double radius) {
    p.surfaces[0].radius = radius;
    const std::string text = format_prescription(p);
    const auto from = text.find("\"radius\": ") + 10;
    return text.substr(from, text.find(',', from) - from);
  };
  const std::vector<std::pair<double, std::string>> numbers = {{0, "0.0"},
                                                               {-0.0, "-0.0"},
                                                               {100000, "100000.0"},
                                                               {1e15, "1000000000000000.0"},
                                                               {1e16, "1e+16"},
                                                               {1e22, "1e+22"},
                                                               {0.1, "0.1"},
                                                               {0.1 + 0.2, "0.30000000000000004"},
                                                               {1e-4, "0.0001"},
                                                               {1e-5, "1e-05"},
                                                               {-1.33157e-5, "-1.33157e-05"},
                                                               {206.96100000000004, "206.96100000000004"},
                                                               {1.7976931348623157e308, "1.7976931348623157e+308"}};
  for (const auto& [value, text] : numbers) EXPECT_EQ(written(value), text);
}

TEST(PrescriptionJson, UnlimitedAperturesAreWrittenAsNone) {
  Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  p.surfaces[0].semi_diameter = std::numeric_limits<double>::infinity();
  EXPECT_NE(format_prescription(p).find("\"semi_diameter\": null"), std::string::npos);
}

TEST(PrescriptionJson, WhatCannotBeReadIsNotWritten) {
  Prescription p;
  p.name = "empty";
  EXPECT_EQ(message([&] { format_prescription(p); }), "empty: no surfaces, wanted at least one");
  p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  p.surfaces[0].thickness = std::nan("");
  EXPECT_EQ(message([&] { format_prescription(p); }),
            "lens: surface 0: thickness is nan, wanted a finite length below 1e10 mm");
  p.surfaces[0].thickness = 0;
  p.notes = "\xb5m";  // Latin-1
  EXPECT_EQ(message([&] { format_prescription(p); }), "a string of the lens is not UTF-8, wanted UTF-8 to write JSON");
}

TEST(PrescriptionJson, FilesThatCannotBeOpenedAreNamed) {
  const fs::path folder = ::testing::TempDir();
  const std::string absent = (folder / "no such folder" / "lens.json").string();
  EXPECT_EQ(message([&] { petzval::read_prescription(absent); }),
            absent + ": cannot be opened (No such file or directory); must be a lens file");
  EXPECT_EQ(message([&] { petzval::read_prescription(folder); }),
            folder.string() + ": is a folder, wanted a lens file");
  const Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  EXPECT_EQ(message([&] { petzval::write_prescription(p, absent); }),
            absent + ": cannot be written (No such file or directory), wanted an existing, writable folder with space");
  const fs::path written = folder / "petzval_written.json";
  petzval::write_prescription(p, written);
  EXPECT_EQ(petzval::read_prescription(written), p);
  fs::remove(written);
}

TEST(PrescriptionJson, SpaceByteOrderMarkAndLineEndsDoNotMatter) {
  const fs::path lens = fs::path(PETZVAL_TEST_DATA) / "lenses" / "compact_31mm_f2.1.json";
  const std::string text = text_of(lens);
  const Prescription p = parse_prescription(text, "x.json");
  const auto with = [&](const std::string& end, const std::string& before) {
    std::string changed = before;
    for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
    return changed;
  };
  EXPECT_EQ(parse_prescription(with("\r\n", ""), "x.json"), p);
  EXPECT_EQ(parse_prescription(with("\r", ""), "x.json"), p);
  EXPECT_EQ(parse_prescription(with("\t \n", ""), "x.json"), p);
  EXPECT_EQ(parse_prescription(with("", ""), "x.json"), p);
  EXPECT_EQ(parse_prescription(with("\n", "\xEF\xBB\xBF"), "x.json"), p);
  EXPECT_EQ(parse_prescription(std::string(1'000'000, ' ') + text, "x.json"), p);
}

TEST(PrescriptionJson, MembersMayBeLeftOutButNotTheSurfaceItself) {
  const Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  petzval::Prescription expected;
  expected.surfaces = {{.radius = 50, .thickness = 5.5, .medium = {.nd = 1.5}}};
  EXPECT_EQ(p, expected);
  // Without nd a medium is air, or the glass that it names.
  const auto medium = [](const std::string& members) {
    const std::string row_of = R"({"radius": 5, "thickness": 1)" + members + "}";
    return parse_prescription(with_surface(row_of), "x.json").surfaces[1].medium;
  };
  EXPECT_TRUE(medium("").is_air());
  EXPECT_TRUE(medium(R"(, "glass": null, "nd": null)").is_air());
  EXPECT_EQ(medium(R"(, "glass": "N-BK7")"), petzval::Medium{.glass = "N-BK7"});
  EXPECT_EQ(medium(R"(, "nd": 2.4, "vd": 0)"), (petzval::Medium{.nd = 2.4, .vd = 0}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": 5, "thickness": 1, "vd": 60})")), "x.json",
                         {"surface 1", "vd = 60"}));
  EXPECT_TRUE(positioned(refusal("{}"), "x.json", {"key \"format\"", "missing"}));
  EXPECT_TRUE(positioned(refusal(file("\"id\": \"a\"")), "x.json", {"key \"surfaces\"", "missing"}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"thickness": 5, "nd": 1})")), "x.json",
                         {"surface 1", "key \"radius\"", "missing"}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": 5, "nd": 1})")), "x.json",
                         {"surface 1", "key \"thickness\"", "missing"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("aspheric": [{"order": 4}])")), "x.json",
                         {"surface 1", "aspheric 0", "key \"coefficient\"", "missing"}));
  EXPECT_TRUE(positioned(refusal(file("\"surfaces\": []")), "x.json", {"no surfaces"}));
}

TEST(PrescriptionJson, ValuesOfTheWrongKindAreNamed) {
  EXPECT_TRUE(positioned(refusal(R"({"format": "petzval-lens 2"})"), "x.json", {"format", "\"petzval-lens 2\""}));
  EXPECT_TRUE(positioned(refusal("[]"), "x.json", {"document", "a list"}));
  EXPECT_TRUE(positioned(refusal("7"), "x.json", {"document", "7"}));
  EXPECT_TRUE(positioned(refusal("\"text\""), "x.json", {"document", "\"text\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("name": 5)")), "x.json", {"name", "5"}));
  EXPECT_TRUE(positioned(refusal(file(R"("name": null)")), "x.json", {"name", "null"}));
  EXPECT_TRUE(positioned(refusal(file(R"("name": ["a"])")), "x.json", {"name", "a list"}));
  EXPECT_TRUE(positioned(refusal(file(R"("source": "a book")")), "x.json", {"source", "\"a book\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("source": [])")), "x.json", {"source", "a list"}));
  EXPECT_TRUE(positioned(refusal(file(R"("source": {"design": 1})")), "x.json", {"source", "design", "1"}));
  EXPECT_TRUE(positioned(refusal(file(R"("aliases": ["a", 2])")), "x.json", {"aliases", "2"}));
  EXPECT_TRUE(positioned(refusal(file(R"("aliases": [{}])")), "x.json", {"aliases", "an object"}));
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"position": "wide", "variable_gaps": {"3": "5"}})")), "x.json",
                         {"zoom", "variable_gaps", "\"5\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("design": {"field_kind": "degrees"})")), "x.json",
                         {"design", "field_kind", "\"degrees\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("configurations": [{"name": "a", "changes": [{"surface": -1}]}])")), "x.json",
                         {"configuration 0", "change 0", "surface", "-1"}));
  EXPECT_TRUE(positioned(refusal(file(R"("configurations": [{"name": "a"}], "zoom": {"position": "b"})")), "x.json",
                         {"\"zoom\" beside \"configurations\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"variable_gaps": {"03": 5}})")), "x.json",
                         {"zoom", "variable_gaps", "key \"03\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("surfaces": {})")), "x.json", {"surfaces", "an object"}));
  EXPECT_TRUE(positioned(refusal(file(R"("surfaces": [5])")), "x.json", {"surface 0", "5"}));
  EXPECT_TRUE(positioned(refusal(with_surface("[]")), "x.json", {"surface 1", "a list"}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": "50"})")), "x.json", {"surface 1", "radius", "\"50\""}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": "1,5"})")), "x.json", {"surface 1", "radius", "\"1,5\""}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": null})")), "x.json", {"surface 1", "radius", "null"}));
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": {}})")), "x.json", {"surface 1", "radius", "an object"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("stop": 1)")), "x.json", {"surface 1", "stop", "1"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("curved_in": "z")")), "x.json", {"surface 1", "curved_in", "\"z\""}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("aspheric": [1])")), "x.json", {"surface 1", "aspheric 0", "1"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("aspheric": [{"order": 4.5}])")), "x.json",
                         {"surface 1", "aspheric 0", "order", "4.5"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("glass": true)")), "x.json", {"surface 1", "glass", "true"}));
  EXPECT_TRUE(
      positioned(refusal(file(R"("object_space": {"nd": "water"})")), "x.json", {"object_space", "nd", "\"water\""}));
}

TEST(PrescriptionJson, UnknownAndDuplicateKeysAreRefused) {
  EXPECT_TRUE(positioned(refusal(with_member(R"("semidiameter": 5)")), "x.json",
                         {"surface 1", "key \"semidiameter\"", "unknown"}));
  EXPECT_TRUE(
      positioned(refusal(file(R"("source": {"year": 1952})")), "x.json", {"source", "key \"year\"", "unknown"}));
  EXPECT_TRUE(positioned(refusal(file(R"("object_space": {"nd": 1.3, "radius": 5})")), "x.json",
                         {"object_space", "key \"radius\"", "unknown"}));
  EXPECT_TRUE(positioned(refusal(with_member(R"("radius": 50)")), "x.json", {"surface 1", "key \"radius\"", "twice"}));
  EXPECT_TRUE(positioned(refusal(file(R"("id": "a", "id": "a")")), "x.json", {"key \"id\"", "twice"}));
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"variable_gaps": {"0": 1, "0": 1}})")), "x.json",
                         {"zoom", "variable_gaps", "key \"0\"", "twice"}));
  EXPECT_TRUE(positioned(
      refusal(with_member(R"("aspheric": [{"order": 4, "coefficient": 1}, {"order": 4, "coefficient": 2}])")), "x.json",
      {"surface 1", "aspheric coefficient of order 4", "given twice"}));
}

TEST(PrescriptionJson, WhatIsNotALensIsRefusedWithTheSurface) {
  EXPECT_TRUE(positioned(refusal(with_surface(R"({"radius": 50, "thickness": 5, "nd": -1})")), "x.json",
                         {"surface 1", "nd", "-1"}));
  EXPECT_TRUE(
      positioned(refusal(with_member(R"("semi_diameter": -3)")), "x.json", {"surface 1", "semi_diameter", "-3"}));
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"variable_gaps": {"1": 5}}, "surfaces": [)" + row + "]")), "x.json",
                         {"configuration 0", "changed surface", "1"}));
}

TEST(PrescriptionJson, TheOldFormOfZoomPositionsIsAConfiguration) {
  const Prescription old = parse_prescription(
      file(R"("zoom": {"position": "tele", "variable_gaps": {"0": 5.5}}, "surfaces": [)" + row + "]"), "x.json");
  ASSERT_EQ(old.configurations.size(), 1u);
  EXPECT_EQ(old.configurations[0].name, "tele");
  EXPECT_EQ(old.configurations[0].changes, (std::vector<petzval::SurfaceChange>{{.surface = 0, .thickness = 5.5}}));
}

TEST(PrescriptionJson, TheOldFormOfZoomPositionsStandsAloneAndHasNumbers) {
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"position": "wide"}, "configurations": [{"name": "a"}])")), "x.json",
                         {"\"zoom\" beside \"configurations\""}));
  EXPECT_TRUE(positioned(refusal(file(R"("zoom": {"variable_gaps": {"3": {}}})")), "x.json",
                         {"zoom", "variable_gaps", "an object"}));
}

TEST(PrescriptionJson, NumbersBeyondDoubleAreRefused) {
  const auto radius = [](const std::string& number) { return refusal(with_surface("{\"radius\": " + number)); };
  for (const char* number :
       {"1e309", "-1e309", "1e-400", "9007199254740993", "-9223372036854775808", "18446744073709551616"}) {
    EXPECT_TRUE(positioned(radius(number + std::string(",")), "x.json", {"surface 1", "radius", number}));
  }
  const auto lens =
      parse_prescription(with_surface(R"({"radius": 9007199254740992, "thickness": 0, "nd": 1})"), "x.json");
  EXPECT_EQ(lens.surfaces[1].radius, 0x1p53);
}

TEST(PrescriptionJson, TextThatIsNotJson_IsRefusedWithLineAndColumn) {
  const std::string start = with_surface("{\"radius\": ");
  const std::string before = start.substr(0, start.size() - 3);  // up to the value
  for (const std::string& wrong :
       std::vector<std::string>{"+1", ".5", "5.", "0x1p3", "01", "1.5D+01", "'a'", "1 // comment\n", "/* */ 1", "1e",
                                "\"\\ud800\"", "\"\\udc00\"", "\"\\ud800\\u0041\"", "\"\xff\"", "\"\xc0\x80\"",
                                "\"\xed\xa0\x80\"", "\"line\nend\"", "\"\\x\""}) {
    const std::string said = refusal(before + wrong + ", \"thickness\": 5, \"nd\": 1}]}");
    EXPECT_TRUE(positioned(said, "x.json", {"not JSON"})) << wrong;
  }
  for (const std::string& wrong :
       std::vector<std::string>{"[" + row + ",]", "[" + row + "]]", "[" + row + " " + row + "]"}) {
    EXPECT_TRUE(positioned(refusal(file("\"surfaces\": " + wrong)), "x.json", {"not JSON"})) << wrong;
  }
  const std::string good = file("\"surfaces\": [" + row + "]");
  EXPECT_EQ(refusal(good), "no error");
  const std::string behind = "1:" + std::to_string(good.size() + 1);
  EXPECT_TRUE(positioned(refusal(good + "x"), "x.json", {"not JSON"}, behind));
  EXPECT_TRUE(positioned(refusal(good + std::string(1, '\0') + "x"), "x.json", {"UTF-8"}, behind));
  for (const std::string& nothing : std::vector<std::string>{"", " \n", "\xEF\xBB\xBF", "\xEF\xBB", "\xFE\xFF"}) {
    EXPECT_TRUE(positioned(refusal(nothing), "x.json", {"not JSON"})) << nothing.size();
  }
}

/// A lens of three lines, with a surface in line 3.
std::string third_line(const std::string& radius, const std::string& rest = ", \"thickness\": 5, \"nd\": 1.5") {
  return "{\"format\": \"petzval-lens 1\",\n \"surfaces\": [\r\n  {\"radius\": " + radius + rest + "}]}";
}

TEST(PrescriptionJson, MistakesOfPeople_AreNamedWithLineAndColumn) {
  EXPECT_EQ(refusal(third_line("50")), "no error");
  for (const char* wrong : {"\"abc\"", "null", "Infinity", "-Infinity", "inf", "NaN", "true", "1e999"}) {
    EXPECT_TRUE(positioned(refusal(third_line(wrong)), "x.json", {"surface 0", "radius", wrong}, "3:14")) << wrong;
  }
  // A plane has a number, which the message tells.
  for (const char* plane : {"Infinity", "null", "\"inf\""}) {
    EXPECT_TRUE(positioned(refusal(third_line(plane)), "x.json", {"radius", plane, "0 is a plane"})) << plane;
  }
  EXPECT_TRUE(positioned(refusal(third_line("50,5")), "x.json", {"50,5", "decimal point"}, "3:14"));
  EXPECT_TRUE(positioned(refusal(third_line("50", ", \"raduis\": 5")), "x.json", {"raduis", "radius"}, "3:18"));
  EXPECT_TRUE(positioned(refusal(third_line("50", ", \"nd\": 1.5")), "x.json", {"thickness", "missing"}, "3:3"));
  EXPECT_TRUE(positioned(refusal(third_line("50", ", \"thickness\": 5, \"nd\": 7")), "x.json", {"nd", "7"}, "3:40"));
  EXPECT_TRUE(positioned(refusal(third_line("50", " \"nd\": 1.5")), "x.json", {"not JSON"}, "3:17"));
  EXPECT_TRUE(positioned(refusal(third_line("1e-13")), "x.json", {"radius", "1e-13"}, "3:14"));
  EXPECT_TRUE(positioned(refusal("{\"surfaces\": [" + row + "]}"), "x.json", {"format", "petzval-lens 1"}, "1:1"));
  // Columns count characters, without the byte order mark.
  EXPECT_TRUE(
      positioned(refusal("\xEF\xBB\xBF{\"name\": \"\u00b5\", \"f_number\": \"a\"}"), "x.json", {"f_number"}, "1:27"));
}

TEST(PrescriptionJson, ValuesThatNoLensHas_AreFoundInConfigurationsAndDesign) {
  const auto refused = [](const std::string& members) {
    return refusal("{\"format\": \"petzval-lens 1\",\n" + members + ",\n\"surfaces\": [" + row + "]}");
  };
  EXPECT_TRUE(positioned(refused(R"("f_number": -1)"), "x.json", {"f_number", "-1"}, "2:13"));
  EXPECT_TRUE(positioned(refused(R"("design": {"wavelengths": [{"nm": 550}, {"nm": 1}]})"), "x.json",
                         {"wavelength 1", "1"}, "2:41"));
  EXPECT_TRUE(positioned(refused(R"("configurations": [{"name": "a"}, {"name": "b", "changes": [{"surface": 4}]}])"),
                         "x.json", {"configuration 1", "4"}, "2:35"));
}

TEST(PrescriptionJson, ATextCutOffAtAnyByteIsRefused) {
  for (const char* id : {"zoom_14-30mm_f4", "catadioptric_mangin_1000mm_f7.5", "double_gauss_100mm_f1.35"}) {
    std::string text = text_of(fs::path(PETZVAL_TEST_DATA) / "lenses" / (std::string(id) + ".json"));
    text.resize(text.find_last_of('}') + 1);
    for (std::size_t length = 0; length < text.size(); ++length) {
      ASSERT_TRUE(refusal(text.substr(0, length)).starts_with("x.json:")) << id << " cut at " << length;
    }
  }
}

TEST(PrescriptionJson, ATextWithAnyByteChangedIsReadOrRefused) {
  std::mt19937 random(3);
  const std::string good = text_of(fs::path(PETZVAL_TEST_DATA) / "lenses" / "zoom_14-30mm_f4.json");
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string text = good;
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
      text[random() % text.size()] =
          static_cast<char>(random() % 3 ? "{}[]\":,.-e0 \\n"[random() % 15] : random() % 256);
    }
    refused += refusal(text) != "no error";  // any exception but Error would end the test
  }
  EXPECT_GT(refused, 2500);
}

TEST(PrescriptionJson, HugeTextsAreRefusedEarly) {
  std::string rows = row;
  for (int i = 1; i < 10'000; ++i) rows += "," + row;
  EXPECT_EQ(parse_prescription(file("\"surfaces\": [" + rows + "]"), "x.json").surfaces.size(), 10'000u);
  // The reader stops at the first surface too many; the rest is not JSON.
  EXPECT_EQ(refusal(file("\"surfaces\": [" + rows + "," + row + "] !")),
            "x.json: more than 10000 surfaces; must be fewer");
  std::string aliases = "\"\"";
  for (int i = 0; i < 10'000; ++i) aliases += ",\"\"";
  EXPECT_EQ(refusal(file("\"aliases\": [" + aliases + "]")),
            "x.json: more than 10000 entries in a list; must be fewer");
  // The reader stops at the first bracket that the format does not have, of one or a hundred thousand.
  const std::string deep(100'000, '[');
  EXPECT_TRUE(positioned(refusal(deep), "x.json", {"document", "a list"}));
  EXPECT_TRUE(positioned(refusal(file("\"surfaces\": [" + deep)), "x.json", {"surface 0", "a list"}));
  EXPECT_TRUE(positioned(refusal(file("\"notes\": " + deep)), "x.json", {"notes", "a list"}));
  // Messages shorten long strings.
  const std::string said = refusal(file("\"" + std::string(1'000'000, 'k') + "\": 1"));
  EXPECT_TRUE(positioned(said, "x.json", {"key \"" + std::string(60, 'k') + "...\""})) << said.substr(0, 100);
  EXPECT_LT(refusal(file("\"f_number\": " + std::string(1'000'000, '1'))).size(), 300u);
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(PrescriptionJson, TheLocaleDoesNotMatter) {
  // Sets the locale of streams, and of the C library if the machine has it.
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  const fs::path lens = fs::path(PETZVAL_TEST_DATA) / "lenses" / "zoom_14-30mm_f4.json";
  const std::string written = format_prescription(petzval::read_prescription(lens));
  std::locale::global(before);
  std::setlocale(LC_ALL, "C");
  EXPECT_EQ(written, text_of(lens));
}

}  // namespace
