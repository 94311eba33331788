// SPDX-License-Identifier: Apache-2.0
// Computed apertures of a prescription without apertures. As long as the stop limits the beam, the images equal the
// images with the given apertures.
#include "petzval/pupil/f_number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace apertures_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The prescription without apertures except the stop.
Prescription with_stop_alone(Prescription p) {
  for (SurfaceRow& row : p.surfaces) {
    if (!row.stop) row.semi_diameter.reset();
  }
  for (Configuration& configuration : p.configurations) {
    for (SurfaceChange& change : configuration.changes) {
      if (!p.surfaces[static_cast<std::size_t>(change.surface)].stop) change.semi_diameter.reset();
    }
  }
  return p;
}

/// The prescription with computed apertures scaled by `factor`.
Prescription with_apertures_times(double factor, Prescription p) {
  p = with_apertures(p);
  for (SurfaceRow& row : p.surfaces) {
    if (row.semi_diameter_computed) *row.semi_diameter *= factor;
  }
  return p;
}

bool stop_has_aperture(const Prescription& p) {
  return std::ranges::any_of(p.surfaces, [](const SurfaceRow& row) { return row.stop && row.semi_diameter; });
}

TEST(Apertures, PassTheAxialBeamAndTheDeclaredField) {
  // A plate 10 mm behind a stop of 5 mm; rays of 20 degrees have to pass.
  Prescription p;
  p.half_field_deg = 20;
  p.surfaces = {{.thickness = 10, .semi_diameter = 5, .stop = true},
                {.radius = 1e12, .thickness = 5, .medium = {.nd = 1.5}},
                {.thickness = 50}};
  const double tangent = std::tan(radians(20.0)), sine = std::sin(radians(20.0)) / 1.5;
  const double front = 5 + 10 * tangent, rear = front + 5 * sine / std::sqrt(1 - sine * sine);
  const Prescription found = with_apertures(p);
  EXPECT_NEAR(*found.surfaces[1].semi_diameter, 1.05 * front, 1e-6);
  EXPECT_NEAR(*found.surfaces[2].semi_diameter, 1.05 * rear, 1e-6);
  EXPECT_TRUE(found.surfaces[1].semi_diameter_computed);
  EXPECT_FALSE(found.surfaces[0].semi_diameter_computed);
  const Lens lens = compile(p);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lens.surfaces()[i].semi_diameter, found.surfaces[i].semi_diameter);
}

TEST(Apertures, ComputedAperturesAreComputedAgain) {
  Prescription p = with_stop_alone(testing::data_prescription("cooke_triplet_50mm_f5"));
  p.half_field_deg = 10;
  const Prescription narrow = with_apertures(p);
  Prescription wide = narrow;
  wide.half_field_deg = 20;
  wide = with_apertures(wide);
  EXPECT_GT(*wide.surfaces[0].semi_diameter, *narrow.surfaces[0].semi_diameter);
  wide.half_field_deg = 10;
  EXPECT_EQ(with_apertures(wide), narrow);
}

TEST(Apertures, JsonKeepsTheComputedMark) {
  const Prescription p = with_apertures(with_stop_alone(testing::data_prescription("cooke_triplet_50mm_f5")));
  EXPECT_EQ(parse_prescription(format_prescription(p), "p"), p);
  EXPECT_EQ(parse_lens(format_prescription(p), "p"), p);
}

TEST(Apertures, StopFollowsTheDeclaredFNumber) {
  Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  for (SurfaceRow& row : p.surfaces) row.semi_diameter.reset();
  p.f_number = 6;
  EXPECT_NEAR(real_f_number(compile(p)), 6, 1e-9);
  p.f_number.reset();
  EXPECT_GT(6, real_f_number(compile(p)));  // the edges of the elements limit the beam
}

TEST(Apertures, ZoomPositionsShareTheLargest) {
  const Prescription p =
      with_stop_alone(read_prescription(std::filesystem::path(PETZVAL_TEST_DATA) / "lenses" / "zoom_14-30mm_f4.json"));
  ASSERT_GT(p.configurations.size(), 1u);
  const Prescription all = with_apertures(p);
  for (std::size_t i = 0; i < p.configurations.size(); ++i) {
    const Lens lens = compile(p, {.configuration = i}), of_all = compile(all, {.configuration = i});
    for (std::size_t s = 0; s < lens.surface_count(); ++s) {
      EXPECT_EQ(lens.surfaces()[s].semi_diameter, of_all.surfaces()[s].semi_diameter) << i << ' ' << s;
      if (!p.surfaces[s].semi_diameter && std::isfinite(lens.surfaces()[s].semi_diameter)) {
        EXPECT_GE(*all.surfaces[s].semi_diameter, lens.surfaces()[s].semi_diameter) << i << ' ' << s;
      }
    }
  }
}

