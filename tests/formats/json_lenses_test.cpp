// SPDX-License-Identifier: Apache-2.0
// Lenses in the JSON of lentil and of optiland.
#include <gtest/gtest.h>

#include <string>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "../expect_error.hpp"
#include "../positioned.hpp"
#include "lens_text.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace json_lenses_test {

using petzval::Prescription;
using petzval::testing::expect_tokens;
using petzval::testing::positioned;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

/// A singlet behind its stop, in the format of optiland.
const std::string optiland = R"({
  "version": 1.0,
  "aperture": {"type": "EPD", "value": 10, "object_space_telecentric": false},
  "fields": {"fields": [{"x": 0, "y": 0, "vx": 0, "vy": 0}, {"x": 0, "y": 7, "vx": 0.1, "vy": 0.2}], "field_type": "angle"},
  "wavelengths": {"wavelengths": [{"value": 0.4861, "is_primary": false, "unit": "um"},
                                  {"value": 0.5876, "is_primary": true, "unit": "um"}], "polarization": "ignore"},
  "pickups": [],
  "solves": {"solves": []},
  "surface_group": {"surfaces": [
    {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"x": 0, "y": 0, "z": -Infinity, "rx": 0, "ry": 0, "rz": 0, "reference_cs": null}, "radius": Infinity},
     "material_post": {"type": "IdealMaterial", "index": 1.0}},
    {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 0}, "radius": Infinity}, "material_post": {"type": "IdealMaterial", "index": 1.0}, "is_stop": true},
    {"type": "Surface", "geometry": {"type": "EvenAsphere", "cs": {"z": 2}, "radius": 50, "conic": -0.5, "coefficients": [0, 1e-6]},
     "material_post": {"type": "Material", "filename": "data\\glass\\schott\\N-BK7.yml", "name": "N-BK7", "reference": null},
     "is_stop": false, "aperture": {"type": "RadialAperture", "r_max": 8, "r_min": 1}},
    {"type": "Surface", "geometry": {"type": "StandardGeometry", "cs": {"z": 6}, "radius": -50, "conic": 0}, "material_post": {"type": "AbbeMaterial", "index": 1.3, "abbe": 55}},
    {"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 54}, "radius": Infinity}, "material_post": {"type": "IdealMaterial", "index": 1.0}}
  ]}
})";

TEST(Optiland, HasTheValuesOfTheFile) {
  const Prescription p = read(optiland);
  EXPECT_EQ(p.imported->format, "optiland");
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings[0].command;
  ASSERT_EQ(p.surfaces.size(), 3u);
  EXPECT_TRUE(p.surfaces[0].stop);
  EXPECT_NEAR(*p.surfaces[0].semi_diameter, 5, 1e-12);
  EXPECT_EQ(p.surfaces[0].thickness, 2);
  EXPECT_EQ(p.surfaces[1].radius, 50);
  EXPECT_EQ(p.surfaces[1].conic, -0.5);
  EXPECT_EQ(p.surfaces[1].aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-6}}));
  EXPECT_EQ(p.surfaces[1].medium.catalogue, "schott");
  EXPECT_EQ(p.surfaces[1].semi_diameter, 8);
  EXPECT_EQ(p.surfaces[1].obscuration_semi_diameter, 1);
  EXPECT_EQ(p.surfaces[2].medium, (petzval::Medium{.nd = 1.3, .vd = 55}));
  EXPECT_EQ(p.surfaces[2].thickness, 48);
  EXPECT_EQ(p.design.fields[1].compress_y, 0.2);
  EXPECT_EQ(p.design.wavelengths[1].nm, 587.6);
  EXPECT_EQ(p.design.primary_wavelength, 1u);
}

