// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/calibration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using testing::data_lens;

Camera camera_of(const std::string& id, const Film& film = {.columns = 1920, .rows = 1280},
                 ModelKind model = ModelKind::exact_double) {
  return {with_focus(data_lens(id), 1e6), film, {.model = model}};
}
const Calibration& found(const std::vector<Calibration>& all, const std::string& name) {
  for (const Calibration& one : all) {
    if (one.name == name) return one;
  }
  throw Error(name + " is missing");
}

/// Raster position by OpenCV's pinhole model, written from its documentation.
Vec2<double> by_pinhole(const Calibration& c, double x, double y) {
  const auto k = [&](const char* name) {
    for (const auto& [own, value] : c.values) {
      if (own == name) return value;
    }
    return 0.0;
  };
  const double r2 = x * x + y * y;
  const double radial =
      (1 + r2 * (k("k1") + r2 * (k("k2") + r2 * k("k3")))) / (1 + r2 * (k("k4") + r2 * (k("k5") + r2 * k("k6"))));
  const double first = c.name.starts_with("opencv_") ? 0.5 : 0;  // the centre of the first pixel
  return {k("fx") * x * radial + k("cx") + first, k("fy") * y * radial + k("cy") + first};
}
Vec2<double> by_fisheye(const Calibration& c, double x, double y, double z) {
  const double r = std::hypot(x, y), a = std::atan2(r, z), a2 = a * a;
  const double d = a * (1 + a2 * (c.value("k1") + a2 * (c.value("k2") + a2 * (c.value("k3") + a2 * c.value("k4")))));
  return {c.value("fx") * d * x / r + c.value("cx") + 0.5, c.value("fy") * d * y / r + c.value("cy") + 0.5};
}

/// Calls of(x right, y down, z forward, raster) for directions in the picture.
template <class Of>
void directions(const Camera& camera, double widest, const Of& of) {
  const double pupil_z = pupils(camera.lens()).entrance.z, subject = pupil_z + 1e6;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    const double field = widest * uniform(random), azimuth = 6.283185307179586 * uniform(random);
    const Vec3<double> d{std::sin(field) * std::cos(azimuth), std::sin(field) * std::sin(azimuth), std::cos(field)};
    const Projection at = camera.project({subject * d.x, -subject * d.y, pupil_z - subject * d.z});
    if (at.status != AimStatus::converged) continue;
    of(d, at.raster), ++seen;
  }
  EXPECT_GT(seen, 50);
}

TEST(Calibration, ModelsPutPointsWhereTheCameraDoes) {
  for (const char* const id : {"double_gauss_52mm_f1.8", "planar_50mm_f1.4", "zoom_14-30mm_f4", "biogon_35mm_f2.8"}) {
    SCOPED_TRACE(id);
    const Camera camera = camera_of(id);
    const std::vector<Calibration> all = calibrations(camera);
    for (const char* const name : {"opencv_5", "opencv_8", "colmap_opencv"}) {
      const Calibration& own = found(all, name);
      directions(camera, own.widest_field_rad, [&](const Vec3<double>& d, const Vec2<double>& raster) {
        const Vec2<double> by = by_pinhole(own, d.x / d.z, d.y / d.z);
        EXPECT_LT(std::hypot(by.x - raster.x, by.y - raster.y), 1.2 * own.largest + 0.01) << name;
      });
    }
    EXPECT_LT(found(all, "opencv_8").largest, 0.5);
    EXPECT_LE(found(all, "opencv_8").rms, found(all, "opencv_5").rms + 1e-6);
  }
}

TEST(Calibration, FisheyesReachBeyond90Degrees) {
  const Camera camera = camera_of("fisheye_8mm_f2.8");
  const std::vector<Calibration> all = calibrations(camera);
  const Calibration &own = found(all, "opencv_fisheye"), &theta = found(all, "f_theta");
  EXPECT_GT(own.widest_field_rad, radians(90));
  EXPECT_LT(own.largest, 0.01);
  EXPECT_THROW(found(all, "opencv_5"), Error);
  directions(camera, own.widest_field_rad, [&](const Vec3<double>& d, const Vec2<double>& raster) {
    const Vec2<double> by = by_fisheye(own, d.x, d.y, d.z);
    EXPECT_LT(std::hypot(by.x - raster.x, by.y - raster.y), 0.05);
    const double r = std::hypot(raster.x - theta.value("cx"), raster.y - theta.value("cy"));
    const double angle =
        r * (theta.value("k1") + r * (theta.value("k2") + r * (theta.value("k3") + r * theta.value("k4"))));
    EXPECT_NEAR(angle, std::acos(d.z), 0.1 * theta.value("k1"));  // 0.1 pixels
  });
}

