// SPDX-License-Identifier: Apache-2.0
// Every lens of data/lenses, written in the format of another program and read again, is equal.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace round_trip_test {

using petzval::testing::expect_error;
using petzval::testing::expect_tokens;

using petzval::ExportedLens;
using petzval::Lens;
using petzval::Prescription;

const petzval::GlassCatalogue& glasses() {
  static const auto tables = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return tables;
}

/// All lenses, with the configurations of zooms.
std::vector<Prescription> lenses() {
  std::vector<Prescription> result;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const std::string id = p.id.substr(0, p.id.find(':'));
    if (result.empty() || result.back().id != id) result.push_back(petzval::testing::data_prescription(id));
  }
  return result;
}

Prescription read(const ExportedLens& written) {
  return petzval::parse_lens(written.text, "back", {.glasses = &glasses()});
}

/// Largest distance on the film between rays of both lenses, over heights and fields.
double largest_difference(const Lens& a, const Lens& b, bool rims) {
  double worst = 0;
  const double size = a.surfaces()[0].semi_diameter;
  for (const double height : {0.0, 0.3, 0.6, -0.5}) {
    for (const double slope : {0.0, 0.05, -0.1}) {
      const double norm = std::hypot(1.0, slope);
      const petzval::Ray<double> ray{{0.1 * size, height * size - 20 * slope, -20}, {0, slope / norm, 1 / norm}};
      const auto from_a = petzval::trace(a, ray), from_b = petzval::trace(b, ray);
      if (rims) {
        EXPECT_EQ(from_a.transmitted(), from_b.transmitted()) << a.name() << ' ' << height << ' ' << slope;
      }
      if (!from_a.transmitted() || !from_b.transmitted()) continue;
      const auto at_film = [](const Lens& lens, const auto& exit) {
        const double t = (lens.film_z() - exit.ray.origin.z) / exit.ray.direction.z;
        return petzval::Vec2<double>{exit.ray.origin.x + t * exit.ray.direction.x,
                                     exit.ray.origin.y + t * exit.ray.direction.y};
      };
      const auto in_a = at_film(a, from_a), in_b = at_film(b, from_b);
      worst = std::max(worst, std::hypot(in_a.x - in_b.x, in_a.y - in_b.y));
    }
  }
  return worst;
}

/// The lens with the indices of the glass formulas instead of printed indices, because formats that name glasses cannot
/// distinguish them.
Prescription by_formulas(Prescription p) {
  const auto change = [&](petzval::Medium& medium) {
    const petzval::Glass* glass = glass_of(medium, glasses());
    if (!glass || medium.nd != glass->nd || p.reference_wavelength_nm != petzval::d_line_nm) return;
    medium.nd = petzval::refractive_index(*glass, petzval::d_line_nm);
  };
  for (petzval::SurfaceRow& row : p.surfaces) change(row.medium);
  for (petzval::Configuration& c : p.configurations) {
    for (petzval::SurfaceChange& surface : c.changes) {
      if (surface.medium) change(*surface.medium);
    }
  }
  return p;
}

/// Writes and reads each lens. Returns the number of lenses that the format can hold.
int compare(const std::function<ExportedLens(const Prescription&)>& write, double tolerance, bool colours) {
  int compared = 0;
  for (const Prescription& printed : lenses()) {
    const Prescription p = colours ? by_formulas(printed) : printed;
    std::optional<ExportedLens> written;
    const std::string refusal = petzval::testing::message([&] { written = write(printed); });
    if (!written) {
      expect_tokens(refusal, {printed.name});
      continue;
    }
    const Prescription back = read(*written);
    EXPECT_EQ(back.surfaces.size() >= p.surfaces.size(), true);
    const std::size_t positions = std::max<std::size_t>(p.configurations.size(), 1);
    if (colours) {
      EXPECT_EQ(std::max<std::size_t>(back.configurations.size(), 1), positions) << p.id;
      EXPECT_EQ(std::ranges::count(back.imported->warnings, "stop", &petzval::ImportWarning::command), 0) << p.id;
    }
    const bool rims =
        std::ranges::find(written->losses, "configurations", &petzval::ImportWarning::command) == written->losses.end();
    for (std::size_t c = 0; c < (colours ? positions : 1); ++c) {
      const double size = std::abs(petzval::first_order(compile(p, {.configuration = c})).effective_focal_length);
      const double scale = std::isfinite(size) ? size : 100;
      EXPECT_LT(largest_difference(compile(p, {.configuration = c}), compile(back, {.configuration = c}), rims),
                tolerance * scale)
          << p.id << ' ' << c;
    }
    if (colours) {
      for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
        EXPECT_NEAR(back.surfaces[i].medium.nd.value_or(1), p.surfaces[i].medium.nd.value_or(1), 1e-12)
            << p.id << ' ' << i;
        if (p.surfaces[i].medium.vd && back.surfaces[i].medium.vd) {
          EXPECT_NEAR(*back.surfaces[i].medium.vd, *p.surfaces[i].medium.vd, 0.6) << p.id << ' ' << i;
        }
      }
    }
    ++compared;
  }
  return compared;
}

