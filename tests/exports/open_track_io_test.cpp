// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/lens_metadata.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "distorting_lenses.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace open_track_io_test {

using nlohmann::json;
using testing::data_lens;
using testing::data_prescription;
using testing::expect_tokens;
using testing::small_film;

json written(const Lens& lens, const Film& film, const LensIdentity& identity = {}) {
  return json::parse(format_open_track_io(lens, film, identity));
}

std::set<std::string> keys(const json& object) {
  std::set<std::string> result;
  for (const auto& [key, value] : object.items()) result.insert(key);
  return result;
}

/// Equation 17 of OpenLensIO 1.0, without tangential terms: radii in mm.
double radius(const json& distortion, double r) {
  const auto& k = distortion.at("radial");
  const double r2 = r * r;
  const auto polynomial = [&](int first) {
    return 1 +
           r2 * (k.at(first).get<double>() + r2 * (k.at(first + 2).get<double>() + r2 * k.at(first + 4).get<double>()));
  };
  return r * polynomial(0) / polynomial(1);
}

struct Case {
  std::string lens;
  double film_mm;
  double largest_px;  ///< of 480
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.lens; }

class OpenTrackIo : public ::testing::TestWithParam<Case> {};

// Equations 3 and 4: without distortion a scene point at the tangent x is at F x in the image.
TEST_P(OpenTrackIo, RoundTripsBetweenFilmAndScene) {
  const auto& [id, film_mm, largest_px] = GetParam();
  const Lens lens = with_focus(data_lens(id), 3000);
  const Film film = small_film(film_mm);
  const json file = written(lens, film), &sample = file.at("lens");
  const double focal_length = sample.at("pinholeFocalLength"), farthest = film.radius_mm();
  const json &in = sample.at("distortion").at(0), &out = sample.at("distortion").at(1);
  EXPECT_EQ(in.at("model"), "Brown-Conrady D-U");
  EXPECT_EQ(out.at("model"), "Brown-Conrady U-D");
  double worst = 0;
  int compared = 0;
  for (int i = 1; i <= 80; ++i) {
    const double tangent = farthest / focal_length * i / 60;
    const AimedRay chief = chief_ray(lens, {.field_rad = std::atan(tangent), .z = -3000});
    if (!chief) continue;
    const Ray<double>& ray = chief.end.ray;
    const double along = (lens.film_z() - ray.origin.z) / ray.direction.z;
    const double distorted = std::abs(ray.origin.y + along * ray.direction.y), undistorted = focal_length * tangent;
    if (distorted > farthest) break;
    ++compared;
    worst = std::max({worst, std::abs(radius(in, distorted) - undistorted) / film.pixel_mm(),
                      std::abs(radius(out, undistorted) - distorted) / film.pixel_mm()});
  }
  EXPECT_GT(compared, 40);
  EXPECT_LT(worst, largest_px);
}

INSTANTIATE_TEST_SUITE_P(Lenses, OpenTrackIo,
                         ::testing::Values(Case{"double_gauss_100mm_f2_28deg", 36, 1e-3},
                                           Case{"biogon_35mm_f2.8", 36, 1e-3}, Case{"zoom_14-30mm_f4:wide", 36, 0.3},
                                           Case{"retrofocus_100mm_f2", 120, 1e-3}));

