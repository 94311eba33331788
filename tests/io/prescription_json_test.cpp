// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/json.hpp"

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

#include "../expect_error.hpp"
#include "../message.hpp"
#include "../positioned.hpp"

namespace prescription_json_test {

namespace fs = std::filesystem;
using petzval::format_prescription;
using petzval::parse_prescription;
using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
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
/// A lens with a valid surface and this surface.
std::string with_surface(const std::string& surface) { return file("\"surfaces\": [" + row + ", " + surface + "]"); }
/// A lens with a valid surface to which one member is added.
std::string with_member(const std::string& member) {
  return with_surface(R"({"radius": 50, "thickness": 5.5, "nd": 1.5, )" + member + "}");
}

std::string refusal(const std::string& text) {
  return message([&] { parse_prescription(text, "x.json"); });
}

/// Checks that a text is refused with line and column, followed by these words.
void expect_refused(const std::string& text, std::initializer_list<std::string_view> words,
                    std::string_view position = {}, int line = __builtin_LINE()) {
  const auto result = positioned(refusal(text), "x.json", words, position);
  if (!result) ADD_FAILURE_AT(__FILE__, line) << result.message();
}

TEST(PrescriptionJson, EveryLensOfTheDataRoundTripsToTheByte) {
  const auto files = lens_files();
  EXPECT_EQ(files.size(), 70u);
  for (const auto& lens : files)
    EXPECT_EQ(format_prescription(petzval::read_prescription(lens)), text_of(lens)) << lens;
}

TEST(PrescriptionJson, HasTheValuesOfTheFile) {
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

/// A random double from the range of lens data.
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
    switch (random() % 4) {
      case 0: s.coating.emplace(); break;
      case 1:
        s.coating = {.layers = {{.index = 1.38, .thickness_nm = std::fmod(std::abs(length()), 1e7)},
                                {2.1, std::fmod(std::abs(length()), 1e3), 0}}};
        break;
      case 2: s.coating = {.table = {{380.5, 0.01}, {500, 0}, {780 + std::abs(length()), 1}}}; break;
      default: break;
    }
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

TEST(PrescriptionJson, AnyLensRoundTrips) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Prescription p = random_prescription(random);
    const std::string text = format_prescription(p);
    const Prescription back = parse_prescription(text, "x.json");
    ASSERT_EQ(back, p) << text;
    ASSERT_EQ(format_prescription(back), text);
  }
}

TEST(PrescriptionJson, CoatingsAreAWordLayersOrReflectances) {
  const auto read = [](const std::string& coating) {
    return parse_prescription(with_member("\"coating\": " + coating), "x.json").surfaces[1].coating;
  };
  EXPECT_FALSE(parse_prescription(with_surface(row), "x.json").surfaces[1].coating);
  EXPECT_EQ(read(R"("none")"), petzval::Coating{});
  EXPECT_EQ(read(R"("mgf2")"), petzval::Coating::quarter_wave());
  EXPECT_EQ(
      read(
          R"({"layers": [{"index": 1.38, "thickness_nm": 99.6}, {"index": 2, "absorption": 0.5, "thickness_nm": 7}]})"),
      (petzval::Coating{.layers = {{1.38, 0, 99.6}, {2, 0.5, 7}}}));
  EXPECT_EQ(read(R"({"reflectance": [{"wavelength_nm": 400, "value": 0.01}, {"wavelength_nm": 700, "value": 0.02}]})"),
            (petzval::Coating{.table = {{400, 0.01}, {700, 0.02}}}));
}

