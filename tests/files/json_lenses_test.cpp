// SPDX-License-Identifier: Apache-2.0
// Lenses in the JSON of lentil and of optiland.
#include <gtest/gtest.h>

#include <string>

#include "lens_text.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace {

using petzval::Prescription;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

/// A singlet behind its stop, in the words of optiland.
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

TEST(Optiland, SaysWhatTheFileSays) {
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

TEST(Optiland, WhatIsNotALensOfRevolutionIsRefused) {
  EXPECT_NE(refusal(with(optiland, "\"cs\": {\"z\": 6}", "\"cs\": {\"z\": 6, \"rx\": 0.1}")).find("rx is 0.1"),
            std::string::npos);
  EXPECT_NE(refusal(with(optiland, "EvenAsphere", "Toroidal")).find("\"Toroidal\""), std::string::npos);
  EXPECT_EQ(read(with(optiland, "EvenAsphere", "OddAsphere")).surfaces[1].aspheric,
            (std::vector<petzval::AsphereTerm>{{2, 1e-6}}));
  EXPECT_NE(warning(with(optiland, "\"is_stop\": true", "\"is_stop\": true, \"bsdf\": 5"),
                    "file.surface_group.surfaces[1].bsdf"),
            "no warning");
  EXPECT_NE(warning(with(optiland, "\"pickups\": []", "\"pickups\": [1]"), "file.pickups"), "no warning");
  for (std::size_t length = 2; length < optiland.size(); length += 3) refusal(optiland.substr(0, length));
  EXPECT_NE(refusal("{\"surface_group\": " + std::string(100'000, '[')), "no error");
}

TEST(Optiland, WhatIsMissingOrUnknownIsSaid) {
  using petzval::testing::refuses;
  using petzval::testing::warns;
  EXPECT_TRUE(refuses(with(optiland, "\"EPD\"", "\"EPX\""), "type is \"EPX\", wanted EPD"));
  EXPECT_TRUE(refuses(with(optiland, "\"value\": 10", "\"value\": \"ten\""), "wanted a number"));
  EXPECT_TRUE(refuses(with(optiland, "\"value\": 10,", ""), "value is missing, wanted a number"));
  EXPECT_TRUE(refuses(with(optiland, "\"value\": 10", "\"value\": 1e999"), "a number is out of range"));
  EXPECT_TRUE(warns(with(optiland, "\"angle\"", "\"angel\""), "file.fields.field_type", "\"angel\" is not known"));
  EXPECT_TRUE(refuses(with(with(optiland, "EvenAsphere", "OddAsphere"), "[0, 1e-6]", "[1e-3]"),
                      "coefficients is given for order 1, wanted orders 2 to 40"));
  EXPECT_TRUE(warns(with(optiland, "RadialAperture", "RectangularAperture"), "file.surface_group.surfaces[2].aperture",
                    "is left out: it is not round"));
  const std::size_t list = optiland.find("\"surfaces\": [") + 13;
  EXPECT_TRUE(refuses(optiland.substr(0, list) + "1, 2]}}", "surfaces is 2 surfaces, wanted an object, a lens and"));
  EXPECT_TRUE(refuses(optiland.substr(0, list) + petzval::testing::repeated(10'002, "1,") + "1]}}",
                      "more than 10000 surfaces"));
  EXPECT_TRUE(refuses(optiland + std::string(1 << 24, ' '), "bytes, wanted at most"));
}

const std::string lentil =
    R"({"0001": {"company": "none", "product-name": "singlet", "year": 2000, "patent-number": "US 1",
  "focal-length-mm-patent": 50, "fstop": 5, "optical-elements-patent": [
  {"radius": 0, "thickness": [2, 3, 4], "material": "iris", "ior": 1, "abbe": 0, "housing-radius": 4.9, "lens-geometry": "planar"},
  {"radius": 50.6, "thickness": 5.2, "material": "BK7", "ior": 1.5168, "abbe": 64.2, "housing-radius": 12, "lens-geometry": "spherical"},
  {"radius": -50.6, "thickness": 47, "material": "air", "ior": 1, "abbe": 0, "housing-radius": 12, "lens-geometry": "spherical"}]}})";

TEST(Lentil, SaysWhatTheFileSays) {
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

TEST(Lentil, WhatTheFormatDoesNotSayIsRefused) {
  EXPECT_NE(refusal(with(lentil, "\"lens-geometry\": \"spherical\"", "\"lens-geometry\": \"cyl-y\"")), "no error");
  EXPECT_NE(refusal(with(lentil, "\"spherical\"", "\"aspherical\"")), "no error");
  EXPECT_NE(refusal("{\"0001\": {\"optical-elements-patent\": []}, \"0002\": {}}")
                .find("a database of 2 lenses (0001, 0002)"),
            std::string::npos);
  EXPECT_NE(warning(with(lentil, "\"year\"", "\"mass\": 5, \"year\""), "0001.mass"), "no warning");
}

TEST(Lentil, ListsAreOfNumbersAndSurfaces) {
  using petzval::testing::refuses;
  EXPECT_TRUE(refuses(with(lentil, "[2, 3, 4]", "[2, 3]"), "thickness is \"[2,3]\", wanted a number or three"));
  const std::string both =
      with(lentil, "\"year\"", "\"optical-elements-adjusted\": [{\"radius\": 50, \"thickness\": 5}], \"year\"");
  EXPECT_NE(refusal(both).find("ior is missing"), std::string::npos);
  const std::string whole = with(both, "\"thickness\": 5}", "\"thickness\": 5, \"ior\": 1.5}");
  EXPECT_EQ(read(whole).surfaces.size(), 1u);
  EXPECT_EQ(warning(whole, "optical-elements-patent"), "is left out beside optical-elements-adjusted");
  const std::size_t list = lentil.find("-patent\": [") + 11;
  EXPECT_TRUE(
      refuses(lentil.substr(0, list) + petzval::testing::repeated(10'000, "1,") + "1]}}", "more than 10000 surfaces"));
}

}  // namespace
