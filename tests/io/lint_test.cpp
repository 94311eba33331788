// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace lint_test {

using Kind = FindingKind;
using testing::data_prescription;
using testing::expect_tokens;
using testing::Token;

/// f = 100 mm, f/5, with the film at the paraxial focus; has no findings.
Prescription singlet() {
  Prescription p;
  p.name = "singlet";
  p.focal_length_mm = 100;
  p.f_number = 5;
  p.surfaces = {{.radius = 0, .thickness = 4, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                {.radius = -50, .thickness = 100, .semi_diameter = 12}};
  return p;
}

// Films in metres or in hundredths of an inch, from hosts with wrong units.
TEST(Lint, FindsAFilmFarFromTheImageCircle) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  const double circle = image_circle_mm(lens);
  for (const double width : {0.036, 0.36, 360.0, 36000.0}) {
    const std::vector<Finding> findings = lint(lens, {.width_mm = width, .height_mm = width / 1.5});
    ASSERT_EQ(findings.size(), 1u) << width;
    EXPECT_EQ(findings[0].kind, Kind::film_size);
    EXPECT_NEAR(findings[0].found, width * std::hypot(1, 1 / 1.5), 1e-9 * width);
    EXPECT_EQ(findings[0].expected, circle);
  }
  for (const double width : {1.8, 6.4, 36.0, 60.0, 110.0}) {
    EXPECT_TRUE(lint(lens, {.width_mm = width, .height_mm = width / 1.5}).empty()) << width;
  }
  // A film shifted out of the image circle.
  EXPECT_EQ(lint(lens, {.shift_x_mm = 200}).size(), 1u);
}

TEST(Lint, FindsNonSquarePixels) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  const std::vector<Finding> findings = lint(lens, {.columns = 1920, .rows = 1080});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, Kind::pixel_shape);
  EXPECT_NEAR(findings[0].found, 0.84375, 1e-15);
  EXPECT_EQ(findings[0].expected, 1);
  expect_tokens(findings[0].message, {0.01875, 0.02222, 20.25, 1920, 1080});
  EXPECT_EQ(lint(lens, {.width_mm = 360, .height_mm = 240, .columns = 1080, .rows = 1920}).size(), 2u);
  EXPECT_EQ(lint(with_iris(lens, {.blades = 6}), {.columns = 1920, .rows = 1080}).size(), 1u);
  EXPECT_EQ(lint(lens, {.columns = 3840, .rows = 2590}).size(), 1u);
  // No finding: square within 0.5 %, square within the rounding to whole pixels, and an anamorphic lens.
  EXPECT_TRUE(lint(lens, {.columns = 3840, .rows = 2570}).empty());
  EXPECT_TRUE(lint(lens, {.columns = 10, .rows = 7}).empty());
  EXPECT_TRUE(lint(testing::data_lens("anamorphic_60mm_2x"), {.columns = 1920, .rows = 1080}).empty());
}

TEST(Lint, RefusesInvalidFilms) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const auto refusal = [&](const Film& film) { return testing::message([&] { lint(lens, film); }); };
  expect_tokens(refusal({.width_mm = 0}), {lens.name(), "film", 0, 24});
  for (const Film& film :
       {Film{.width_mm = std::nan("")}, Film{.height_mm = -24}, Film{.columns = 0}, Film{.margin_mm = -1},
        Film{.shift_x_mm = std::nan("")}, Film{.tilt_rad = 1.6}, Film{.width_mm = 2e9}, Film{.margin_mm = 2e9},
        Film{.shift_x_mm = -2e9}, Film{.shift_y_mm = 2e9}, Film{.z_mm = -2e9}, Film{.travel_mm = 2e9}}) {
    expect_tokens(refusal(film), {lens.name(), "film"});
  }
}

void expect_one(const Prescription& p, Kind kind, std::optional<int> surface, std::vector<Token> tokens) {
  const std::vector<Finding> findings = lint(p);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, kind);
  EXPECT_EQ(findings[0].surface, surface);
  if (surface) tokens.push_back("surface " + std::to_string(*surface));
  expect_tokens(findings[0].message, tokens);
}

TEST(Lint, ValidLensHasNoFindings) { EXPECT_TRUE(lint(singlet()).empty()); }

