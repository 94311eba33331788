// SPDX-License-Identifier: Apache-2.0
// Lenses in the formats of collections: LensHH's .lhlt, DeepLens JSON, crayg's .fx.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "../expect_error.hpp"
#include "../positioned.hpp"
#include "lens_text.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace collections_test {

using petzval::Prescription;
using petzval::testing::data_prescription;
using petzval::testing::digits;
using petzval::testing::expect_tokens;
using petzval::testing::positioned;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

double focal_length(const Prescription& p) { return petzval::first_order(compile(p)).effective_focal_length; }

/// The focal length of a lens in air by the lensmaker's equation.
double lensmaker(double n, double r1, double r2, double d) {
  return 1 / ((n - 1) * (1 / r1 - 1 / r2 + (n - 1) * d / (n * r1 * r2)));
}

/// A biconvex singlet in front of its stop.
const std::string lenshh = R"({"FormatVersion": 1, "Title": "Singlet", "Notes": "", "Designer": "none",
  "Aperture": {"Value": 9}, "FieldType": "ObjectAngle",
  "Surfaces": [
    {"Comment": "", "Radius": "Infinity", "Thickness": "Infinity", "Material": "", "SemiDiameter": 3e19},
    {"Index": 1, "Type": "EvenAsphere", "Comment": "front", "Radius": 50.6, "Thickness": 5.2, "Material": "N-BK7",
     "SemiDiameter": 12.7, "SemiDiameterMode": "Fixed", "Conic": -0.5, "InnerRadius": 1, "FloatingApertureRadius": 12,
     "AsphericCoefficients": [0, 1e-7, 0, 2e-13], "CurvatureVariable": true, "ConicMin": -1},
    {"Index": 2, "Radius": -50.6, "Thickness": 1, "Material": "", "SemiDiameter": 12.5},
    {"Index": 3, "Radius": "Infinity", "Thickness": 46, "SemiDiameter": 4.4, "IsStop": true},
    {"Index": 4, "Radius": "Infinity", "Material": ""}],
  "Wavelengths": [{"Value": 0.48613}, {"Value": 0.5875618, "Weight": 2, "IsPrimary": true}],
  "Fields": [{"Weight": 1}, {"Y": 7, "Weight": 3}], "Pickups": [], "RayAiming": "Off", "GlassCatalogs": ["SCHOTT"]})";

TEST(LensHh, HasTheValuesOfTheFile) {
  const Prescription p = read(lenshh);
  EXPECT_EQ(p.imported->format, "lenshh");
  EXPECT_EQ(p.imported->title, "Singlet");
  EXPECT_EQ(p.imported->notes, std::vector<std::string>{"none"});
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings[0].command;
  ASSERT_EQ(p.surfaces.size(), 3u);
  EXPECT_EQ(p.surfaces[0].aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-7}, {8, 2e-13}}));
  EXPECT_EQ(p.surfaces[0].conic, -0.5);
  EXPECT_EQ(p.surfaces[0].semi_diameter, 12);
  EXPECT_EQ(p.surfaces[0].obscuration_semi_diameter, 1);
  EXPECT_EQ(p.surfaces[0].comment, "front");
  EXPECT_EQ(p.surfaces[0].medium.catalogue, "schott");
  EXPECT_EQ(p.surfaces[1].semi_diameter, 12.5);
  EXPECT_EQ(p.surfaces[2].radius, 0);
  EXPECT_TRUE(p.surfaces[2].stop);
  EXPECT_EQ(p.design.fields[1].y, 7);
  EXPECT_EQ(p.design.fields[1].weight, 3);
  EXPECT_EQ(p.design.wavelengths[1], (petzval::DesignWavelength{587.5618, 2}));
  EXPECT_EQ(p.design.primary_wavelength, 1u);
  EXPECT_NEAR(focal_length(p), lensmaker(*p.surfaces[0].medium.nd, 50.6, -50.6, 5.2), 1e-9);
}