TEST(Calibration, IdealLensHasNoDistortion) {
  const Camera camera = camera_of("double_gauss_52mm_f1.8", {.columns = 1920, .rows = 1280}, ModelKind::thick);
  const std::vector<Calibration> all = calibrations(camera);
  const Calibration& five = found(all, "opencv_5");
  for (const char* const k : {"k1", "k2", "k3"}) EXPECT_NEAR(five.value(k), 0, 1e-5) << k;
  EXPECT_NEAR(five.value("fx"), LensDistortion(camera).focal_length_px().x, 1e-3);
  // The series of the tangent.
  EXPECT_NEAR(found(all, "kannala_brandt").value("k1"), 1.0 / 3, 2e-3);
  EXPECT_NEAR(found(all, "lensfun_poly3").value("k1"), 0, 1e-6);
}

TEST(Calibration, FollowsTheNumberOfPixels) {
  const std::vector<Calibration> small = calibrations(camera_of("planar_50mm_f1.4", {.columns = 960, .rows = 640})),
                                 large = calibrations(camera_of("planar_50mm_f1.4"));
  ASSERT_EQ(small.size(), large.size());
  for (const char* const name : {"opencv_5", "opencv_8", "opencv_fisheye"}) {
    EXPECT_NEAR(found(large, name).value("fx") / found(small, name).value("fx"), 2, 1e-5);
    EXPECT_NEAR(found(large, name).value("k1"), found(small, name).value("k1"),
                1e-4 * std::abs(found(small, name).value("k1")) + 1e-6);
  }
  for (const char* const name : {"lensfun_ptlens", "lensfun_pa"}) {
    const Calibration &one = found(small, name), &two = found(large, name);
    for (const auto& [key, value] : one.values) {
      if (key == "undistorted_f") continue;
      EXPECT_NEAR(two.value(key), value, 1e-3 * std::abs(value) + 1e-5) << key;
    }
  }
}

TEST(Calibration, LensfunLeavesTheShorterSideInPlaceAndDarkensTheCorner) {
  const Camera camera = camera_of("zoom_14-30mm_f4");
  const std::vector<Calibration> all = calibrations(camera);
  const Calibration& lens = found(all, "lensfun_ptlens");
  const double a = lens.value("a"), b = lens.value("b"), c = lens.value("c");
  directions(camera, lens.widest_field_rad, [&](const Vec3<double>& d, const Vec2<double>& raster) {
    const double q = lens.value("undistorted_f") * std::hypot(d.x, d.y) / d.z / 640;
    const double r = q * (a * q * q * q + b * q * q + c * q + 1 - a - b - c);
    EXPECT_NEAR(640 * r, std::hypot(raster.x - 960, raster.y - 640), 1.2 * lens.largest + 0.01);
  });
  const Calibration& light = found(all, "lensfun_pa");
  EXPECT_LT(1 + light.value("k1") + light.value("k2") + light.value("k3"), 0.6);
}

TEST(Calibration, LateralColourIsTheDifferenceOfWavelengths) {
  const Lens lens = with_focus(compile(testing::data_prescription("planar_50mm_f1.4"),
                                       std::array{486.1327, 587.5618, 656.2725}, {.missing_glass = MissingGlass::abbe}),
                               1e6);
  const Camera camera(lens, {.columns = 1920, .rows = 1280}, {.model = ModelKind::exact_double});
  const Calibration blue = found(calibrations(camera), "lensfun_tca_486.1327");
  const double pupil_z = pupils(lens).entrance.z, subject = pupil_z + 1e6;
  for (const double field : {2.0, 8.0, 14.0}) {
    const Vec3<double> point{0, subject * std::sin(radians(field)), pupil_z - subject * std::cos(radians(field))};
    if (field > 12) continue;  // beyond the shorter side
    const double green = 640 - camera.project(point).raster.y, r = green / 640;
    const double wanted = 640 - camera.project(point, Wavelength::nm(486.1327)).raster.y;
    EXPECT_NEAR(640 * r * (blue.value("v") + r * (blue.value("c") + r * blue.value("b"))), wanted,
                1.5 * blue.largest + 1e-3);
    EXPECT_GT(std::abs(wanted - green), 0);
  }
}

TEST(Calibration, FormatsHoldTheNumbers) {
  const Camera camera = camera_of("double_gauss_52mm_f1.8");
  int texts = 0;
  for (const Calibration& one : calibrations(camera)) {
    using enum CalibrationFormat;
    for (const CalibrationFormat format : {opencv, colmap, lensfun, usd}) {
      const std::string text = format_calibration(one, camera, format);
      texts += text.empty() ? 0 : 1;
      EXPECT_EQ(text.find("nan"), std::string::npos);
    }
  }
  EXPECT_EQ(texts, 4 + 4 + 3 + 4);
}