TEST(Lint, FindsAWrongFocalLength) {
  Prescription p = singlet();
  p.focal_length_mm = 101.9;
  EXPECT_TRUE(lint(p).empty());
  p.focal_length_mm = 103;
  expect_one(p, Kind::focal_length, {}, {"focal length", 100, 103});
  EXPECT_NEAR(lint(p)[0].found, 100, 1e-12);
  EXPECT_EQ(lint(p)[0].expected, 103);
  p.focal_length_mm.reset();
  EXPECT_TRUE(lint(p).empty());
}

/// The singlet scaled by a factor, with the declared data unchanged.
Prescription in_another_unit(double factor) {
  Prescription p = scale(singlet(), factor);
  p.focal_length_mm = 100;
  return p;
}

/// The singlet with all rims scaled by a factor.
Prescription with_rims(double factor) {
  Prescription p = singlet();
  p.surfaces[0].thickness = 8;  // room for the widest
  p.surfaces[1].obscuration_semi_diameter = 1;
  for (SurfaceRow& row : p.surfaces) *row.semi_diameter *= factor;
  *p.surfaces[1].obscuration_semi_diameter *= factor;
  return p;
}

TEST(Lint, FindsWrongUnits) {
  expect_one(in_another_unit(25.4), Kind::units, {}, {"focal length", 2540, 100, 25.4});
  expect_one(in_another_unit(0.1), Kind::units, {}, {"focal length", 10, 100, 0.1});
  EXPECT_EQ(lint(in_another_unit(20)).at(0).kind, Kind::focal_length);
}

TEST(Lint, FindsEveryLensInInches) {
  for (const Prescription& millimetres : testing::data_prescriptions()) {
    if (!millimetres.focal_length_mm || !millimetres.configurations.empty())
      continue;  // declared data scale with configurations
    SCOPED_TRACE(millimetres.name);
    Prescription p = scale(millimetres, 1 / 25.4);
    p.focal_length_mm = millimetres.focal_length_mm, p.image_diagonal_mm = millimetres.image_diagonal_mm;
    const auto findings = lint(p);
    EXPECT_TRUE(std::ranges::any_of(findings, [](const Finding& f) { return f.kind == Kind::units; }));
  }
}

TEST(Lint, FindsDiametersInsteadOfSemiDiameters) {
  expect_one(with_rims(2), Kind::apertures, {}, {"f-number", 2.5, 5, "diameters"});
  expect_one(with_rims(0.5), Kind::apertures, {}, {"f-number", 10, 5, "half"});
  EXPECT_EQ(lint(with_rims(1.5)).at(0).kind, Kind::f_number);
  // Otherwise the f-number would differ.
  EXPECT_EQ(lint(with_rims(1.8)).at(0).kind, Kind::f_number);
}

TEST(Lint, FindsAStopThatDoesNotLimitTheBeam) {
  Prescription p = singlet();
  p.f_number.reset();
  p.surfaces[1].semi_diameter = 7.5;
  EXPECT_TRUE(lint(p).empty());
  p.surfaces[1].semi_diameter = 5;
  expect_one(p, Kind::idle_stop, 0, {"stop", 10, "surface 1", 5});
  p.surfaces[0].semi_diameter.reset();
  EXPECT_TRUE(lint(p).empty());
}

TEST(Lint, FindsIndicesThatContradictTheGlass) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  Prescription p = singlet();
  p.focal_length_mm.reset();
  const auto index_of = [&](Medium medium) {
    p.surfaces[0].medium = std::move(medium);
    p.surfaces[1].thickness = first_order(compile(p, {.glasses = &glasses})).back_focal_distance;
    std::vector<std::string> messages;
    for (const Finding& finding : lint(p, glasses)) {
      if (finding.kind == Kind::glass_index) messages.push_back(finding.message);
    }
    return messages;
  };
  EXPECT_TRUE(index_of({.glass = "N-BK7", .catalogue = "schott", .nd = 1.52}).empty());
  const auto found = index_of({.glass = "N-BK7", .catalogue = "schott", .nd = 1.6});
  ASSERT_EQ(found.size(), 1u);
  expect_tokens(found[0], {"surface 0", "n_d", 1.6, "N-BK7", 1.5168});
  EXPECT_TRUE(index_of({.glass = "N-BK7", .nd = 1.6}).empty());
  EXPECT_TRUE(index_of({.glass = "N-NONE", .catalogue = "schott", .nd = 1.6}).empty());
}

TEST(Lint, KindsHaveDistinctNames) {
  std::set<std::string_view> names;
  for (int kind = 0; kind <= static_cast<int>(Kind::pixel_shape); ++kind) {
    names.insert(name(static_cast<Kind>(kind)));
  }
  EXPECT_EQ(names.size(), 13u);
  EXPECT_FALSE(names.contains("unknown"));
}