// The rim of the stop is a result of the aperture unless the user fixed it.
TEST(LensHh, AperturesAndFixedRimsLimitTheBeam) {
  const auto stop = [](const std::string& aperture) {
    return *read(with(lenshh, "{\"Value\": 9}", aperture)).surfaces[2].semi_diameter;
  };
  // A marginal ray near the axis, at 1 on the first surface.
  const double length = focal_length(read(lenshh)), n = *read(lenshh).surfaces[0].medium.nd;
  const double ray = 1 - 5.2 * (1 - 1 / n) / 50.6 - 1 / length;
  EXPECT_NEAR(stop(R"({"Value": 0.02})"), 0.01 * ray, 1e-9);
  EXPECT_NEAR(stop(R"({"Type": "EPD", "Value": 0.02})"), 0.01 * ray, 1e-9);
  EXPECT_NEAR(stop(R"({"Type": "FNumber", "Value": 1000})"), length / 2000 * ray, 1e-8);
  EXPECT_EQ(read(with(lenshh, "4.4,", "3.3, \"SemiDiameterMode\": \"Fixed\",")).surfaces[2].semi_diameter, 3.3);
  EXPECT_GT(read(lenshh).surfaces[2].semi_diameter, 4);
}

TEST(LensHh, ObjectsMirrorsAndCodesAreRead) {
  const std::string height = with(lenshh, "ObjectAngle", "ObjectHeight");
  const Prescription near = read(with(height, "\"Thickness\": \"Infinity\"", "\"Thickness\": 80"));
  EXPECT_EQ(near.design.object_distance_mm, 80);
  EXPECT_EQ(near.design.field_kind, petzval::FieldKind::object_height);
  EXPECT_TRUE(
      std::isinf(read(with(lenshh, "\"Thickness\": \"Infinity\"", "\"Thickness\": 1e20")).design.object_distance_mm));
  EXPECT_EQ(read(with(lenshh, "N-BK7", "517642")).surfaces[0].medium.nd, 1.517);
  const Prescription mirror =
      read(with(with(lenshh, "\"Thickness\": 1, \"Material\": \"\"", "\"Thickness\": -1, \"Material\": \"MIRROR\""),
                "\"Thickness\": 46", "\"Thickness\": -20"));
  EXPECT_TRUE(mirror.surfaces[1].mirror);
  EXPECT_EQ(mirror.surfaces[1].medium, mirror.surfaces[0].medium);
}

TEST(LensHh, RefusesUnknownValues) {
  const auto refused = [](const std::string& old, const std::string& now) { return refusal(with(lenshh, old, now)); };
  EXPECT_TRUE(
      positioned(refused("\"EvenAsphere\"", "\"Toroidal\""), "x", {"file.Surfaces[1].Type", "\"Toroidal\""}, "5:26"));
  EXPECT_TRUE(
      positioned(refused("\"Radius\": -50.6", "\"Radius\": \"flat\""), "x", {"file.Surfaces[2].Radius", "\"flat\""}));
  EXPECT_TRUE(
      positioned(refused("\"Thickness\": 46", "\"Thickness\": 1e20"), "x", {"Surfaces[3].Thickness", "finite"}));
  EXPECT_TRUE(positioned(refused("\"FormatVersion\": 1", "\"FormatVersion\": 2"), "x", {"FormatVersion", "2", "1"}));
  EXPECT_TRUE(positioned(refused("\"Value\": 9", "\"Size\": 9"), "x", {"file.Aperture.Value", "missing"}));
  EXPECT_TRUE(positioned(refused("{\"Value\": 9}", "{\"Type\": \"NA\", \"Value\": 9}"), "x", {"Type", "\"NA\""}));
  EXPECT_TRUE(positioned(refused("ObjectAngle", "ImageHeight"), "x", {"file.FieldType", "\"ImageHeight\""}));
  EXPECT_TRUE(positioned(refused("[\"SCHOTT\"]", "[5]"), "x", {"file.GlassCatalogs", "5"}));
  expect_tokens(refused("N-BK7", "N-XYZ7"), {"x", "N-XYZ7", "--glasses", "catalogues SCHOTT"});
  const std::size_t list = lenshh.find("\"Surfaces\": [") + 13;
  expect_tokens(refusal(lenshh.substr(0, list) + "1, 2], \"Fields\": [], \"Wavelengths\": []}"), {"Surfaces", 2});
  expect_tokens(warning(with(lenshh, "\"Pickups\": []", "\"Pickups\": [1]"), "file.Pickups"), {"values"});
  EXPECT_NE(
      warning(with(lenshh, "\"Pickups\"", "\"ConfigurationEditor\": [1], \"Pickups\""), "file.ConfigurationEditor"),
      "no warning");
  for (std::size_t length = 2; length < lenshh.size(); length += 7) refusal(lenshh.substr(0, length));
}