TEST(Calibration, CamerasWithoutARadialModelAreRefused) {
  EXPECT_THROW(calibrations(camera_of("double_gauss_52mm_f1.8", {.columns = 1920, .rows = 1280, .tilt_rad = 0.05})),
               Error);
  EXPECT_THROW(calibrations(camera_of("double_gauss_52mm_f1.8", {.columns = 1920, .rows = 1280, .shift_x_mm = 2})),
               Error);
  EXPECT_THROW(calibrations(camera_of("double_gauss_52mm_f1.8", {.columns = 1920, .rows = 1200})), Error);
  EXPECT_THROW(
      calibrations(camera_of("anamorphic_60mm_2x", {.width_mm = 18, .height_mm = 12, .columns = 1920, .rows = 1280})),
      Error);
}

/// Direction of a texel of the exit table, written from its description.
Vec3<double> exit_direction(const OmniverseTables& tables, int column, int row) {
  double x = (2.0 * column + 1) / tables.exit_size - 1, y = (2.0 * row + 1) / tables.exit_size - 1;
  const double forward = 1 - std::abs(x) - std::abs(y);
  if (forward < 0) {
    const double outer = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1), x = outer;
  }
  const double length = std::sqrt(x * x + y * y + forward * forward);
  return {x / length, y / length, -forward / length};
}

TEST(OmniverseTables, BothTablesFollowTheProjectionOfTheCamera) {
  for (const char* const id : {"double_gauss_52mm_f1.8", "fisheye_6.3mm_f2.8"}) {
    SCOPED_TRACE(id);
    const Camera camera = camera_of(id);
    const OmniverseTables tables = omniverse_tables(camera, {}, 513);
    const double pupil_z = pupils(camera.lens()).entrance.z, subject = pupil_z + 1e6;
    const auto seen = [&](const Vec3<double>& d) { return camera.project(Vec3<double>{0, 0, pupil_z} + subject * d); };
    std::mt19937 random(5);
    int lit = 0, found = 0, beyond_90 = 0;
    for (int i = 0; i < 1000; ++i) {
      const int column = static_cast<int>(random() % 1920), row = static_cast<int>(random() % 1280);
      const float* const texel = &tables.directions[3 * (static_cast<std::size_t>(row) * 1920 + column)];
      const Vec3<double> d{texel[0], texel[1], texel[2]};
      EXPECT_NEAR(std::hypot(d.x, d.y, d.z), 1, 1e-6);
      if (d.z == 1) continue;
      const Projection at = seen(d);
      if (at.status != AimStatus::converged) continue;
      EXPECT_NEAR(at.raster.x, column + 0.5, 2e-3);
      EXPECT_NEAR(at.raster.y, row + 0.5, 2e-3);
      ++lit, beyond_90 += d.z > 0;
    }
    for (int i = 0; i < 30000; ++i) {
      const int column = static_cast<int>(random() % 513), row = static_cast<int>(random() % 513);
      const float* const texel = &tables.positions[2 * (static_cast<std::size_t>(row) * 513 + column)];
      const Projection at = seen(exit_direction(tables, column, row));
      if (at.status != AimStatus::converged) continue;
      EXPECT_NEAR(texel[0] * 1920, at.raster.x, 2e-3);
      EXPECT_NEAR(texel[1] * 1280, at.raster.y, 2e-3);
      ++found;
    }
    const bool fisheye = std::string(id).starts_with("fisheye");
    EXPECT_GT(lit, fisheye ? 300 : 990);
    EXPECT_GT(found, 500);
    EXPECT_EQ(beyond_90 > 10, fisheye);
    EXPECT_EQ(tables.fit.widest_field_rad > radians(95), fisheye);
    EXPECT_EQ(tables.directions[2] == 1, fisheye);  // the corner of the picture is dark
  }
}

TEST(OmniverseTables, ErrorFallsWithTheSquareOfTheSize) {
  const Camera camera = camera_of("double_gauss_52mm_f1.8");
  const Calibration coarse = omniverse_tables(camera, {}, 257).fit, fine = omniverse_tables(camera, {}, 513).fit;
  EXPECT_NEAR(coarse.rms / fine.rms, 4, 0.4);
  EXPECT_GT(coarse.largest, coarse.rms);
  EXPECT_LT(fine.largest, 0.1);
  const Calibration fisheye = omniverse_tables(camera_of("fisheye_6.3mm_f2.8")).fit;
  EXPECT_LT(fisheye.rms, 0.005);
  EXPECT_LT(fisheye.largest, 0.2);
  EXPECT_LT(fisheye.value("left_out"), 0.005);
  EXPECT_THROW(omniverse_tables(camera, {}, 2), Error);
}

TEST(OmniverseTables, AttributesNameTheFiles) {
  const OmniverseTables tables = omniverse_tables(camera_of("double_gauss_52mm_f1.8"), {}, 65);
  const std::string text = tables.usd("a.exr", "b.exr");
  EXPECT_NE(text.find("rayEnterDirectionTexture = @./a.exr@"), std::string::npos) << text;
  EXPECT_NE(text.find("rayExitPositionTexture = @./b.exr@"), std::string::npos) << text;
  EXPECT_NE(text.find("opticalCenter = (960, 640)"), std::string::npos) << text;
}

}  // namespace
}  // namespace petzval