TEST(OpenTrackIo, HasTheKeysAndUnitsOfTheStandard) {
  const Prescription p = data_prescription("biogon_35mm_f2.8");
  const Lens lens = with_focus(compile(p), 2000, {.origin = DistanceOrigin::film});
  const Film film = small_film(36);
  LensIdentity identity = identity_of(p);
  identity.make = "a \"maker\"", identity.serial_number = "12";
  const json file = written(lens, film, identity);
  EXPECT_EQ(keys(file), (std::set<std::string>{"lens", "protocol", "static"}));
  EXPECT_EQ(file.at("protocol"), json({{"name", "OpenTrackIO"}, {"version", {1, 0, 1}}}));
  EXPECT_EQ(file.at("static").at("camera"),
            json({{"activeSensorPhysicalDimensions", {{"height", 24.0}, {"width", 36.0}}},
                  {"activeSensorResolution", {{"height", 320}, {"width", 480}}}}));
  const json& fixed = file.at("static").at("lens");
  EXPECT_EQ(keys(fixed), (std::set<std::string>{"calibrationHistory", "distortionOverscanMax", "make", "model",
                                                "nominalFocalLength", "serialNumber"}));
  EXPECT_EQ(fixed.at("make"), identity.make);
  EXPECT_EQ(fixed.at("model"), p.name);
  EXPECT_EQ(fixed.at("nominalFocalLength"), p.focal_length_mm.value());
  expect_tokens(fixed.at("calibrationHistory").at(0).get<std::string>(), {480, 320, "D-U"});
  const json& sample = file.at("lens");
  EXPECT_EQ(keys(sample), (std::set<std::string>{"distortion", "entrancePupilOffset", "exposureFalloff", "fStop",
                                                 "focusDistance", "pinholeFocalLength", "projectionOffset"}));
  EXPECT_NEAR(sample.at("focusDistance").get<double>(), 2, 1e-8);
  EXPECT_NEAR(sample.at("entrancePupilOffset").get<double>(), (lens.film_z() - pupils(lens).entrance.z) / 1000, 1e-12);
  EXPECT_NEAR(sample.at("fStop").get<double>(), real_f_number(lens), 1e-12);
  const Lens coated = with_coating(lens, Coating::quarter_wave());
  const double passed = transmittance(coated, FieldPoint{.z = -std::numeric_limits<double>::infinity()}).value();
  EXPECT_NEAR(written(coated, film, identity).at("lens").at("tStop").get<double>() * std::sqrt(passed),
              area_f_number(lens), 1e-6);
  EXPECT_EQ(sample.at("projectionOffset"), json({{"x", 0.0}, {"y", 0.0}}));
  EXPECT_GE(sample.at("distortion").at(0).at("overscan").get<double>(), 1);
  const json& light = sample.at("exposureFalloff");
  const double r2 = 18 * 18, wanted = film_irradiance(lens, {18, 0}) / film_irradiance(lens, {});
  const double found =
      1 - r2 * (light.at("a1").get<double>() + r2 * (light.at("a2").get<double>() + r2 * light.at("a3").get<double>()));
  EXPECT_NEAR(found, wanted, 0.03);
}

TEST(OpenTrackIo, OmitsUnknownValues) {
  const Lens lens = with_focus(data_lens("biogon_35mm_f2.8"), std::numeric_limits<double>::infinity());
  const json file = written(lens, small_film(36));
  EXPECT_FALSE(file.at("lens").contains("focusDistance"));
  EXPECT_EQ(keys(file.at("static").at("lens")), (std::set<std::string>{"calibrationHistory", "distortionOverscanMax"}));
}

TEST(OpenTrackIo, StatesTheCentreOfAShiftedFilm) {
  Film shifted = small_film(24);
  shifted.shift_x_mm = 3, shifted.shift_y_mm = -2;
  const json sample = written(data_lens("biogon_35mm_f2.8"), shifted).at("lens");
  EXPECT_NEAR(sample.at("projectionOffset").at("x").get<double>(), 3, 1e-12);  // to the right
  EXPECT_NEAR(sample.at("projectionOffset").at("y").get<double>(), 2, 1e-12);  // down
}

TEST(OpenTrackIo, WritesTheText) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "lens.opentrackio.json";
  const Lens lens = data_lens("double_gauss_100mm_f2_28deg");
  write_open_track_io(lens, small_film(36), {}, path);
  EXPECT_GT(std::filesystem::file_size(path), 500u);
  std::filesystem::remove(path);
}

TEST(OpenTrackIo, RefusesFisheyesAndTextsThatAreNotUtf8) {
  const auto refused = [](const char* id, const LensIdentity& identity) {
    return testing::message([&] { format_open_track_io(data_lens(id), small_film(24), identity); });
  };
  expect_tokens(refused("fisheye_8mm_f2.8", {}), {"fisheye's"});
  expect_tokens(refused("biogon_35mm_f2.8", {.model = "\xff"}), {"UTF-8"});
  expect_tokens(refused("biogon_35mm_f2.8", {.make = std::string(1024, 'x')}), {"make", 1024});
}

}  // namespace open_track_io_test
}  // namespace petzval