TEST(Repair, RepairsFindingsWithOneSolution) {
  const auto expect_changes = [](Prescription& p, const std::vector<std::vector<Token>>& tokens) {
    const std::vector<ImportWarning> changes = repair(p);
    ASSERT_EQ(changes.size(), tokens.size());
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      expect_tokens(changes[i].command + ": " + changes[i].message, tokens[i]);
    }
  };
  Prescription repaired = singlet();
  expect_changes(repaired, {});
  EXPECT_EQ(repaired, singlet());

  repaired = in_another_unit(1000);
  expect_changes(repaired, {{"units", "focal length", 100000, 100, 1000}});
  EXPECT_NEAR(repaired.surfaces[1].radius, -50, 1e-12);
  EXPECT_EQ(repaired.focal_length_mm, 100);

  for (const double factor : {0.5, 2.0}) {
    repaired = with_rims(factor);
    expect_changes(repaired, {{"apertures", factor > 1 ? "halved" : "doubled"}});
    EXPECT_EQ(repaired, with_rims(1));
  }

  Prescription p = singlet();
  p.surfaces[1].stop = true;
  p.surfaces[1].thickness = 90;
  expect_changes(p, {{"several_stops", "surface 1", 2}, {"image_distance", "surface 1", 90, 100}});
  EXPECT_NEAR(p.surfaces[1].thickness, 100, 1e-9);
  p.surfaces[1].thickness = 100;
  EXPECT_EQ(p, singlet());
}

TEST(Repair, KeepsPositionsAndAvoidsInvalidLenses) {
  const auto expect_no_change = [](const Prescription& p) {
    Prescription repaired = p;
    EXPECT_TRUE(repair(repaired).empty());
    EXPECT_EQ(repaired, p);
  };
  Prescription p = singlet();
  p.surfaces[1].radius = -1e12;  // focused beyond the longest thickness
  p.focal_length_mm.reset();
  p.f_number.reset();
  EXPECT_EQ(lint(p).at(0).kind, Kind::image_distance);
  expect_no_change(p);
  p = scale(singlet(), 1e7);  // a thickness of 1e9 mm
  p.focal_length_mm = 1e12;
  EXPECT_EQ(lint(p).at(0).kind, Kind::units);
  expect_no_change(p);

  p = in_another_unit(10);
  p.configurations = {{.name = "a"}, {.name = "b", .changes = {{.surface = 1, .thickness = 990}}}};
  EXPECT_EQ(lint(p).at(0).kind, Kind::units);
  expect_no_change(p);
}

TEST(Lint, FindsAWrongFNumber) {
  Prescription p = singlet();
  p.f_number = 4;
  expect_one(p, Kind::f_number, {}, {"f-number", 5, 4});
  p.surfaces[0].semi_diameter.reset();  // an unlimited stop gives no f-number
  EXPECT_TRUE(lint(p).empty());
}

TEST(Lint, FindsSurfacesThatCross) {
  // The rear surface bends forward by 50 - sqrt(50^2 - h^2) in a glass of 4 mm: it meets the front at a height of 19.6
  // mm.
  Prescription p = singlet();
  p.f_number.reset();
  p.surfaces[0].semi_diameter = 25;
  p.surfaces[1].semi_diameter = 19;
  EXPECT_TRUE(lint(p).empty());
  p.surfaces[1].semi_diameter = 21;
  expect_one(p, Kind::overlap, 0, {0.623795, 21});
}

// Rays from the field pass the front at its whole rim, but the rear only up to the height at which both meet.
TEST(Lint, CrossingSurfaces_NameTheHeightAndTheLightLost) {
  Prescription p = singlet();
  p.f_number.reset();
  p.surfaces[0].semi_diameter = 25;
  p.surfaces[1].semi_diameter = 25;
  // The height is sqrt(50^2 - 46^2); of light along the axis 1 - height^2 / 25^2 is lost.
  for (const Finding& finding : lint(p)) {
    if (finding.kind == Kind::overlap) expect_tokens(finding.message, {19.5959, 38.6, 0});
  }
  p.half_field_deg = 10;
  p.surfaces[0].semi_diameter = p.surfaces[1].semi_diameter = 20;
  ASSERT_EQ(lint(p).at(0).kind, Kind::overlap);
  expect_tokens(lint(p).at(0).message, {19.5959, 10});
}