TEST(RoundTrip, ZemaxKeepsTheRaysOfEveryLens) {
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_zemax(p, &glasses()); }, 1e-9, true), 68);
}

TEST(RoundTrip, CodevKeepsTheRaysOfEveryLensItCanHold) {
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_codev(p, &glasses()); }, 1e-9, true), 66);
}

TEST(RoundTrip, TablesKeepTheRaysOfEveryLensOfSpheres) {
  // Planes of glass become spheres of 1e6 mm.
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_table(p); }, 3e-5, false), 40);
}

/// A glass as readers return it, with n_d and V_d from its formula.
petzval::Medium schott(const char* name) {
  const petzval::Glass& glass = *glasses().find(name, "schott");
  const auto n = [&](double nm) { return petzval::refractive_index(glass, nm); };
  const double nd = n(petzval::d_line_nm);
  return {.glass = name, .catalogue = "schott", .nd = nd, .vd = (nd - 1) / (n(486.1327) - n(656.2725))};
}

/// A stop and a lens of N-BK7, with rims.
Prescription singlet() {
  Prescription p;
  p.name = "singlet";
  p.surfaces = {{.radius = 0, .thickness = 2, .semi_diameter = 5, .stop = true},
                {.radius = 50, .thickness = 4, .medium = schott("N-BK7"), .semi_diameter = 8},
                {.radius = -50, .thickness = 48, .semi_diameter = 7}};
  return p;
}

/// True if a loss of this kind is reported.
bool lost(const ExportedLens& written, std::string_view what) {
  return std::ranges::find(written.losses, what, &petzval::ImportWarning::command) != written.losses.end();
}

using Write = ExportedLens (*)(const Prescription&);
const Write table = [](const Prescription& p) { return petzval::format_table(p); };
const Write zemax = [](const Prescription& p) { return petzval::format_zemax(p, &glasses()); };
const Write codev = [](const Prescription& p) { return petzval::format_codev(p, &glasses()); };

/// A lens of catalogue glasses: current and discontinued glasses of Schott, and glasses of other makers.
Prescription catalogue_lens() {
  Prescription p = singlet();
  p.name = "catalogue";
  p.surfaces.clear();
  for (const auto& [glass, catalogue] :
       {std::pair("BK7", "schott-legacy"), std::pair("SK16", "schott-legacy"), std::pair("SK4", "schott-legacy"),
        std::pair("F2", "schott"), std::pair("N-LAK9", "schott"), std::pair("S-BSL7", "ohara"), std::pair("F2", "cdgm"),
        std::pair("FC5", "hoya")}) {
    p.surfaces.push_back(
        {.radius = 80, .thickness = 3, .medium = {.glass = glass, .catalogue = catalogue}, .semi_diameter = 9});
    p.surfaces.push_back({.radius = -150, .thickness = 1, .semi_diameter = 9});
  }
  p.surfaces.front().stop = true;
  p.surfaces.back().thickness = 5;
  return p;
}

TEST(RoundTrip, CodevKeepsCatalogueGlassesAtEveryWavelength) {
  const Prescription lens = catalogue_lens();
  const ExportedLens written = codev(lens);
  for (const char* name :
       {"BK7_SCHOTT", "SK16_SCHOTT", "SK4_SCHOTT", "F2_SCHOTT", "NLAK9_SCHOTT", "SBSL7_OHARA", "F2_CDGM"}) {
    EXPECT_NE(written.text.find(name), std::string::npos) << name;
  }
  EXPECT_EQ(written.text.find("PRIVATE"), std::string::npos) << written.text;
  EXPECT_FALSE(lost(written, "glass"));
  const Prescription back = read(written);
  for (const double nm : {486.1327, 587.5618, 656.2725, 435.8, 500.0, 620.0, 706.5}) {
    const auto first = [nm](const Prescription& p) {
      return petzval::first_order(compile(p, std::array{nm}, {.glasses = &glasses()}));
    };
    const auto a = first(lens), b = first(back);
    EXPECT_NEAR(b.effective_focal_length / a.effective_focal_length, 1, 1e-9) << nm;
    EXPECT_NEAR(b.back_focal_distance / a.back_focal_distance, 1, 1e-9) << nm;
  }
  EXPECT_TRUE(back.imported->warnings.empty()) << back.imported->warnings.front().message;
}