TEST(Optiland, RefusesLensesWithoutRotationalSymmetry) {
  expect_tokens(refusal(with(optiland, "\"cs\": {\"z\": 6}", "\"cs\": {\"z\": 6, \"rx\": 0.1}")), {"rx", 0.1});
  expect_tokens(refusal(with(optiland, "EvenAsphere", "Toroidal")), {"\"Toroidal\""});
  EXPECT_EQ(read(with(optiland, "EvenAsphere", "OddAsphere")).surfaces[1].aspheric,
            (std::vector<petzval::AsphereTerm>{{2, 1e-6}}));
  EXPECT_NE(warning(with(optiland, "\"is_stop\": true", "\"is_stop\": true, \"bsdf\": 5"),
                    "file.surface_group.surfaces[1].bsdf"),
            "no warning");
  EXPECT_NE(warning(with(optiland, "\"pickups\": []", "\"pickups\": [1]"), "file.pickups"), "no warning");
  for (std::size_t length = 2; length < optiland.size(); length += 3) refusal(optiland.substr(0, length));
  EXPECT_NE(refusal("{\"surface_group\": " + std::string(100'000, '[')), "no error");
}

TEST(Optiland, MissingAndUnknownValuesAreReported) {
  expect_tokens(refusal(with(optiland, "\"EPD\"", "\"EPX\"")), {"type", "\"EPX\""});
  expect_tokens(refusal(with(optiland, "\"value\": 10", "\"value\": \"ten\"")), {"value", "\"ten\""});
  expect_tokens(refusal(with(optiland, "\"value\": 10,", "")), {"value", "missing"});
  expect_tokens(refusal(with(optiland, "\"value\": 10", "\"value\": 1e999")), {"1e999"});
  expect_tokens(warning(with(optiland, "\"angle\"", "\"angel\""), "file.fields.field_type"), {"\"angel\""});
  expect_tokens(refusal(with(with(optiland, "EvenAsphere", "OddAsphere"), "[0, 1e-6]", "[1e-3]")),
                {"coefficients", 0.001, 1});
  expect_tokens(
      warning(with(optiland, "RadialAperture", "RectangularAperture"), "file.surface_group.surfaces[2].aperture"),
      {"round"});
  const std::size_t list = optiland.find("\"surfaces\": [") + 13;
  expect_tokens(refusal(optiland.substr(0, list) + "1, 2]}}"), {"surfaces", 2});
  expect_tokens(refusal(optiland.substr(0, list) + petzval::testing::repeated(10'002, "1,") + "1]}}"),
                {10000, "surfaces"});
  expect_tokens(refusal(optiland + std::string(1 << 24, ' ')), {"bytes"});
}

TEST(Optiland, SynonymsAreRead) {
  using petzval::FieldKind;
  const auto kind = [](const std::string& word) {
    return read(with(optiland, "\"angle\"", '"' + word + '"')).design.field_kind;
  };
  EXPECT_EQ(kind("object_height"), FieldKind::object_height);
  EXPECT_EQ(kind("paraxial_image_height"), FieldKind::paraxial_image);
  EXPECT_EQ(kind("real_image_height"), FieldKind::real_image_height);
  const std::string of_fields = with(with(optiland, ", \"field_type\": \"angle\"}", "}"), "\"y\": 7,",
                                     "\"y\": 7, \"field_type\": \"real_image_height\",");
  EXPECT_EQ(read(of_fields).design.field_kind, FieldKind::real_image_height);

  const auto nm = [](const std::string& value, const std::string& unit) {
    return read(with(with(optiland, "0.5876", value), "true, \"unit\": \"um\"", "true, \"unit\": \"" + unit + '"'))
        .design.wavelengths.at(1)
        .nm;
  };
  EXPECT_EQ(nm("587.6", "nm"), 587.6);
  EXPECT_EQ(nm("0.0005876", "mm"), 587.6);

  const auto setting = [](const std::string& word) {
    return read(with(optiland, "\"EPD\"", '"' + word + '"')).design.aperture.value().setting;
  };
  EXPECT_EQ(setting("imageFNO"), petzval::ApertureSetting::f_number);
  EXPECT_EQ(read(with(optiland, "{\"type\": \"EPD\"", "{\"ap_type\": \"EPD\"")).design, read(optiland).design);

  const Prescription near = read(with(optiland, "\"z\": -Infinity", "\"z\": -100"));
  EXPECT_EQ(near.design.object_distance_mm, 100);
  EXPECT_EQ(read(with(optiland, "\"version\": 1.0", "\"name\": \"a \\\"NaN\\\" lens\"")).imported->title,
            "a \"NaN\" lens");
  EXPECT_EQ(read(with(optiland, "\"is_stop\": true", "\"is_stop\": true, \"comment\": \"iris\"")).surfaces[0].comment,
            "iris");
  const Prescription wide =
      read(with(with(optiland, "\"r_max\": 8", "\"r_max\": Infinity"), "\"r_min\": 1", "\"r_min\": 0"));
  EXPECT_TRUE(wide.surfaces[1].semi_diameter_computed);
  EXPECT_FALSE(wide.surfaces[1].obscuration_semi_diameter);
  EXPECT_EQ(read(with(optiland, "\"radius\": 50", "\"radius\": -Infinity")).surfaces[1].radius, 0);
}

TEST(Optiland, MaterialsAreNamesFilesAndNumbers) {
  const auto medium = [](const std::string& material) {
    return read(with(optiland, R"({"type": "AbbeMaterial", "index": 1.3, "abbe": 55})", material)).surfaces[2].medium;
  };
  for (const char* material :
       {R"({"type": "Material", "filename": null, "name": "N-BK7", "reference": "schott"})",
        R"({"type": "Material", "filename": "schott/N-BK7.yml", "name": "N-BK7"})",
        R"({"type": "Material", "name": "N-BK7"})", R"({"type": "MaterialFile", "filename": "glasses/N-BK7.yml"})",
        R"({"type": "MaterialFile", "filename": "N-BK7"})"}) {
    EXPECT_EQ(medium(material).glass, "N-BK7") << material;
    EXPECT_EQ(medium(material).catalogue, "schott") << material;
  }
  EXPECT_EQ(medium(R"({"type": "IdealMaterial", "index": [1.4]})"), (petzval::Medium{.nd = 1.4, .vd = 0}));
  EXPECT_EQ(medium(R"({"type": "IdealMaterial", "index": [1.0]})"), petzval::Medium{});
  EXPECT_EQ(medium(R"({"type": "AbbeMaterialE", "index": [1.4], "abbe": [50]})"),
            (petzval::Medium{.nd = 1.4, .vd = 50}));
  const auto refused = [](const std::string& material) {
    return refusal(with(optiland, R"({"type": "AbbeMaterial", "index": 1.3, "abbe": 55})", material));
  };
  const std::string where = "file.surface_group.surfaces[3].material_post";
  EXPECT_TRUE(
      positioned(refused(R"({"type": "IdealMaterial", "index": [1.4, 1.5]})"), "x", {where + ".index", "[1.4,1.5]"}));
  EXPECT_TRUE(
      positioned(refused(R"({"type": "IdealMaterial", "index": ["1.4"]})"), "x", {where + ".index", "[\"1.4\"]"}));
  EXPECT_TRUE(
      positioned(refused(R"({"type": "AbbeMaterial", "index": 1.4, "abbe": []})"), "x", {where + ".abbe", "[]"}));
  EXPECT_TRUE(positioned(refused(R"({"type": "Jelly"})"), "x", {where + ".type", "\"Jelly\""}));
}

TEST(Optiland, MirrorsHaveThreeForms) {
  for (const auto& [old, now] :
       {std::pair(R"("index": 1.3, "abbe": 55})", R"("index": 1.3, "abbe": 55}, "is_reflective": true)"),
        std::pair(R"({"type": "AbbeMaterial", "index": 1.3, "abbe": 55})", R"({"type": "Mirror"})"),
        std::pair(R"("index": 1.3, "abbe": 55})",
                  R"("index": 1.3, "abbe": 55}, "interaction_model": {"is_reflective": true})")}) {
    const Prescription p = read(with(with(optiland, "\"z\": 54", "\"z\": -42"), old, now));
    EXPECT_TRUE(p.surfaces[2].mirror) << now;
    EXPECT_EQ(p.surfaces[2].medium, p.surfaces[1].medium) << now;
    EXPECT_EQ(p.surfaces[2].thickness, -48) << now;
  }
}

TEST(Optiland, WrongTypesAreRefusedWithTheirPosition) {
  const auto refused = [](const std::string& old, const std::string& now) { return refusal(with(optiland, old, now)); };
  const std::string surface = "file.surface_group.surfaces[1]";
  EXPECT_TRUE(positioned(refused("\"is_stop\": true", "\"is_stop\": 1"), "x", {surface + ".is_stop", "1"}));
  EXPECT_TRUE(positioned(refused("\"is_stop\": true", "\"comment\": 1"), "x", {surface + ".comment", "1"}));
  EXPECT_TRUE(positioned(refused("\"cs\": {\"z\": 0}", "\"cs\": 0"), "x", {surface + ".geometry.cs", "0"}));
  EXPECT_TRUE(positioned(refused("\"cs\": {\"z\": 0}, ", ""), "x", {surface + ".geometry.cs", "missing"}));
  EXPECT_TRUE(
      positioned(refused("\"cs\": {\"z\": 0}", "\"cs\": {\"z\": NaN}"), "x", {surface + ".geometry.cs.z", "\"NaN\""}));
  EXPECT_TRUE(positioned(refused("\"cs\": {\"z\": 0}", "\"cs\": {\"z\": 0, \"reference_cs\": {}}"), "x",
                         {surface + ".geometry.cs.reference_cs", "another system of coordinates"}));
  EXPECT_TRUE(positioned(refused("[0, 1e-6]", "[0, \"A\"]"), "x",
                         {"file.surface_group.surfaces[2].geometry.coefficients", "\"A\""}));
  EXPECT_TRUE(
      positioned(refused("[0, 1e-6]", "5"), "x", {"file.surface_group.surfaces[2].geometry.coefficients", "no list"}));
  EXPECT_TRUE(
      positioned(refused("{\"x\": 0, \"y\": 0, \"vx\": 0, \"vy\": 0}", "7"), "x", {"file.fields.fields[0]", "7"}));
  EXPECT_TRUE(positioned(refused("\"is_primary\": true, \"unit\": \"um\"", "\"unit\": \"inch\""), "x",
                         {"file.wavelengths.wavelengths[1].unit", "\"inch\""}));
  expect_tokens(
      warning(with(optiland, "\"is_primary\": false", "\"is_primary\": true"), "file.wavelengths.wavelengths"),
      {2, "primary"});
  EXPECT_TRUE(
      positioned(refused("{\"wavelengths\": [", "{\"waves\": ["), "x", {"file.wavelengths.wavelengths", "missing"}));
  const std::string telecentric = with(optiland, "_telecentric\": false", "_telecentric\": true");
  EXPECT_NE(warning(telecentric, "file.aperture.object_space_telecentric"), "no warning");
  EXPECT_NE(warning(with(optiland, "{\"solves\": []}", "{\"solves\": [1]}"), "file.solves"), "no warning");
}

const std::string lentil =
    R"({"0001": {"company": "none", "product-name": "singlet", "year": 2000, "patent-number": "US 1",
  "focal-length-mm-patent": 50, "fstop": 5, "optical-elements-patent": [
  {"radius": 0, "thickness": [2, 3, 4], "material": "iris", "ior": 1, "abbe": 0, "housing-radius": 4.9, "lens-geometry": "planar"},
  {"radius": 50.6, "thickness": 5.2, "material": "BK7", "ior": 1.5168, "abbe": 64.2, "housing-radius": 12, "lens-geometry": "spherical"},
  {"radius": -50.6, "thickness": 47, "material": "air", "ior": 1, "abbe": 0, "housing-radius": 12, "lens-geometry": "spherical"}]}})";

TEST(Lentil, HasTheValuesOfTheFile) {
  const Prescription p = read(lentil);
  EXPECT_EQ(p.imported->format, "lentil");
  EXPECT_EQ(p.name, "none singlet 2000");
  EXPECT_EQ(p.source_design, "US 1");
  EXPECT_EQ(p.focal_length_mm, 50);
  EXPECT_EQ(p.f_number, 5);
  EXPECT_TRUE(p.surfaces[0].stop);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 4.9);
  EXPECT_EQ(p.surfaces[1].medium, (petzval::Medium{.glass = "BK7", .nd = 1.5168, .vd = 64.2}));
  EXPECT_EQ(p.surfaces[2].medium, petzval::Medium{});
  ASSERT_EQ(p.configurations.size(), 3u);
  EXPECT_EQ(configured(p, "long").surfaces[0].thickness, 4);
}

TEST(Lentil, RefusesUnknownValues) {
  EXPECT_TRUE(positioned(refusal(with(lentil, "\"spherical\"", "\"toric\"")), "x", {"lens-geometry", "toric"}));
  EXPECT_NE(refusal(with(lentil, "\"spherical\"", "\"aspherical\"")), "no error");
  EXPECT_NE(warning(with(lentil, "\"year\"", "\"mass\": 5, \"year\""), "0001.mass"), "no warning");
}

/// A lens of the database as its editors write it: its rows, and the row of an iris.
std::string anamorphic_rows(const petzval::Prescription& lens, const std::string& curved_in_x) {
  std::string rows;
  for (const petzval::SurfaceRow& row : lens.surfaces) {
    const bool cylinder = row.curved_in != petzval::Section::both;
    rows += std::string(rows.empty() ? "" : ",\n") +
            "{\"abbe\": " + petzval::testing::digits(row.medium.vd.value_or(0)) +
            ", \"ior\": " + petzval::testing::digits(row.medium.nd.value_or(1)) + ", \"material\": \"" +
            (row.stop              ? "iris"
             : row.medium.is_air() ? "air"
                                   : "abbe") +
            "\", \"lens-geometry\": \"" +
            (cylinder          ? curved_in_x
             : row.radius == 0 ? "planar"
                               : "spherical") +
            "\", \"radius\": " + petzval::testing::digits(row.radius == 0 ? 99999 : row.radius) +
            ", \"thickness\": " + petzval::testing::digits(row.thickness) +
            ", \"housing-radius\": " + petzval::testing::digits(row.semi_diameter.value()) + "}";
  }
  return "{\"7\": {\"product-name\": \"anamorphic\", \"optical-elements-patent\": [\n" + rows + "]}}";
}

// The letter names the axis of the cylinder: an anamorphic lens, with a picture wider than its film, is cyl-y.
TEST(Lentil, CylindersAreCurvedAcrossTheirAxis) {
  const Prescription lens = petzval::testing::data_prescription("anamorphic_60mm_2x");
  const Prescription y = read(anamorphic_rows(lens, "cyl-y")), x = read(anamorphic_rows(lens, "cyl-x"));
  ASSERT_EQ(y.surfaces.size(), lens.surfaces.size());
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    EXPECT_EQ(y.surfaces[i].curved_in, lens.surfaces[i].curved_in) << i;
    EXPECT_EQ(y.surfaces[i].medium, lens.surfaces[i].medium) << i;
  }
  const auto focal_length = [](const Prescription& p, petzval::Meridian meridian) {
    return petzval::first_order(compile(p), {}, meridian).effective_focal_length;
  };
  using petzval::Meridian;
  EXPECT_NEAR(focal_length(y, Meridian::x), 31.49, 0.01);
  EXPECT_NEAR(focal_length(y, Meridian::y), 60.55, 0.01);
  EXPECT_NEAR(focal_length(x, Meridian::x), focal_length(y, Meridian::y), 1e-9);
  EXPECT_NEAR(focal_length(x, Meridian::y), focal_length(y, Meridian::x), 1e-9);
}

TEST(Lentil, OneLensOfADatabaseIsChosenByItsKeyOrItsName) {
  const std::string second = with(with(lentil.substr(1), "0001", "0002"), "singlet", "other");
  const std::string both = lentil.substr(0, lentil.size() - 1) + ", " + with(second, "50.6", "60.6");
  const auto chosen = [&](const std::string& text, const std::string& entry) {
    return petzval::parse_lens(text, "x", {.entry = entry});
  };
  for (const char* entry : {"0002", "other", "Other", "none other 2000"}) {
    EXPECT_EQ(chosen(both, entry).surfaces[1].radius, 60.6) << entry;
    EXPECT_EQ(chosen(both, entry).imported->entry, "0002") << entry;
  }
  EXPECT_EQ(chosen(both, "0001").surfaces[1].radius, 50.6);
  // A single lens needs no choice, so that the word may name a configuration.
  EXPECT_EQ(chosen(lentil, "long").imported->entry, "");
  EXPECT_EQ(chosen(lentil, "0001").imported->entry, "0001");
  for (const char* entry : {"", "0003"}) {
    const std::string said = petzval::testing::message([&] { chosen(both, entry); });
    expect_tokens(said, {"x", "--configuration", "0001", "none singlet 2000", "0002", "none other 2000"});
    if (*entry) expect_tokens(said, {entry});
  }
  const std::string twins = petzval::testing::message([&] { chosen(with(both, "other", "singlet"), "singlet"); });
  expect_tokens(twins, {"2 lenses"});
}

TEST(Lentil, MissingValuesAndWrongTypesAreReported) {
  const auto refused = [](const std::string& old, const std::string& now) { return refusal(with(lentil, old, now)); };
  EXPECT_TRUE(positioned(refused("\"radius\": 50.6", "\"radius\": \"flat\""), "x",
                         {"0001.optical-elements-patent[1].radius", "\"flat\""}));
  EXPECT_TRUE(
      positioned(refused("{\"radius\": 50.6", "5, {\"radius\": 50.6"), "x", {"0001.optical-elements-patent[1]", "5"}));
  EXPECT_TRUE(positioned(refused("[2, 3, 4]", "[2, 3, null]"), "x",
                         {"0001.optical-elements-patent[0].thickness", "[2,3,null]"}));
  EXPECT_TRUE(
      positioned(refusal("{\"optical-elements-patent\": 5}"), "x", {"file.optical-elements-patent", "no list"}));
  expect_tokens(refusal("{\"0001\": [\"optical-elements-patent\", \"optical-elements-patent\"]}"), {"x:1:10", "0001"});
  EXPECT_EQ(read(with(lentil, "\"BK7\"", "\"glass\"")).surfaces[1].medium, (petzval::Medium{.nd = 1.5168, .vd = 64.2}));
  EXPECT_EQ(read(with(lentil, "\"abbe\": 64.2", "\"abbe\": 0")).surfaces[1].medium.vd, std::nullopt);
  EXPECT_EQ(read(with(lentil, "\"radius\": 50.6", "\"radius\": 9999")).surfaces[1].radius, 9999);
  EXPECT_EQ(read(with(with(lentil, "\"spherical\"", "\"planar\""), "\"radius\": 50.6", "\"radius\": 99999"))
                .surfaces[1]
                .radius,
            0);
  EXPECT_EQ(read(with(lentil, "\"fstop\": 5", "\"fstop\": \"five\"")).f_number, std::nullopt);
  EXPECT_EQ(read(with(lentil, "\"company\": \"none\"", "\"company\": 7")).name, "7 singlet 2000");
  // A single lens without a number.
  const std::string alone = lentil.substr(9, lentil.size() - 10);
  EXPECT_EQ(read(alone).surfaces, read(lentil).surfaces);
}

TEST(Lentil, ListsHaveNumbersAndSurfaces) {
  expect_tokens(refusal(with(lentil, "[2, 3, 4]", "[2, 3]")), {"thickness", "[2,3]"});
  const std::string both =
      with(lentil, "\"year\"", "\"optical-elements-adjusted\": [{\"radius\": 50, \"thickness\": 5}], \"year\"");
  expect_tokens(refusal(both), {"ior"});
  const std::string whole = with(both, "\"thickness\": 5}", "\"thickness\": 5, \"ior\": 1.5}");
  EXPECT_EQ(read(whole).surfaces.size(), 1u);
  expect_tokens(warning(whole, "optical-elements-patent"), {"optical-elements-adjusted"});
  const std::size_t list = lentil.find("-patent\": [") + 11;
  expect_tokens(refusal(lentil.substr(0, list) + petzval::testing::repeated(10'000, "1,") + "1]}}"),
                {10000, "surfaces"});
}

}  // namespace json_lenses_test