/// A lens as DeepLens writes it, with n_d/V_d for each glass.
std::string deeplens_rows(const Prescription& lens) {
  std::string rows;
  for (const petzval::SurfaceRow& row : lens.surfaces) {
    const std::string medium =
        row.medium.is_air() ? "air" : digits(*row.medium.nd) + "/" + digits(row.medium.vd.value_or(50));
    rows += std::string(rows.empty() ? "" : ",\n") + "{\"type\": \"" +
            (row.stop          ? "Aperture\""
             : row.radius == 0 ? "Plane\", \"mat2\": \"" + medium + '"'
                               : "Spheric\", \"mat2\": \"" + medium + "\", \"roc\": " + digits(row.radius)) +
            ", \"r\": " + digits(row.semi_diameter.value()) + ", \"d_next\": " + digits(row.thickness) + "}";
  }
  return "{\"info\": \"a lens\", \"foclen\": 100.4, \"fnum\": 1.35, \"r_sensor\": 21.6, \"(d_sensor)\": 9, "
         "\"surfaces\": [\n" +
         rows + "]}";
}

TEST(DeepLens, HasTheRowsOfALensInData) {
  const Prescription lens = data_prescription("double_gauss_100mm_f1.35"), p = read(deeplens_rows(lens));
  EXPECT_EQ(p.imported->format, "deeplens");
  EXPECT_EQ(p.imported->title, "a lens");
  EXPECT_EQ(p.f_number, 1.35);
  EXPECT_EQ(p.image_diagonal_mm, 43.2);
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings[0].command;
  ASSERT_EQ(p.surfaces.size(), lens.surfaces.size());
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    EXPECT_EQ(p.surfaces[i].radius, lens.surfaces[i].radius) << i;
    EXPECT_EQ(p.surfaces[i].thickness, lens.surfaces[i].thickness) << i;
    EXPECT_EQ(p.surfaces[i].semi_diameter, lens.surfaces[i].semi_diameter) << i;
    EXPECT_EQ(p.surfaces[i].medium.nd.value_or(1), lens.surfaces[i].medium.nd.value_or(1)) << i;
    EXPECT_EQ(p.surfaces[i].stop, lens.surfaces[i].stop) << i;
  }
  EXPECT_NEAR(focal_length(p), focal_length(lens), 1e-9);
}

/// Half of a phone lens, in the form of earlier versions of DeepLens.
const std::string deeplens = R"({"foclen": 5.0, "fnum": 2.5, "d_sensor": 6.0, "surfaces": [
  {"type": "Stop", "r": 1.0, "c": 0.0, "d": 0.0, "mat1": "air", "mat2": "occluder", "d_next": 0.1},
  {"type": "Aspheric", "r": 1.5, "c": 0.4, "d": 0.1, "k": -1.5, "ai": [0.0, 1e-3, -2e-4], "mat2": "okp4", "ai4": 1e-3,
   "d_next": 0.9},
  {"type": "Spheric", "r": 1.5, "roc": -25.0, "d": 1.0, "mat2": "AIR", "d_next": 5.0}]})";

TEST(DeepLens, AspheresPlasticsAndNamesAreRead) {
  const Prescription p = read(deeplens);
  EXPECT_EQ(p.surfaces[0].medium, petzval::Medium{});
  EXPECT_EQ(p.surfaces[1].radius, 2.5);
  EXPECT_EQ(p.surfaces[1].conic, -1.5);
  EXPECT_EQ(p.surfaces[1].aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-3}, {6, -2e-4}}));
  EXPECT_EQ(p.surfaces[1].medium, (petzval::Medium{.nd = 1.6328, .vd = 23.34}));
  EXPECT_NEAR(focal_length(p), lensmaker(1.6328, 2.5, -25, 0.9), 1e-12);
  EXPECT_EQ(warning(p, "file.d_sensor"), "no warning");
  EXPECT_EQ(read(with(deeplens, "okp4", "hk51")).surfaces[1].medium.glass, "H-K51");
  EXPECT_EQ(read(with(deeplens, "okp4", "f2")).surfaces[1].medium.catalogue, "schott");
}