// Custom indices and media without a name cannot be written as catalogue glasses.
TEST(RoundTrip, CodevNamesTheMediaThatBecomePrivate) {
  Prescription lens = catalogue_lens();
  lens.surfaces[0].medium.nd = 1.5168 + 0.0005;
  lens.surfaces[2].medium = {.nd = 1.62, .vd = 60};
  const ExportedLens written = codev(lens);
  const auto loss = std::ranges::find(written.losses, "glass", &petzval::ImportWarning::command);
  ASSERT_NE(loss, written.losses.end());
  expect_tokens(loss->message, {"PRIVATE1", "BK7", 1.5173, "PRIVATE2", 1.62});
  EXPECT_EQ(loss->message.find("SK4"), std::string::npos) << loss->message;
  const Prescription back = read(written);
  for (const double nm : {486.1327, 587.5618, 656.2725}) {
    const auto focal_length = [nm](const Prescription& p) {
      return petzval::first_order(
                 compile(p, std::array{nm}, {.glasses = &glasses(), .missing_glass = petzval::MissingGlass::abbe}))
          .effective_focal_length;
    };
    EXPECT_NEAR(focal_length(back) / focal_length(lens), 1, 1e-5) << nm;
  }
}

TEST(RoundTrip, CodevWritesNoApertureOfZero) {
  for (const auto setting : {petzval::ApertureSetting::entrance_pupil_diameter, petzval::ApertureSetting::f_number,
                             petzval::ApertureSetting::image_na}) {
    Prescription p = singlet();
    p.design.aperture = {setting, 0};
    const ExportedLens written = codev(p);
    EXPECT_TRUE(lost(written, "aperture"));
    EXPECT_GT(read(written).design.aperture.value().value, 0) << written.text;
    p.surfaces = {{.radius = 0, .thickness = 1}};  // no pupil
    EXPECT_EQ(codev(p).text.find("EPD"), std::string::npos);
  }
}

TEST(RoundTrip, ApertureOfTheDesignRoundTrips) {
  using enum petzval::ApertureSetting;
  for (const double object : {HUGE_VAL, 200.0}) {
    for (const auto& [setting, value] :
         {std::pair(entrance_pupil_diameter, 9.5), std::pair(object_na, 0.02), std::pair(working_f_number, 6.0)}) {
      Prescription p = singlet();
      p.design.object_distance_mm = object;
      p.design.aperture = {setting, value};
      for (const Write write : {zemax, codev}) {
        const Prescription back = read(write(p));
        EXPECT_EQ(back.design.object_distance_mm, object);
        // At infinity the f-numbers of CODE V are based on the focal length.
        const bool same = write != codev || setting != working_f_number || std::isfinite(object);
        EXPECT_EQ(back.design.aperture, (petzval::DesignAperture{same ? setting : f_number, value})) << write(p).text;
      }
    }
  }
  Prescription p = singlet();
  p.design.aperture = {f_number, 6};
  EXPECT_EQ(read(zemax(p)).design.aperture, p.design.aperture);
  EXPECT_EQ(read(codev(p)).design.aperture, p.design.aperture);
  p.design.aperture = {image_na, 0.06};
  EXPECT_EQ(read(codev(p)).design.aperture, p.design.aperture);
  EXPECT_TRUE(lost(zemax(p), "aperture"));
  EXPECT_EQ(read(zemax(p)).surfaces[0].semi_diameter, 5);
  p.design.aperture = {stop_size, 5};
  EXPECT_EQ(read(zemax(p)).surfaces[0].semi_diameter, 5);
  EXPECT_FALSE(lost(zemax(p), "aperture"));
  EXPECT_TRUE(lost(codev(p), "aperture"));
}