TEST(Lint, IgnoresOverlapsInsideObscurations) {
  Prescription p = singlet();
  p.f_number.reset();
  p.surfaces[0].thickness = -1;  // the surfaces cross at a height of 10 mm
  p.surfaces[1].radius = 50.5;
  p.focal_length_mm.reset();
  p.surfaces[1].thickness = first_order(compile(p)).back_focal_distance;
  p.surfaces[0].semi_diameter = p.surfaces[1].semi_diameter = 15;
  EXPECT_EQ(lint(p).at(0).kind, Kind::overlap);
  p.surfaces[1].obscuration_semi_diameter = 11;
  EXPECT_TRUE(lint(p).empty());
  p.surfaces[1].obscuration_semi_diameter = 9;
  EXPECT_EQ(lint(p).at(0).kind, Kind::overlap);
}

TEST(Lint, FollowsTheLightBehindMirrors) {
  for (const bool rims : {true, false}) {
    Prescription p = data_prescription("catadioptric_mangin_1000mm_f7.5");
    if (!rims) {
      for (SurfaceRow& row : p.surfaces) row.semi_diameter.reset();
      p.f_number.reset();
    }
    const auto crosses = [](const Finding& f) { return f.kind == Kind::overlap && f.surface == 3; };
    EXPECT_TRUE(std::ranges::none_of(lint(p), crosses)) << rims;
    p.surfaces[3].thickness = 2;  // as if light passed through the mirror
    EXPECT_TRUE(std::ranges::any_of(lint(p), crosses)) << rims;
  }
}

TEST(Lint, ChecksCylindersInBothSections) {
  Prescription p = singlet();
  p.focal_length_mm.reset();
  p.f_number.reset();
  p.surfaces[1].thickness = 0;
  p.surfaces.push_back({.radius = 0, .thickness = 2, .medium = {.nd = 1.5}, .semi_diameter = 12});
  p.surfaces.push_back({.radius = 0, .semi_diameter = 12});
  for (const Section section : {Section::x, Section::y}) {
    p.surfaces[1].curved_in = section;
    p.surfaces[1].radius = 50;
    bool crosses = false;
    for (const Finding& finding : lint(p)) crosses = crosses || finding.kind == Kind::overlap;
    EXPECT_TRUE(crosses);
  }
}

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Radius 50 and -40 mm, 6 mm thick, then a plane 3 mm behind.
Prescription spheres(double front_rim, double rear_rim) {
  Prescription p;
  p.name = "spheres";
  p.surfaces = {{.radius = 50, .thickness = 6, .medium = {.nd = 1.5}, .semi_diameter = front_rim, .stop = true},
                {.radius = -40, .thickness = 3, .semi_diameter = rear_rim},
                {.radius = 0, .thickness = 90, .semi_diameter = 2}};
  return p;
}

TEST(EdgeThicknesses, OfSpheresHaveAClosedForm) {
  const auto sag = [](double radius, double h) {
    return radius - std::copysign(std::sqrt(radius * radius - h * h), radius);
  };
  for (const auto& [front_rim, rear_rim] : {std::pair(8.0, 10.0), std::pair(10.0, 8.0), std::pair(15.0, 15.0)}) {
    const double height = std::max(front_rim, rear_rim);
    const auto edges = edge_thicknesses(compile(spheres(front_rim, rear_rim)));
    ASSERT_EQ(edges.size(), 3u);
    ASSERT_TRUE(edges[0] && edges[1]);
    EXPECT_NEAR(*edges[0], 6 + sag(-40, height) - sag(50, height), 1e-14);
    EXPECT_NEAR(*edges[1], 3 - sag(-40, rear_rim), 1e-14);
    EXPECT_FALSE(edges[2]);
  }
  // The surfaces meet at 16.0 mm. Rims beyond give a negative edge, although the compiled apertures end there.
  EXPECT_LT(*edge_thicknesses(compile(spheres(18, 18)))[0], -1.5);
}

TEST(EdgeThicknesses, AreAbsentBeyondASurfaceAndForUnlimitedRims) {
  EXPECT_FALSE(edge_thicknesses(compile(spheres(45, 10)))[0]);
  EXPECT_TRUE(edge_thicknesses(compile(spheres(45, 10)))[1]);
  EXPECT_FALSE(edge_thicknesses(compile(spheres(infinite, 10)))[0]);
  EXPECT_FALSE(edge_thicknesses(compile(spheres(10, infinite)))[1]);
  Prescription cylinder = spheres(10, 10);
  cylinder.surfaces[1].curved_in = Section::x;
  EXPECT_FALSE(edge_thicknesses(compile(cylinder))[0]);
  EXPECT_FALSE(edge_thicknesses(compile(cylinder))[1]);
}