TEST(DeepLens, RefusesAndReportsOtherValues) {
  const auto refused = [](const std::string& old, const std::string& now) { return refusal(with(deeplens, old, now)); };
  EXPECT_TRUE(positioned(refused("\"Spheric\"", "\"Fresnel\""), "x", {"file.surfaces[2].type", "\"Fresnel\""}, "5:12"));
  EXPECT_TRUE(positioned(refused("okp4", "1.5/x"), "x", {"file.surfaces[1].mat2", "\"1.5/x\"", "n_d/V_d"}));
  EXPECT_TRUE(positioned(refused("\"mat2\": \"AIR\", ", ""), "x", {"file.surfaces[2].mat2", "missing"}));
  EXPECT_TRUE(positioned(refused("\"d_next\": 0.9", "\"d_last\": 0.9"), "x", {"surfaces[1].d_next", "missing"}));
  EXPECT_TRUE(positioned(refused("[0.0, 1e-3", "[0.0, null"), "x", {"surfaces[1].ai", "null"}));
  EXPECT_TRUE(positioned(refused("\"c\": 0.4, ", ""), "x", {"surfaces[1].c", "missing"}));
  expect_tokens(refused("\"type\": \"Spheric\", ", ""), {"surfaces[2].type", "\"\""});
  expect_tokens(refused("okp4", "okp9"), {"x", "okp9", "--glasses"});
  expect_tokens(refusal(R"({"d_next": 0, "surfaces": []})"), {"x", "surfaces", "at least one"});
  expect_tokens(warning(with(deeplens, "6.0", "6.5"), "file.d_sensor"), {6.5, 6});
  EXPECT_NE(warning(with(deeplens, "\"foclen\"", "\"DOE\": {\"d\": 1}, \"foclen\""), "file.DOE"), "no warning");
  EXPECT_NE(warning(with(deeplens, "\"r\": 1.0", "\"is_square\": true, \"r\": 1.0"), "file.surfaces[0].is_square"),
            "no warning");
  for (std::size_t length = 2; length < deeplens.size(); length += 7) refusal(deeplens.substr(0, length));
}

/// A lens as crayg writes it, with materials by IOR and Abbe number.
std::string crayg_rows(const Prescription& lens) {
  std::string text = "# written by hand\n[Metadata]\nName: a lens f/3\n\n[Surfaces]\nRadius Thickness IOR ...\n";
  for (const petzval::SurfaceRow& row : lens.surfaces) {
    text += digits(row.radius) + " " + digits(row.thickness) + " " + digits(row.stop ? 0 : row.medium.nd.value_or(1)) +
            "   " + digits(row.semi_diameter.value()) + " " + digits(row.medium.vd.value_or(0)) +
            (row.medium.is_air() ? " AIR " : " UNKNOWN ") +
            (row.curved_in == petzval::Section::x   ? "CYLINDER_Y"
             : row.curved_in == petzval::Section::y ? "CYLINDER_X"
             : row.radius == 0                      ? "PLANAR"
                                                    : "SPHERICAL") +
            (row.radius == 0 ? "# flat\n" : "\n");
  }
  return text;
}

TEST(Crayg, HasTheRowsOfALensInData) {
  const Prescription lens = data_prescription("anamorphic_60mm_2x"), p = read(crayg_rows(lens));
  EXPECT_EQ(p.imported->format, "crayg");
  EXPECT_EQ(p.imported->title, "a lens f/3");
  EXPECT_EQ(p.f_number, 3);
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings[0].message;
  ASSERT_EQ(p.surfaces.size(), lens.surfaces.size());
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    EXPECT_EQ(p.surfaces[i].radius, lens.surfaces[i].radius) << i;
    EXPECT_EQ(p.surfaces[i].medium, lens.surfaces[i].medium) << i;
    EXPECT_EQ(p.surfaces[i].curved_in, lens.surfaces[i].curved_in) << i;
    EXPECT_EQ(p.surfaces[i].semi_diameter, lens.surfaces[i].semi_diameter) << i;
    EXPECT_EQ(p.surfaces[i].stop, lens.surfaces[i].stop) << i;
    EXPECT_EQ(p.surfaces[i].comment, p.surfaces[i].radius == 0 ? std::optional<std::string>("flat") : std::nullopt);
  }
  for (const auto meridian : {petzval::Meridian::x, petzval::Meridian::y}) {
    EXPECT_NEAR(petzval::first_order(compile(p), {}, meridian).effective_focal_length,
                petzval::first_order(compile(lens), {}, meridian).effective_focal_length, 1e-9);
  }
}