TEST(RoundTrip, NominalDataRoundTripOrAreReported) {
  Prescription p = singlet();
  for (const Write write : {zemax, codev}) EXPECT_FALSE(lost(write(p), "nominal data"));
  p.focal_length_mm = 50, p.f_number = 4, p.half_field_deg = 10, p.image_diagonal_mm = 17, p.notes = "sharp";
  p.source_design = "US 1", p.source_numbers = "a book";
  for (const bool by_design : {false, true}) {
    if (by_design) {
      p.design.aperture = {petzval::ApertureSetting::f_number, 4};
      p.design.fields = {{.y = 10}};
    }
    for (const Write write : {zemax, codev, table}) {
      const ExportedLens written = write(p);
      std::string said;
      for (const petzval::ImportWarning& loss : written.losses) {
        if (loss.command == "nominal data") said += loss.message;
      }
      const Prescription back = read(written);
      const auto kept_or_said = [&](const char* name, const auto& member) {
        EXPECT_NE(back.*member == p.*member, said.find(name) != std::string::npos)
            << name << ": " << said << written.text;
      };
      kept_or_said("focal_length_mm", &Prescription::focal_length_mm);
      kept_or_said("f_number", &Prescription::f_number);
      kept_or_said("half_field_deg", &Prescription::half_field_deg);
      kept_or_said("image_diagonal_mm", &Prescription::image_diagonal_mm);
      expect_tokens(said, {"notes", "source_numbers"});
    }
  }
}

TEST(RoundTrip, PrimaryWavelengthIsKeptIfOthersAreLost) {
  Prescription p = singlet();
  for (int i = 0; i < 30; ++i) p.design.wavelengths.push_back({450.0 + 5 * i, 1});
  p.design.primary_wavelength = 28;
  const ExportedLens written = zemax(p);
  EXPECT_TRUE(lost(written, "wavelengths"));
  const Prescription back = read(written);
  ASSERT_EQ(back.design.wavelengths.size(), 24u);
  EXPECT_EQ(back.design.wavelengths[back.design.primary_wavelength].nm, 590);
}

TEST(RoundTrip, FieldsAndWavelengthsRoundTrip) {
  using petzval::FieldKind;
  Prescription p = singlet();
  p.design.fields = {{.x = 1, .y = 0},
                     {.x = 0, .y = 2, .weight = 2, .decentre_x = 0.25, .decentre_y = 0.125},
                     {.x = 0, .y = 3, .compress_x = 0.25, .compress_y = 0.5}};
  p.design.wavelengths = {{486.5, 1}, {587.5, 3}, {656.25, 2}};
  p.design.primary_wavelength = 1;
  for (const FieldKind kind :
       {FieldKind::angle_deg, FieldKind::object_height, FieldKind::paraxial_image, FieldKind::real_image_height}) {
    p.design.field_kind = kind;
    for (const Write write : {zemax, codev}) {
      const Prescription back = read(write(p));
      EXPECT_EQ(back.design.field_kind, kind);
      EXPECT_EQ(back.design.fields, p.design.fields) << write(p).text;
      ASSERT_EQ(back.design.wavelengths.size(), 3u);
      EXPECT_EQ(back.design.wavelengths[back.design.primary_wavelength], (petzval::DesignWavelength{587.5, 3}));
    }
    EXPECT_EQ(read(zemax(p)).design.wavelengths, p.design.wavelengths);
  }
  p.design.fields[0].angle_deg = 5;
  EXPECT_TRUE(lost(codev(p), "fields"));
  EXPECT_EQ(read(zemax(p)).design.fields, p.design.fields);
  p.design.fields.resize(13);
  p.design.wavelengths.resize(25, {500, 1});
  EXPECT_TRUE(lost(zemax(p), "fields"));
  EXPECT_TRUE(lost(zemax(p), "wavelengths"));
  EXPECT_EQ(read(zemax(p)).design.fields.size(), 12u);
  EXPECT_EQ(read(zemax(p)).design.wavelengths.size(), 24u);
}

TEST(RoundTrip, RowsRoundTrip) {
  Prescription p = singlet();
  p.object_space = {.nd = 1.333, .vd = 55};
  p.surfaces[0].comment = "the stop";
  p.surfaces[0].medium = p.object_space;
  p.surfaces[1].obscuration_semi_diameter = 1;
  p.surfaces[2].semi_diameter.reset();
  for (const Write write : {zemax, codev}) {
    const Prescription back = read(write(p));
    EXPECT_EQ(back.object_space.nd, 1.333);
    EXPECT_NEAR(*back.object_space.vd, 55, 0.1);
    EXPECT_EQ(back.surfaces[0].comment, "the stop");
    EXPECT_EQ(back.surfaces[1].obscuration_semi_diameter, 1);
    EXPECT_EQ(back.surfaces[1].semi_diameter, 8);
    EXPECT_EQ(back.surfaces[1].medium, p.surfaces[1].medium);
    EXPECT_TRUE(back.surfaces[2].semi_diameter_computed);
    EXPECT_FALSE(back.surfaces[1].semi_diameter_computed);
  }
}