// The stop limits the beam: axial spots equal the spots with the given apertures, and larger computed apertures do not
// change the spots of the declared field.
TEST(Apertures, StopLimitsTheBeamInEveryLens) {
  // Rays near total reflection spread over the whole rear element, so that larger apertures pass more rays.
  const std::map<std::string, double> up_to_part_of_the_field{{"primoplan_100mm_f1.9", 0.7}};
  std::size_t count = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    if (!stop_has_aperture(p)) continue;
    ++count;
    const Prescription alone = with_stop_alone(p);
    const double film_z = with_focus(compile(p), infinity).film_z();
    const Lens given = with_film(compile(p), film_z), found = with_film(compile(alone), film_z);
    const Lens wide = with_film(compile(with_apertures_times(1.3, alone)), film_z);
    EXPECT_NEAR(with_focus(found, infinity).film_z(), film_z, 2e-4 * std::abs(p.focal_length_mm.value_or(100))) << p.id;

    const PsfOptions options{.samples = 4096, .pixels = 16};
    const auto image = [&](const Lens& lens, double part) {
      return point_image(lens, {radians(part * p.half_field_deg.value_or(20)), -infinity}, options);
    };
    const Psf axis = image(found, 0), axis_of_given = image(given, 0);
    EXPECT_LE(axis.size.rms_radius, 1.15 * axis_of_given.size.rms_radius + 1e-12) << p.id;
    EXPECT_GE(axis.size.rms_radius, 0.85 * axis_of_given.size.rms_radius - 1e-12) << p.id;
    // No light outside the marginal ray. Pupils larger than the paraxial pupil exceed 1 also with given apertures.
    const double beam = paraxial_f_number(found) / real_f_number(found);
    EXPECT_LE(axis.mean_throughput, 1.005 * beam * beam) << p.id;

    const auto last = up_to_part_of_the_field.find(p.id);
    for (const double part : {0.0, 0.5, 0.7, 0.85, 1.0}) {
      if (last != up_to_part_of_the_field.end() && part > last->second) continue;
      const double rms = image(found, part).size.rms_radius;
      EXPECT_NEAR(image(wide, part).size.rms_radius, rms, 0.01 * rms + 1e-12) << p.id << " at " << part;
    }
  }
  EXPECT_EQ(count, 75u);
}

// Without computed apertures, elements end where their surfaces meet, and pupils contain their chief rays.
TEST(Apertures, AreNotNeededForThePupil) {
  for (const char* id : {"cooke_triplet_50mm_f5", "sonnar_180mm_f2.8", "ernostar_100mm_f2", "retrofocus_100mm_f2.8",
                         "telephoto_100mm_f5.6", "modern_51mm_f1.25", "modern_50mm_f1.0", "ball_10mm"}) {
    const Prescription p = testing::data_prescription(id);
    Prescription unlimited = p;
    for (SurfaceRow& row : unlimited.surfaces) {
      if (!row.stop) row.semi_diameter = infinity;
    }
    const double film_z = with_focus(compile(p), infinity).film_z();
    const Lens found = with_film(compile(with_stop_alone(p)), film_z), open = with_film(compile(unlimited), film_z);
    for (const double part : {0.0, 0.7, 1.0}) {
      const FieldPoint point{radians(part * p.half_field_deg.value_or(20)), -infinity};
      const Psf a = point_image(found, point, {.samples = 4096, .pixels = 16});
      const Psf b = point_image(open, point, {.samples = 4096, .pixels = 16});
      EXPECT_NEAR(b.size.rms_radius, a.size.rms_radius, 0.01 * a.size.rms_radius) << id << " at " << part;
      EXPECT_NEAR(b.mean_throughput, a.mean_throughput, 1e-3) << id << " at " << part;
    }
  }
}