TEST(PrescriptionJson, WrongCoatingsAreRefused) {
  const auto refused = [](const std::string& coating, std::initializer_list<std::string_view> words,
                          std::string_view position = {}, int line = __builtin_LINE()) {
    expect_refused(with_member("\n\"coating\": " + coating), words, position, line);
  };
  for (const char* value : {"5", "null", "true", "\"AR\""}) {
    refused(value, {"surface 1", "coating", value, "\"none\"", "\"mgf2\"", "object"}, "2:12");
  }
  refused("[]", {"surface 1", "coating", "a list", "an object"});
  refused("{}", {"surface 1", "coating", "\"layers\"", "\"reflectance\""}, "2:12");
  refused(R"({"layers": []})", {"surface 1", "coating", "\"layers\""}, "2:12");
  refused(R"({"layers": 5})", {"coating", "layers", "5", "a list"});
  refused(R"({"layers": [1.38]})", {"coating", "layer 0", "1.38", "an object"});
  refused(R"({"stack": []})", {"surface 1", "coating", "\"stack\"", "layers, reflectance"});
  refused(R"({"layers": [{"index": 1.4}]})", {"coating", "layer 0", "\"thickness_nm\"", "missing"});
  refused(R"({"layers": [{"thickness_nm": 5}]})", {"coating", "layer 0", "\"index\"", "missing"});
  refused(R"({"layers": [{"index": 1.4, "thickness": 5}]})", {"layer 0", "\"thickness\"", "thickness_nm"});
  refused(R"({"layers": [{"index": "MgF2", "thickness_nm": 5}]})", {"layer 0", "index", "\"MgF2\"", "a number"});
  refused(R"({"reflectance": [{"wavelength_nm": 500}]})", {"reflectance 0", "\"value\"", "missing"});
  refused(R"({"reflectance": [{"value": 0.5}]})", {"reflectance 0", "\"wavelength_nm\"", "missing"});
  const std::string layer = R"({"index": 1.4, "thickness_nm": 5})";
  refused("{\"layers\": [" + layer + R"(, {"index": 0, "thickness_nm": 5}]})",
          {"surface 1", "coating", "layer 1", "index", "0", "0.001"}, "2:69");
  refused(R"({"layers": [{"index": 1.4, "absorption": -1, "thickness_nm": 5}]})", {"layer 0", "absorption", "-1"});
  refused(R"({"layers": [{"index": 1.4, "thickness_nm": -5}]})", {"layer 0", "thickness_nm", "-5"});
  refused("{\"layers\": [" + layer + R"(], "reflectance": [{"wavelength_nm": 500, "value": 0}]})",
          {"surface 1", "coating", "layers", "table"});
  refused(R"({"reflectance": [{"wavelength_nm": 500, "value": 1.5}]})", {"surface 1", "coating", "reflectance", "1.5"});
  refused(R"({"reflectance": [{"wavelength_nm": 500, "value": 0}, {"wavelength_nm": 400, "value": 0}]})",
          {"coating", "wavelength_nm", "400", "increase"});
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

TEST(PrescriptionJson, UnlimitedAperturesAreWrittenAsNull) {
  Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  p.surfaces[0].semi_diameter = std::numeric_limits<double>::infinity();
  EXPECT_NE(format_prescription(p).find("\"semi_diameter\": null"), std::string::npos);
}

TEST(PrescriptionJson, LensesThatCannotBeReadAreNotWritten) {
  Prescription p;
  p.name = "empty";
  expect_error([&] { format_prescription(p); }, {"empty", "surfaces"});
  p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  p.surfaces[0].thickness = std::nan("");
  expect_error([&] { format_prescription(p); }, {"lens", "surface 0", "thickness", "nan"});
  p.surfaces[0].thickness = 0;
  p.notes = "\xb5m";  // Latin-1
  expect_error([&] { format_prescription(p); }, {"UTF-8"});
}

TEST(PrescriptionJson, FilesThatCannotBeOpenedAreNamed) {
  const fs::path folder = ::testing::TempDir();
  const std::string absent = (folder / "no such folder" / "lens.json").string();
  expect_error([&] { petzval::read_prescription(absent); }, {absent, "No such file"});
  expect_error([&] { petzval::read_prescription(folder); }, {folder, "folder"});
  const Prescription p = parse_prescription(file("\"surfaces\": [" + row + "]"), "x.json");
  expect_error([&] { petzval::write_prescription(p, absent); }, {absent, "No such file"});
  const fs::path written = folder / "petzval_written.json";
  petzval::write_prescription(p, written);
  EXPECT_EQ(petzval::read_prescription(written), p);
  fs::remove(written);
}

TEST(PrescriptionJson, IgnoresSpaceByteOrderMarkAndLineEnds) {
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

TEST(PrescriptionJson, OptionalMembersMayBeMissing) {
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
  expect_refused(with_surface(R"({"radius": 5, "thickness": 1, "vd": 60})"), {"surface 1", "vd", "60"});
  expect_refused("{}", {"\"format\"", "missing"});
  expect_refused(file("\"id\": \"a\""), {"\"surfaces\"", "missing"});
  expect_refused(with_surface(R"({"thickness": 5, "nd": 1})"), {"surface 1", "\"radius\"", "missing"});
  expect_refused(with_surface(R"({"radius": 5, "nd": 1})"), {"surface 1", "\"thickness\"", "missing"});
  expect_refused(with_member(R"("aspheric": [{"order": 4}])"),
                 {"surface 1", "aspheric 0", "\"coefficient\"", "missing"});
  expect_refused(file("\"surfaces\": []"), {"surfaces"});
}

TEST(PrescriptionJson, ValuesOfTheWrongKindAreNamed) {
  expect_refused(R"({"format": "petzval-lens 2"})", {"format", "\"petzval-lens 2\""});
  expect_refused("[]", {"document", "a list"});
  expect_refused("7", {"document", "7"});
  expect_refused("\"text\"", {"document", "\"text\""});
  expect_refused(file(R"("name": 5)"), {"name", "5"});
  expect_refused(file(R"("name": null)"), {"name", "null"});
  expect_refused(file(R"("name": ["a"])"), {"name", "a list"});
  expect_refused(file(R"("name": NaN)"), {"name = NaN", "a string"});
  expect_refused(R"({"format": "petzval-lens 2", "new": 1})", {"format", "\"petzval-lens 2\""});
  expect_refused(file(R"("source": "a book")"), {"source", "\"a book\""});
  expect_refused(file(R"("source": [])"), {"source", "a list"});
  expect_refused(file(R"("source": {"design": 1})"), {"source", "design", "1"});
  expect_refused(file(R"("aliases": ["a", 2])"), {"alias 1", "2"});
  expect_refused(file(R"("aliases": [{}])"), {"alias 0", "an object"});
  expect_refused(file(R"("zoom": {"position": "wide", "variable_gaps": {"3": "5"}})"),
                 {"zoom", "variable_gaps", "\"5\""});
  expect_refused(file(R"("design": {"field_kind": "degrees"})"), {"design", "field_kind", "\"degrees\""});
  expect_refused(file(R"("configurations": [{"name": "a", "changes": [{"surface": -1}]}])"),
                 {"configuration 0", "change 0", "surface", "-1"});
  expect_refused(file(R"("configurations": [{"name": "a"}], "zoom": {"position": "b"})"),
                 {"\"zoom\"", "\"configurations\""});
  expect_refused(file(R"("zoom": {"variable_gaps": {"03": 5}})"), {"zoom", "variable_gaps", "\"03\""});
  expect_refused(file(R"("surfaces": {})"), {"surfaces", "an object"});
  expect_refused(file(R"("surfaces": [5])"), {"surface 0", "5"});
  expect_refused(with_surface("[]"), {"surface 1", "a list"});
  expect_refused(with_surface(R"({"radius": "50"})"), {"surface 1", "radius", "\"50\""});
  expect_refused(with_surface(R"({"radius": "1,5"})"), {"surface 1", "radius", "\"1,5\""});
  expect_refused(with_surface(R"({"radius": null})"), {"surface 1", "radius", "null"});
  expect_refused(with_surface(R"({"radius": {}})"), {"surface 1", "radius", "an object"});
  expect_refused(with_member(R"("stop": 1)"), {"surface 1", "stop", "1"});
  expect_refused(with_member(R"("curved_in": "z")"), {"surface 1", "curved_in", "\"z\""});
  expect_refused(with_member(R"("aspheric": [1])"), {"surface 1", "aspheric 0", "1"});
  expect_refused(with_member(R"("aspheric": [{"order": 4.5}])"), {"surface 1", "aspheric 0", "order", "4.5"});
  expect_refused(with_member(R"("glass": true)"), {"surface 1", "glass", "true"});
  expect_refused(file(R"("object_space": {"nd": "water"})"), {"object_space", "nd", "\"water\""});
}

TEST(PrescriptionJson, UnknownAndDuplicateKeysAreRefused) {
  expect_refused(with_member(R"("semidiameter": 5)"), {"surface 1", "\"semidiameter\""});
  expect_refused(file(R"("source": {"year": 1952})"), {"source", "\"year\""});
  expect_refused(file(R"("object_space": {"nd": 1.3, "radius": 5})"), {"object_space", "\"radius\""});
  expect_refused(with_member(R"("radius": 50)"), {"surface 1", "\"radius\""});
  expect_refused(file(R"("id": "a", "id": "a")"), {"\"id\""});
  expect_refused(file(R"("zoom": {"variable_gaps": {"0": 1, "0": 1}})"), {"zoom", "variable_gaps", "\"0\""});
  EXPECT_TRUE(positioned(
      refusal(with_member(R"("aspheric": [{"order": 4, "coefficient": 1}, {"order": 4, "coefficient": 2}])")), "x.json",
      {"surface 1", "aspheric", "4"}));
}

TEST(PrescriptionJson, InvalidLensesAreRefusedWithTheSurface) {
  expect_refused(with_surface(R"({"radius": 50, "thickness": 5, "nd": -1})"), {"surface 1", "nd", "-1"});
  expect_refused(with_member(R"("semi_diameter": -3)"), {"surface 1", "semi_diameter", "-3"});
  expect_refused(file(R"("zoom": {"variable_gaps": {"1": 5}}, "surfaces": [)" + row + "]"),
                 {"configuration 0", "surface", "1"});
}

TEST(PrescriptionJson, OldFormOfZoomPositionsIsAConfiguration) {
  const Prescription old = parse_prescription(
      file(R"("zoom": {"position": "tele", "variable_gaps": {"0": 5.5}}, "surfaces": [)" + row + "]"), "x.json");
  ASSERT_EQ(old.configurations.size(), 1u);
  EXPECT_EQ(old.configurations[0].name, "tele");
  EXPECT_EQ(old.configurations[0].changes, (std::vector<petzval::SurfaceChange>{{.surface = 0, .thickness = 5.5}}));
}

TEST(PrescriptionJson, InvalidOldFormsOfZoomPositionsAreRefused) {
  expect_refused(file(R"("zoom": {"position": "wide"}, "configurations": [{"name": "a"}])"),
                 {"\"zoom\"", "\"configurations\""});
  expect_refused(file(R"("zoom": {"variable_gaps": {"3": {}}})"), {"zoom", "variable_gaps", "an object"});
}

TEST(PrescriptionJson, NumbersBeyondDoubleAreRefused) {
  const auto radius = [](const std::string& number) { return refusal(with_surface("{\"radius\": " + number)); };
  for (const char* number :
       {"1e309", "-1e309", "1e-400", "9007199254740993", "-9223372036854775808", "18446744073709551616"}) {
    EXPECT_TRUE(positioned(radius(number + std::string("}")), "x.json", {"surface 1", "radius", number}));
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
    expect_refused(before + wrong + ", \"thickness\": 5, \"nd\": 1}]}", {"JSON"});
  }
  for (const std::string& wrong :
       std::vector<std::string>{"[" + row + ",]", "[" + row + "]]", "[" + row + " " + row + "]"}) {
    expect_refused(file("\"surfaces\": " + wrong), {"JSON"});
  }
  const std::string good = file("\"surfaces\": [" + row + "]");
  EXPECT_EQ(refusal(good), "no error");
  const std::string behind = "1:" + std::to_string(good.size() + 1);
  expect_refused(good + "x", {"JSON"}, behind);
  expect_refused(good + std::string(1, '\0') + "x", {"UTF-8"}, behind);
  for (const std::string& nothing : std::vector<std::string>{"", " \n", "\xEF\xBB\xBF", "\xEF\xBB", "\xFE\xFF"}) {
    expect_refused(nothing, {"JSON"});
  }
}

/// A lens file of three lines, with a surface in line 3.
std::string third_line(const std::string& radius, const std::string& rest = ", \"thickness\": 5, \"nd\": 1.5") {
  return "{\"format\": \"petzval-lens 1\",\n \"surfaces\": [\r\n  {\"radius\": " + radius + rest + "}]}";
}

TEST(PrescriptionJson, MistakesOfPeople_AreNamedWithLineAndColumn) {
  EXPECT_EQ(refusal(third_line("50")), "no error");
  for (const char* wrong : {"\"abc\"", "null", "Infinity", "-Infinity", "inf", "NaN", "true", "1e999"}) {
    expect_refused(third_line(wrong), {"surface 0", "radius", wrong}, "3:14");
  }
  // The radius of a plane is 0, as the message says.
  for (const char* plane : {"Infinity", "null", "\"inf\""}) {
    expect_refused(third_line(plane), {"radius", plane, "0"});
  }
  expect_refused(third_line("50,5"), {"50,5"}, "3:14");
  expect_refused(third_line("50", ", \"raduis\": 5"), {"raduis", "radius"}, "3:18");
  expect_refused(third_line("50", ", \"nd\": 1.5"), {"thickness", "missing"}, "3:3");
  expect_refused(third_line("50", ", \"thickness\": 5, \"nd\": 7"), {"nd", "7"}, "3:40");
  expect_refused(third_line("50", " \"nd\": 1.5"), {"JSON"}, "3:17");
  expect_refused(third_line("1e-13"), {"radius", "1e-13"}, "3:14");
  expect_refused("{\"surfaces\": [" + row + "]}", {"format", "petzval-lens 1"}, "1:1");
  // Columns count characters, without the byte order mark.
  expect_refused("\xEF\xBB\xBF{\"name\": \"\u00b5\", \"f_number\": \"a\", \"format\": \"petzval-lens 1\"}",
                 {"f_number"}, "1:27");
}

TEST(PrescriptionJson, InvalidValues_AreFoundInConfigurationsAndDesign) {
  const auto refused = [](const std::string& members) {
    return refusal("{\"format\": \"petzval-lens 1\",\n" + members + ",\n\"surfaces\": [" + row + "]}");
  };
  EXPECT_TRUE(positioned(refused(R"("f_number": -1)"), "x.json", {"f_number", "-1"}, "2:13"));
  EXPECT_TRUE(positioned(refused(R"("design": {"wavelengths": [{"nm": 550}, {"nm": 1}]})"), "x.json",
                         {"wavelength 1", "1"}, "2:48"));
  EXPECT_TRUE(positioned(refused(R"("configurations": [{"name": "a"}, {"name": "b", "changes": [{"surface": 4}]}])"),
                         "x.json", {"configuration 1", "4"}, "2:35"));
}

TEST(PrescriptionJson, TruncatedTextsAreRefused) {
  for (const char* id : {"zoom_14-30mm_f4", "catadioptric_mangin_1000mm_f7.5", "double_gauss_100mm_f1.35"}) {
    std::string text = text_of(fs::path(PETZVAL_TEST_DATA) / "lenses" / (std::string(id) + ".json"));
    text.resize(text.find_last_of('}') + 1);
    for (std::size_t length = 0; length < text.size(); ++length) {
      ASSERT_TRUE(refusal(text.substr(0, length)).starts_with("x.json:")) << id << " cut at " << length;
    }
  }
}

TEST(PrescriptionJson, TextsWithAChangedByteAreReadOrRefused) {
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
  expect_tokens(refusal(file("\"surfaces\": [" + rows + "," + row + "]")), {"x.json", 10000, "surfaces"});
  expect_tokens(refusal(std::string((std::size_t{16} << 20) + 1, ' ')), {"x.json", (16 << 20) + 1, 16 << 20});
  std::string aliases = "\"\"";
  for (int i = 0; i < 10'000; ++i) aliases += ",\"\"";
  expect_tokens(refusal(file("\"aliases\": [" + aliases + "]")), {"x.json", 10000, "entries"});
  // The reader stops at the first bracket that is too deep.
  expect_refused(std::string(100'000, '['), {"64 levels"}, "1:65");
  // Messages shorten long strings.
  expect_refused(file("\"" + std::string(1'000'000, 'k') + "\": 1"), {"\"" + std::string(60, 'k') + "...\""});
  EXPECT_LT(refusal(file("\"f_number\": " + std::string(1'000'000, '1'))).size(), 300u);
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(PrescriptionJson, IndependentOfTheLocale) {
  // Sets the locale of streams, and of the C library if it is installed.
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

}  // namespace prescription_json_test