TEST(RoundTrip, AspheresOfEveryTypeRoundTrip) {
  using Terms = std::vector<petzval::AsphereTerm>;
  for (const Terms& terms : {Terms{{4, 1e-6}, {16, 1e-22}}, Terms{{4, 1e-6}, {18, 1e-24}}, Terms{{3, 1e-6}, {8, 1e-11}},
                             Terms{{3, 1e-6}, {11, 1e-15}}}) {
    Prescription p = singlet();
    p.surfaces[1].conic = -0.5;
    p.surfaces[1].aspheric = terms;
    EXPECT_EQ(read(zemax(p)).surfaces[1].aspheric, terms);
    EXPECT_EQ(read(zemax(p)).surfaces[1].conic, -0.5);
    if (terms[0].order % 2 == 0) {
      EXPECT_EQ(read(codev(p)).surfaces[1].aspheric, terms);
    } else {
      expect_error([&] { codev(p); }, {"singlet", "surface 1", "aspheric", 3});
    }
  }
  Prescription p = singlet();
  p.surfaces[1].aspheric = {{22, 1e-30}};
  expect_error([&] { codev(p); }, {"order", 22});
  p.surfaces[1].aspheric = {{2, 1e-3}};
  expect_error([&] { codev(p); }, {"order", 2});
}

TEST(RoundTrip, CylindersRoundTripOrAreRefused) {
  Prescription p = singlet();
  p.surfaces[1].curved_in = petzval::Section::y;
  for (const Write write : {zemax, codev}) {
    EXPECT_EQ(read(write(p)).surfaces[1].curved_in, petzval::Section::y);
  }
  p.surfaces[1].conic = -1;
  expect_error([&] { zemax(p); }, {"singlet", "surface 1", "aspheric"});
  p.surfaces[1].curved_in = petzval::Section::x;
  expect_error([&] { zemax(p); }, {"singlet", "surface 1", "cylinder"});
  expect_error([&] { codev(p); }, {"singlet", "surface 1", "cylinder"});
}

TEST(RoundTrip, ConfigurationsRoundTrip) {
  Prescription p = singlet();
  p.configurations = {{.name = "wide"},
                      {.name = "tele",
                       .changes = {{.surface = 0, .thickness = 3},
                                   {.surface = 1, .radius = 0, .conic = -0.5, .semi_diameter = 7.5},
                                   {.surface = 2, .thickness = 90}}},
                      {.name = "tele near",
                       .focus_of = "tele",
                       .subject_distance_mm = 500,
                       .changes = {{.surface = 2, .thickness = 95}}}};
  Prescription back = read(zemax(p));
  ASSERT_EQ(back.configurations.size(), 3u);
  EXPECT_EQ(back.configurations[2].subject_distance_mm, 500);
  for (const int i : {0, 1, 2}) {
    EXPECT_EQ(configured(back, i).surfaces, configured(p, i).surfaces) << i;
  }
  EXPECT_TRUE(lost(zemax(p), "focus_of"));
  back = read(codev(p));
  ASSERT_EQ(back.configurations.size(), 3u);
  EXPECT_EQ(back.configurations[2].subject_distance_mm, 500);
  EXPECT_EQ(configured(back, 2).surfaces[2].thickness, 95);
  EXPECT_EQ(configured(back, 1).surfaces[1].radius, 0);
  EXPECT_TRUE(lost(codev(p), "configurations"));
  EXPECT_TRUE(lost(codev(p), "focus_of"));
  p.configurations.pop_back();
  p.configurations[1].changes = {{.surface = 2, .thickness = 90}};
  EXPECT_TRUE(codev(p).losses.empty());
  EXPECT_TRUE(zemax(p).losses.empty());
  p.configurations[1].stop = 1;
  EXPECT_TRUE(lost(codev(p), "configurations"));
  EXPECT_TRUE(lost(zemax(p), "stop"));
}

TEST(RoundTrip, GlassesAndRimsOfConfigurationsRoundTrip) {
  Prescription p = singlet();
  p.configurations = {{.name = "a"}, {.name = "b", .changes = {{.surface = 1, .medium = schott("F2")}}}};
  EXPECT_EQ(configured(read(zemax(p)), 1).surfaces[1].medium.glass, "F2");
  EXPECT_EQ(configured(read(zemax(p)), 0).surfaces[1].medium.glass, "N-BK7");
  // A rim in one configuration only.
  p.surfaces[2].semi_diameter.reset();
  p.configurations[1].changes = {{.surface = 2, .semi_diameter = 6}};
  const Prescription back = read(zemax(p));
  EXPECT_EQ(configured(back, 1).surfaces[2].semi_diameter, 6);
  EXPECT_TRUE(configured(back, 0).surfaces[2].semi_diameter_computed);
  p.configurations[1].changes = {{.surface = 2, .semi_diameter = HUGE_VAL}};
  EXPECT_TRUE(configured(read(zemax(p)), 1).surfaces[2].semi_diameter_computed);
  // An air space instead of a lens.
  p.configurations[1].changes = {{.surface = 1, .medium = petzval::Medium{}}};
  EXPECT_EQ(configured(read(zemax(p)), 1).surfaces[1].medium, petzval::Medium{});
  EXPECT_TRUE(zemax(p).losses.empty());
  // A glass that is in no table.
  p.configurations[1].changes = {{.surface = 1, .medium = petzval::Medium{.nd = 1.7, .vd = 40}}};
  EXPECT_TRUE(lost(zemax(p), "configurations"));
  EXPECT_EQ(configured(read(zemax(p)), 1).surfaces[1].medium.glass, "N-BK7");
}