// Surfaces in the JSON of optiland have no apertures. The RMS radii are printed by optiland (tests/analysis of its
// repository, hexapolar rays) and equal the values of OpticStudio for its sample "Cooke 40 degree field".
TEST(Apertures, GiveOptilandsTripletTheSpotsOfOpticStudio) {
  const auto surface = [](double z, double radius, const std::string& glass, bool stop = false) {
    const std::string medium = glass.empty() ? R"({"type": "IdealMaterial", "index": 1.0})"
                                             : R"({"type": "Material", "name": ")" + glass + R"(", "reference": ")" +
                                                   (glass == "F2" ? "schott" : "hikari") + "\"}";
    return R"({"type": "Surface", "geometry": {"type": "StandardGeometry", "cs": {"z": )" + std::to_string(z) +
           R"(}, "radius": )" + std::to_string(radius) + R"(, "conic": 0}, "material_post": )" + medium +
           R"(, "is_stop": )" + (stop ? "true" : "false") + "},";
  };
  std::string text = R"({"version": 1.0, "aperture": {"type": "EPD", "value": 10},
    "fields": {"fields": [{"x": 0, "y": 0}, {"x": 0, "y": 14}, {"x": 0, "y": 20}], "field_type": "angle"},
    "wavelengths": {"wavelengths": [{"value": 0.48, "is_primary": false}, {"value": 0.55, "is_primary": true},
      {"value": 0.65, "is_primary": false}]}, "surface_group": {"surfaces": [
    {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"z": -Infinity}, "radius": Infinity},
     "material_post": {"type": "IdealMaterial", "index": 1.0}},)";
  text += surface(0, 22.01359, "SK16") + surface(3.25896, -435.76044, "") + surface(9.26651, -22.21328, "F2") +
          surface(10.26648, 20.29192, "", true) + surface(15.01689, 79.6836, "SK16") + surface(17.96897, -18.39533, "");
  text += R"({"type": "Surface", "geometry": {"type": "Plane", "cs": {"z": 60.17675}, "radius": Infinity},
     "material_post": {"type": "IdealMaterial", "index": 1.0}}]}})";
  const Prescription p = parse_lens(text, "triplet");
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = compile(p, std::array{480.0, 550.0, 650.0}, {.glasses = &glasses});
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) EXPECT_EQ(p.surfaces[i].semi_diameter_computed, i != 3) << i;
  struct Row {
    double field_deg;
    std::size_t wavelength;
    double rms_mm;
  };
  const Pupil entrance = pupils(lens).entrance;
  for (const auto& [field, wavelength, rms] : {Row{0, 0, 0.003791}, Row{14, 1, 0.016786}, Row{20, 2, 0.013596}}) {
    const Psf image = point_image(lens, {radians(field), -infinity}, {.samples = 16384, .wavelength = wavelength});
    EXPECT_NEAR(image.size.rms_radius, rms, (field == 0 ? 0.04 : 0.15) * rms) << field;
    EXPECT_LE(image.mean_throughput, 1.1) << field;
    // Without ray aiming the beam fills the paraxial entrance pupil instead of the stop.
    const auto launched = [&, angle_rad = radians(field)](std::size_t at) {
      std::vector<Vec2<double>> hits;
      constexpr int rings = 6;  // the default of both programs
      for (int ring = 0; ring <= rings; ++ring) {
        for (int k = 0; k < std::max(6 * ring, 1); ++k) {
          const double r = 5.0 * ring / rings, angle = 2 * std::numbers::pi * k / std::max(6 * ring, 1);
          const Ray<double> ray{{r * std::sin(angle), r * std::cos(angle), entrance.z},
                                {0, std::sin(angle_rad), std::cos(angle_rad)}};
          const auto end = trace(lens, ray, {.wavelength = at, .apertures = false}).ray;
          const double t = (lens.film_z() - end.origin.z) / end.direction.z;
          hits.push_back({end.origin.x + t * end.direction.x, end.origin.y + t * end.direction.y});
        }
      }
      return hits;
    };
    Vec2<double> centroid{0, 0};  // primary wavelength
    const auto primary = launched(1);
    for (const auto& hit : primary) centroid += hit / static_cast<double>(primary.size());
    double squares = 0;
    for (const auto& hit : launched(wavelength)) squares += glm::dot(hit - centroid, hit - centroid);
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(primary.size())), rms, 0.03 * rms) << field;
  }
}

/// Object height, paraxial image height and angle describe the same field.
TEST(DeclaredField, ObjectAndImageHeightsGiveTheSameAngle) {
  Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  const Lens lens = compile(p);
  const double focal_length = first_order(lens).effective_focal_length;
  EXPECT_NEAR(*declared_field(p, lens, FieldKind::paraxial_image, focal_length * std::tan(0.3)), 0.3, 1e-12);
  EXPECT_NEAR(*declared_field(p, lens, FieldKind::angle_deg, degrees(0.3)), 0.3, 1e-15);
  EXPECT_FALSE(declared_field(p, lens, FieldKind::object_height, 1));
  p.design.object_distance_mm = 700;
  const double magnification =
      (paraxial_image_z(lens, -700) - first_order(lens).rear_focal_z) / first_order(lens).effective_focal_length;
  const double of_object = *declared_field(p, lens, FieldKind::object_height, 120);
  EXPECT_NEAR(std::tan(of_object), 120 / (700 + pupils(lens).entrance.z), 1e-12);
  EXPECT_NEAR(*declared_field(p, lens, FieldKind::real_image_height, 120 * magnification), of_object, 1e-12);
}

TEST(DeclaredField, AnglePrecedesFieldsAndFieldsPrecedeImageDiagonal) {
  Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  const Lens lens = compile(p);
  p.design = {};
  p.half_field_deg.reset(), p.image_diagonal_mm.reset();
  EXPECT_FALSE(declared_half_field(p, lens));
  p.image_diagonal_mm = 2 * first_order(lens).effective_focal_length * std::tan(0.2);
  EXPECT_NEAR(*declared_half_field(p, lens), 0.2, 1e-12);
  p.design.fields = {{.y = 3}, {.x = 3, .y = 4}};
  EXPECT_NEAR(*declared_half_field(p, lens), radians(5), 1e-15);
  p.half_field_deg = 12;
  EXPECT_NEAR(*declared_half_field(p, lens), radians(12), 1e-15);
}

}  // namespace apertures_test
}  // namespace petzval