/// Two singlets with a variable distance.
const std::string crayg = R"([Metadata]
Name: zoom
Focal Length: 60mm
Maximum F Number: 4.5
Patent: US 1
Squeeze: 1
[Elements]
100 4 1.52 20 64.1 SCHOTT_N_BK7 SPHERICAL
-80 30 1 20 AIR ASPHERICAL
0 2 1 6 0 AIR SPHERICAL
90 3 1.62 15 36.4 UNKNOWN SPHERICAL
0 50 1 15 0 AIR SPHERICAL
[Aspheric Coefficients]
1: k=-1.5 a4=2e-7 A6=0 a8=-1e-13
[Variable Distances]
Focal Length Samples: 60 70.5
1: 31 25
4: 48 53 # film
)";

TEST(Crayg, MaterialsAspheresAndPositionsAreRead) {
  const Prescription p = read(crayg);
  EXPECT_EQ(p.source_design, "US 1");
  EXPECT_EQ(p.focal_length_mm, 60);
  EXPECT_EQ(p.f_number, 4.5);
  // IOR is rounded: the index comes from the formula.
  EXPECT_EQ(p.surfaces[0].medium.catalogue, "schott");
  EXPECT_NEAR(*p.surfaces[0].medium.nd, 1.5168, 1e-5);
  EXPECT_EQ(read(with(crayg, "1.52 ", "1.515 ")).surfaces[0].medium.nd, 1.515);
  expect_tokens(warning(with(crayg, "1.52 ", "1.58 "), "N-BK7"), {1.58, 1.5168});
  EXPECT_EQ(p.surfaces[1].conic, -1.5);
  EXPECT_EQ(p.surfaces[1].aspheric, (std::vector<petzval::AsphereTerm>{{4, 2e-7}, {8, -1e-13}}));
  EXPECT_TRUE(p.surfaces[2].stop);
  EXPECT_FALSE(p.surfaces[4].stop);
  EXPECT_EQ(p.surfaces[1].thickness, 31);
  ASSERT_EQ(p.configurations.size(), 2u);
  EXPECT_EQ(p.configurations[1].name, "70.5 mm");
  EXPECT_EQ(configured(p, "70.5 mm").surfaces[1].thickness, 25);
  EXPECT_EQ(configured(p, 1).surfaces[4].thickness, 53);
  EXPECT_EQ(configured(p, 1).focal_length_mm, 70.5);
}

TEST(Crayg, RefusalsNameLineAndValue) {
  const auto refused = [](const std::string& old, const std::string& now) { return refusal(with(crayg, old, now)); };
  expect_tokens(refused("-80 30", "-80 d1"), {"x:9", "Thickness", "\"d1\""});
  expect_tokens(refused("1.52 ", "8.52 "), {"x:8", "IOR", 8.52});
  expect_tokens(refused("90 3 1.62", "90 3"), {"x:11", "row", 6, "Housing-Radius"});
  expect_tokens(refused("AIR ASPHERICAL", "AIR TORIC"), {"x:9", "Geometry", "\"TORIC\""});
  expect_tokens(refused("1: k", "5: k"), {"x:14", "surface", "\"5\""});
  expect_tokens(refused("1: k", "3: k"), {"x:14", "surface", 3, "ASPHERICAL"});
  expect_tokens(refused("a4=2e-7", "a5=2e-7"), {"x:14", "coefficient", "\"a5\""});
  expect_tokens(refused("a4=2e-7", "a4"), {"x:14", "a4", "\"\""});
  expect_tokens(refused("1: k=-1.5 a4=2e-7 A6=0 a8=-1e-13", ""), {"x:9", "Geometry", "ASPHERICAL"});
  expect_tokens(refused("1: 31 25", "1: 31"), {"x:17", "distances", 1, 2});
  expect_tokens(refused("[Variable Distances]", "[Focus]"), {"x:15", "section", "\"[Focus]\""});
  expect_tokens(refused("Number: 4.5", "Number: fast"), {"x:4", "Maximum F Number", "\"fast\""});
  expect_tokens(refused("Number: 4.5", "Number: 0"), {"x:4", "Maximum F Number", "\"0\""});
  expect_tokens(refusal("[Metadata]\nName: x\n"), {"x", "Surfaces"});
  for (std::size_t length = 0; length < crayg.size(); length += 3) refusal(crayg.substr(0, length));
}

}  // namespace collections_test