TEST(EdgeThicknesses, OfAnAsphereIncludeItsTerms) {
  Prescription p = spheres(10, 10);
  const double sphere = *edge_thicknesses(compile(p))[0];
  p.surfaces[1].aspheric = {{4, 2e-5}};
  EXPECT_NEAR(*edge_thicknesses(compile(p))[0] - sphere, 0.2, 1e-13);
}

TEST(EdgeThicknesses, ScaleWithTheLens) {
  for (const char* id : {"double_gauss_100mm_f1.35", "cine_100mm_t1.3", "mirror_ritchey_chretien_57.6m_f24"}) {
    const Prescription p = data_prescription(id);
    const auto edges = edge_thicknesses(compile(p)), scaled = edge_thicknesses(compile(scale(p, 4)));
    ASSERT_EQ(edges.size(), scaled.size());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      ASSERT_EQ(edges[i].has_value(), scaled[i].has_value()) << id << ' ' << i;
      if (!edges[i]) continue;
      EXPECT_NEAR(*scaled[i], 4 * *edges[i], 1e-12 * std::abs(*scaled[i])) << id << ' ' << i;
    }
  }
}

// A reversed lens has the same spaces in reverse order, with equal edges.
TEST(EdgeThicknesses, OfAReversedLensAreReversed) {
  const Prescription p = data_prescription("double_gauss_100mm_f1.35");
  Prescription reversed = p;
  const std::size_t count = p.surfaces.size();
  for (std::size_t i = 0; i < count; ++i) {
    SurfaceRow& row = reversed.surfaces[i];
    row = p.surfaces[count - 1 - i];
    row.radius = -row.radius;
    if (i + 1 < count) row.thickness = p.surfaces[count - 2 - i].thickness;
    if (i + 1 < count) row.medium = p.surfaces[count - 2 - i].medium;
    if (i + 1 == count) row.medium = {};
  }
  const auto edges = edge_thicknesses(compile(p)), back = edge_thicknesses(compile(reversed));
  std::size_t compared = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    ASSERT_EQ(edges[i].has_value(), back[count - 2 - i].has_value()) << i;
    if (!edges[i]) continue;
    EXPECT_NEAR(*edges[i], *back[count - 2 - i], 1e-12) << i;
    ++compared;
  }
  EXPECT_EQ(compared, count - 2);  // the fifth surface ends at its equator, before the rim of the fourth
}

// A mirrored path: light that runs towards -z passes the same gap.
TEST(EdgeThicknesses, BehindAMirrorAreMeasuredAlongTheLight) {
  Prescription p;
  p.name = "mirrors";
  p.surfaces = {{.radius = -200, .thickness = -50, .semi_diameter = 20, .stop = true, .mirror = true},
                {.radius = 0, .thickness = 40, .semi_diameter = 5, .mirror = true},
                {.radius = 0, .thickness = 10, .semi_diameter = 5}};
  const auto edges = edge_thicknesses(compile(p));
  EXPECT_NEAR(*edges[0], 50 - (200 - std::sqrt(200 * 200 - 20 * 20)), 1e-12);
  EXPECT_NEAR(*edges[1], 40, 1e-12);
}

TEST(Lint, CountsSurfacesOfMessagesFromTheGivenNumber) {
  Prescription p = singlet();
  p.surfaces[0].semi_diameter = 50;  // the stop passes more than surface 1
  const auto from_zero = lint(p, glass_tables()), from_one = lint(p, glass_tables(), 1);
  ASSERT_EQ(from_zero.size(), from_one.size());
  const auto idle = std::ranges::find(from_one, Kind::idle_stop, &Finding::kind);
  ASSERT_NE(idle, from_one.end());
  EXPECT_EQ(idle->surface, 0);
  expect_tokens(idle->message, {"surface 1: ", "surface 2 clips"});
  expect_tokens(from_zero[static_cast<std::size_t>(idle - from_one.begin())].message,
                {"surface 0: ", "surface 1 clips"});
}