TEST(RoundTrip, PrintedIndexOfAGlass_BecomesTheFormulaAndIsReported) {
  Prescription p = singlet();
  for (const Write write : {zemax, codev}) EXPECT_FALSE(lost(write(p), "nd"));
  EXPECT_EQ(read(zemax(p)).surfaces, p.surfaces);
  const petzval::Medium formula = p.surfaces[1].medium;
  p.surfaces[1].medium.nd = 1.5168;
  for (const Write write : {zemax, codev}) {
    EXPECT_TRUE(lost(write(p), "nd"));
    EXPECT_EQ(read(write(p)).surfaces[1].medium, formula);
  }
  // The index of another melt is kept.
  p.surfaces[1].medium.nd = 1.517;
  EXPECT_FALSE(lost(zemax(p), "nd"));
  EXPECT_NEAR(read(zemax(p)).surfaces[1].medium.nd.value(), 1.517, 1e-14);
  p.surfaces[1].medium.nd.reset();
  EXPECT_EQ(read(zemax(p)).surfaces[1].medium, formula);
}

// Glass tables of 1983 have codes as names, whose indices differ from the code.
TEST(RoundTrip, CodesOfIndexAndVNumberKeepTheirNumbers) {
  Prescription p = singlet();
  const petzval::Medium code{.glass = "517642", .nd = 1.517, .vd = 64.2};
  p.surfaces[1].medium = code;
  EXPECT_EQ(read(zemax(p)).surfaces[1].medium, code);
  EXPECT_FALSE(lost(zemax(p), "glass"));
  p.surfaces[1].medium = {.glass = "517642", .catalogue = "chance-1983"};
  const Prescription back = read(zemax(p));
  EXPECT_NEAR(petzval::first_order(compile(back, {.glasses = &glasses()})).effective_focal_length,
              petzval::first_order(compile(p, {.glasses = &glasses()})).effective_focal_length, 1e-9);
}

TEST(RoundTrip, NamesOfUnknownGlassesAreReportedAsLost) {
  Prescription p = singlet();
  p.surfaces[1].medium = {.glass = "S-LAH999", .nd = 1.9, .vd = 30};
  const ExportedLens written = zemax(p);
  const auto loss = std::ranges::find(written.losses, "glass", &petzval::ImportWarning::command);
  ASSERT_NE(loss, written.losses.end());
  expect_tokens(loss->message, {"S-LAH999"});
  EXPECT_EQ(read(written).surfaces[1].medium.nd, 1.9);
}

TEST(RoundTrip, LossesAreReported) {
  const auto glass = petzval::testing::data_prescription("double_gauss_100mm_f1.35");
  EXPECT_TRUE(lost(petzval::format_table(glass), "vd"));
  const auto zoom = petzval::testing::data_prescription("zoom_57-143mm_f2.8");
  EXPECT_TRUE(lost(petzval::format_table(zoom), "configurations"));
  EXPECT_TRUE(lost(petzval::format_table(petzval::testing::data_prescription("achromat_100mm")), "stop"));
}

TEST(RoundTrip, UnmarkedStopIsTheLimitingSurface) {
  Prescription p = singlet();
  std::rotate(p.surfaces.begin(), p.surfaces.begin() + 1, p.surfaces.end());  // the stop is the last
  p.surfaces[1].thickness = 2, p.surfaces[2].thickness = 46;
  p.surfaces[2].stop = false;
  const double f_number = petzval::real_f_number(compile(p));
  for (const Write write : {zemax, codev, table}) {
    const ExportedLens written = write(p);
    EXPECT_TRUE(lost(written, "stop"));
    const Prescription back = read(written);
    EXPECT_TRUE(back.surfaces[2].stop);
    EXPECT_NEAR(petzval::real_f_number(compile(back)), f_number, 1e-9 * f_number);
  }
}