TEST(Lint, FindsARimBeyondTheEndOfAnAsphere) {
  Prescription p = singlet();
  p.surfaces[1].aspheric = {{8, -std::pow(5, -7) / 2}};
  const std::vector<Finding> findings = lint(p);
  const auto rim = std::ranges::find(findings, Kind::semi_diameter, &Finding::kind);
  ASSERT_NE(rim, findings.end());
  EXPECT_EQ(rim->surface, 1);
  EXPECT_EQ(rim->found, 12);
  EXPECT_NEAR(rim->expected, 4.95, 0.05);  // height at which the slope is 4
}

TEST(Lint, FindsASemiDiameterBeyondTheSurface) {
  Prescription p = singlet();
  p.surfaces[1].semi_diameter = 51;
  expect_one(p, Kind::semi_diameter, 1, {"semi_diameter", 51, 50});
  p.surfaces[1].conic = -1;  // a paraboloid has no equator
  EXPECT_TRUE(lint(p).empty());
  p.surfaces[1].conic = 3;
  EXPECT_NEAR(lint(p).at(0).expected, 25, 1e-12);
  p.surfaces[1].conic = -0.75;
  EXPECT_TRUE(lint(p).empty());
}

TEST(Lint, FindsARimThatOnlyTheAxisPasses) {
  Prescription p = singlet();
  p.surfaces[1].semi_diameter = 0;
  expect_one(p, Kind::semi_diameter, 1, {"semi_diameter", 0});
  EXPECT_EQ(lint(p)[0].found, 0);
  EXPECT_EQ(lint(p)[0].expected, 50);
  p = singlet();
  p.surfaces[0].semi_diameter = 0;  // a closed iris
  for (const Finding& finding : lint(p)) EXPECT_NE(finding.kind, Kind::semi_diameter) << finding.message;
  p.surfaces[0].stop = false;
  bool found = false;
  for (const Finding& finding : lint(p)) found = found || (finding.kind == Kind::semi_diameter && finding.surface == 0);
  EXPECT_TRUE(found);
}

TEST(Lint, FindsMissingAndMultipleStops) {
  Prescription p = singlet();
  p.surfaces[0].stop = false;
  expect_one(p, Kind::no_stop, {}, {"stop"});
  p.surfaces[0].stop = p.surfaces[1].stop = true;
  expect_one(p, Kind::several_stops, 1, {"stops", 2});
}

TEST(Lint, FindsAFilmAwayFromTheFocus) {
  Prescription p = singlet();
  p.surfaces[1].thickness = 97;
  expect_one(p, Kind::image_distance, 1, {"film", 97, "focus", 100});
  p.surfaces[1].thickness = 101;
  EXPECT_TRUE(lint(p).empty());
}

TEST(Lint, AcceptsLensesWithoutFocalLengthOrRims) {
  Prescription p;
  p.surfaces = {{.medium = {.nd = 1.5}, .stop = true}};
  EXPECT_TRUE(lint(p).empty());
  p.focal_length_mm = 50;
  expect_one(p, Kind::focal_length, {}, {"focal length", "inf", 50});
}

TEST(Lint, RefusesInvalidPrescriptionsOnly) {
  Prescription p = singlet();
  p.surfaces[0].thickness = std::nan("");
  EXPECT_THROW(lint(p), Error);
}

// Known overlaps in the data. Most of these lenses have estimated diameters.
TEST(Lint, DataHasTheKnownOverlapsOnly) {
  const std::map<std::string, std::vector<int>> known{
      {"anamorphic_60mm_2x", {11}},       {"speed_panchro_26mm_f2", {4}},
      {"biotar_100mm_f1.4", {4}},         {"double_gauss_100mm_f1.7_substitute", {3}},
      {"modern_50mm_f1.0", {6}},          {"retrofocus_100mm_f2", {3}},
      {"telephoto_200mm_f1.8", {3}},      {"telephoto_392mm_f2.9", {12, 23}},
      {"tessar_100mm_f5.5_1902", {0, 6}}, {"zoom_70-210mm_f4:middle", {6}},
      {"zoom_70-210mm_f4:tele", {6}},     {"zoom_70-210mm_f4:wide", {6}},
  };
  std::size_t count = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    std::vector<int> overlaps;
    for (const Finding& finding : lint(p)) {
      EXPECT_EQ(finding.kind, Kind::overlap) << p.id << ": " << finding.message;
      overlaps.push_back(finding.surface.value_or(-1));
    }
    const auto wanted = known.find(p.id);
    EXPECT_EQ(overlaps, wanted == known.end() ? std::vector<int>{} : wanted->second) << p.id;
    ++count;
  }
  EXPECT_EQ(count, 75u);
}

}  // namespace lint_test
}  // namespace petzval