TEST(RoundTrip, ConfigurationsRestoreChangesOfTheFirstConfiguration) {
  Prescription p = singlet();
  p.configurations = {
      {.name = "a", .changes = {{.surface = 1, .thickness = 5, .radius = 60, .conic = -1, .semi_diameter = 6}}},
      {.name = "b", .changes = {{.surface = 0, .thickness = 3}}}};
  const Prescription from_zemax = read(zemax(p)), from_codev = read(codev(p));
  for (const int i : {0, 1}) {
    EXPECT_EQ(configured(from_zemax, i).surfaces, configured(p, i).surfaces) << i;
    EXPECT_EQ(configured(from_codev, i).surfaces[1].thickness, configured(p, i).surfaces[1].thickness) << i;
    EXPECT_EQ(configured(from_codev, i).surfaces[1].radius, configured(p, i).surfaces[1].radius) << i;
  }
}

TEST(RoundTrip, StopWithoutARimGetsARimWithAReport) {
  Prescription p = singlet();
  p.surfaces[0].semi_diameter.reset();
  for (const Write write : {zemax, codev, table}) EXPECT_TRUE(lost(write(p), "stop"));
}

TEST(RoundTrip, IndicesOfAnyLineRoundTrip) {
  constexpr double e_line_nm = 546.074;
  Prescription p = singlet();
  p.surfaces[2].medium = {.nd = 1.7, .vd = 40};
  p.surfaces.push_back({.radius = -80, .thickness = 40, .semi_diameter = 8});
  p.reference_wavelength_nm = e_line_nm;
  const Lens lens =
      compile(p, std::array{e_line_nm, 650.0}, {.glasses = &glasses(), .missing_glass = petzval::MissingGlass::abbe});
  for (const Write write : {zemax, codev}) {
    const Prescription back = read(write(p));
    EXPECT_EQ(back.design.wavelengths.at(0).nm, e_line_nm);
    const Lens same = compile(back, std::array{e_line_nm, 650.0},
                              {.glasses = &glasses(), .missing_glass = petzval::MissingGlass::abbe});
    for (const std::size_t wavelength : {0, 1}) {
      for (const std::size_t space : {2, 3}) {
        // Private glasses of CODE V have three indices, interpolated by a curve.
        EXPECT_NEAR(same.index(space, wavelength), lens.index(space, wavelength), 1e-4) << write(p).text;
      }
    }
  }
}

TEST(RoundTrip, TablesRequireAirInFrontAndNameTheirApertures) {
  Prescription p = singlet();
  p.f_number = 2.5;  // the lens wide open, with twice the stop
  EXPECT_EQ(read(table(p)).surfaces[0].semi_diameter, 5);
  p.object_space.nd = 1.33;
  expect_error([&] { table(p); }, {"singlet", "medium", 1.33});
}

TEST(RoundTrip, RowsOfATableWithoutARimGetTheWidestRim) {
  Prescription p;
  p.name = "small";
  p.surfaces = {{.radius = 5, .thickness = 1, .medium = {.nd = 1.5}},
                {.radius = -5, .thickness = 0.2, .semi_diameter = 0.6},
                {.thickness = 4, .semi_diameter = 0.4, .stop = true}};
  const Prescription back = read(table(p));
  ASSERT_EQ(back.surfaces.size(), 3u);
  EXPECT_EQ(back.surfaces[0].semi_diameter, 0.6);
  EXPECT_EQ(back.surfaces[1].semi_diameter, 0.6);
  EXPECT_EQ(back.surfaces[2].semi_diameter, 0.4);
}

TEST(RoundTrip, TextsWithControlCharactersRoundTripOnOneLine) {
  using namespace std::string_literals;
  Prescription p = singlet();
  p.name = "a\0b\nSURF 9\r\n!\x1B\x7F\xC2\x85z"s;
  p.source_design = "first\nENPD 3"s;
  p.surfaces[0].comment = "stop\0\n  DISZ 7"s;
  p.configurations = {{.name = "wide\n\0"s}, {.name = "tele\tX"s, .changes = {{.surface = 0, .thickness = 3}}}};
  for (const Write write : {zemax, codev, table}) {
    const ExportedLens written = write(p);
    const Prescription back = read(written);
    EXPECT_EQ(back.name, "a b SURF 9  !   z") << written.text;
    ASSERT_EQ(back.surfaces.size(), p.surfaces.size());
    for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
      EXPECT_EQ(back.surfaces[i].thickness, p.surfaces[i].thickness) << written.text;
      EXPECT_EQ(back.surfaces[i].semi_diameter, p.surfaces[i].semi_diameter);
    }
    if (write != table) {
      EXPECT_EQ(back.configurations.size(), 2u) << written.text;
    }
  }
}

/// The largest relative difference of the first-order data.
double first_order_difference(const Prescription& a, const Prescription& b) {
  const auto of_a = petzval::first_order(compile(a)), of_b = petzval::first_order(compile(b));
  return std::max(std::abs(of_b.effective_focal_length / of_a.effective_focal_length - 1),
                  std::abs(of_b.back_focal_distance - of_a.back_focal_distance) / of_a.effective_focal_length);
}

TEST(RoundTrip, ThicknessesOfZeroRoundTripThroughATable) {
  const Prescription whole = singlet();
  for (const bool first : {false, true}) {
    for (const bool stop_in_front : {false, true}) {
      Prescription p = whole;
      if (!stop_in_front) {
        p.surfaces = {{.radius = 50, .thickness = 3, .medium = {.nd = 1.5}, .semi_diameter = 9},
                      {.radius = -90, .thickness = 1, .semi_diameter = 9},
                      {.thickness = 44, .semi_diameter = 5, .stop = true}};
      }
      (first ? p.surfaces.front() : p.surfaces.back()).thickness = 0;
      const ExportedLens written = table(p);
      const Prescription back = read(written);
      ASSERT_EQ(back.surfaces.size(), p.surfaces.size());
      for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
        EXPECT_NEAR(back.surfaces[i].thickness, p.surfaces[i].thickness, 2e-9) << written.text;
      }
      EXPECT_LT(first_order_difference(p, back), 3e-5) << written.text;
    }
  }
  // Nearly afocal: the focus lies far beyond the longest thickness.
  Prescription p;
  p.name = "nearly afocal";
  p.surfaces = {{.radius = 0, .thickness = 1, .semi_diameter = 5, .stop = true},
                {.radius = 50, .thickness = 3, .medium = {.nd = 1.5}, .semi_diameter = 9},
                {.radius = 49.0000000001, .thickness = 0, .semi_diameter = 9}};
  EXPECT_NEAR(read(table(p)).surfaces.back().thickness, 0, 2e-9);
}

TEST(RoundTrip, CoatingsThatAreLostAreNamed) {
  Prescription p = singlet();
  for (const Write write : {table, zemax, codev}) EXPECT_FALSE(lost(write(p), "coating"));
  p.surfaces[1].coating = petzval::Coating::quarter_wave();
  p.surfaces[2].coating = petzval::Coating{};
  for (const Write write : {table, zemax, codev}) {
    const ExportedLens written = write(p);
    const auto loss = std::ranges::find(written.losses, "coating", &petzval::ImportWarning::command);
    ASSERT_NE(loss, written.losses.end());
    expect_tokens(loss->message, {"lost", "1, 2"});
  }
}

TEST(RoundTrip, ClosedStopsRoundTripOrAreRefused) {
  Prescription p = singlet();
  p.surfaces[0].semi_diameter = 0;
  EXPECT_EQ(read(codev(p)).surfaces[0].semi_diameter, 0);
  for (const Write write : {table, zemax}) {
    expect_error([&] { write(p); }, {"singlet", "surface 0", "semi_diameter"});
  }
  // In one position only.
  p.surfaces[0].semi_diameter = 5;
  p.configurations = {{.name = "open"}, {.name = "closed", .changes = {{.surface = 0, .semi_diameter = 0}}}};
  expect_error([&] { zemax(p); }, {"surface 0", "semi_diameter"});
}

TEST(RoundTrip, RimsOfDummyPlanesRoundTripWithObscurations) {
  Prescription p = singlet();
  p.surfaces.insert(p.surfaces.begin(), {.thickness = 3, .semi_diameter = 6, .obscuration_semi_diameter = 2});
  for (const Write write : {zemax, codev}) {
    const Prescription back = read(write(p));
    EXPECT_EQ(back.surfaces[0].semi_diameter, 6);
    EXPECT_EQ(back.surfaces[0].obscuration_semi_diameter, 2);
  }
}

TEST(RoundTrip, StopWiderThanTheDeclaredBeamIsReportedAsLost) {
  Prescription p = singlet();
  p.design.aperture = {petzval::ApertureSetting::entrance_pupil_diameter, 8};
  for (const Write write : {zemax, codev}) {
    EXPECT_TRUE(lost(write(p), "stop"));
    EXPECT_NEAR(*read(write(p)).surfaces[0].semi_diameter, 4, 1e-9);
  }
  p.design.aperture->value = 10;
  for (const Write write : {zemax, codev}) EXPECT_FALSE(lost(write(p), "stop"));
}

}  // namespace round_trip_test
