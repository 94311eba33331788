// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/ray_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {
namespace {

using testing::data_lens;

Camera camera_of(const std::string& id, int columns, ModelKind model = ModelKind::exact_double) {
  return {with_focus(data_lens(id), 3000), {.columns = columns, .rows = columns * 2 / 3}, {.model = model}};
}

struct Difference {
  double sine = 0, position = 0, weight = 0;
  int lit = 0, beyond_90 = 0;
};

/// Largest differences of a map from single samples of the camera, at pixels.
Difference from_samples(const RayMap& map, const Camera& camera) {
  Difference found;
  for (std::size_t s = 0; s < map.lens_samples.size(); ++s) {
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        const CameraRay own = map.ray(s, column + 0.5, row + 0.5);
        const CameraRay exact = camera.sample({.film = camera.film().point(column + 0.5, row + 0.5),
                                               .pupil_u = map.lens_samples[s].u,
                                               .pupil_v = map.lens_samples[s].v});
        EXPECT_EQ(bool(own), bool(exact)) << column << ' ' << row;
        if (!own || !exact) continue;
        const auto& [o, d] = own.ray;
        found.sine = std::max(found.sine, glm::length(glm::cross(d, exact.ray.direction)));
        found.position = std::max(found.position, glm::length(glm::cross(o - exact.ray.origin, exact.ray.direction)));
        found.weight = std::max(found.weight, std::abs(own.weight / exact.weight - 1));
        EXPECT_GT(glm::dot(d, exact.ray.direction), 0);
        ++found.lit, found.beyond_90 += d.z > 0;
      }
    }
  }
  return found;
}

TEST(RayMap, PixelsHaveTheRaysOfTheCamera) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    const Camera camera = camera_of(id, 48);
    const bool fisheye = std::string(id).starts_with("fisheye");
    for (const bool half : {false, true}) {
      const RayMap map = ray_map(camera, {.lens_samples = 7, .half = half, .threads = 2});
      EXPECT_EQ(map.layout == RayMapLayout::directions, fisheye);
      EXPECT_EQ(map.channels().size(), fisheye ? 7u : 5u);
      const Difference found = from_samples(map, camera);
      // Rounding: 2^-24 and 2^-11 of slopes or sines up to 1 and of pupils up to 40 mm; slopes of halves are
      // differences.
      const double rounding = half ? 0x1p-11 : 0x1p-24;
      EXPECT_LT(found.sine, (half && !fisheye ? 0.1 : 1.5) * rounding);
      EXPECT_LT(found.position, 60 * rounding);
      EXPECT_LT(found.weight, rounding + 1e-9);
      EXPECT_GT(found.lit, fisheye ? 3000 : 7 * 48 * 32 / 2);
      EXPECT_EQ(found.beyond_90 > 100, fisheye);
    }
  }
}

TEST(RayMap, ErrorAsAnAngleFallsWithTheSquareOfThePixel) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    for (const int samples : {1, 16}) {
      const RayMap coarse = ray_map(camera_of(id, 24), {.lens_samples = samples});
      const RayMap fine = ray_map(camera_of(id, 48), {.lens_samples = samples});
      // Pixels have half the size. Samples of clipped pupils have creases, which interpolate less well.
      const double ratio = 2 * coarse.rms_px / fine.rms_px;
      EXPECT_GT(ratio, samples == 1 ? 3.6 : 2.2) << samples;
      EXPECT_LT(ratio, 4.8) << samples;
      EXPECT_GE(coarse.largest_px, coarse.rms_px);
      EXPECT_LT(coarse.rms_px, 0.05);
    }
  }
}

TEST(RayMap, RoundingIsPartOfTheError) {
  const Camera camera = camera_of("fisheye_6.3mm_f2.8", 480);
  const RayMap exact = ray_map(camera, {.lens_samples = 1, .threads = 2});
  const RayMap half = ray_map(camera, {.lens_samples = 1, .half = true, .threads = 2});
  EXPECT_GT(half.rms_px, 3 * exact.rms_px);
  EXPECT_LT(half.largest_px, 0.05);
  // The light ends in the picture: places at its edge have no error.
  EXPECT_GT(exact.left_out, 0.001);
  EXPECT_LT(exact.left_out, 0.03);
  EXPECT_LT(exact.largest_px, 0.01);
  EXPECT_FALSE(exact.ray(0, 1, 1));
  EXPECT_FALSE(exact.ray(0, 481, 160));
  EXPECT_TRUE(exact.ray(0, 240, 160));
}

TEST(RayMap, SingleSamplesAreChiefRays) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8"}) {
    SCOPED_TRACE(id);
    const Camera camera = camera_of(id, 192);
    const RayMap map = ray_map(camera, {.lens_samples = 1});
    ASSERT_TRUE(map.chief_rays);
    for (const double field : {2.0, 6.0, std::string(id).starts_with("fisheye") ? 95.0 : 6.5}) {
      // A subject at infinity, whose chief ray meets the film at a known position.
      const AimedRay chief = chief_ray(camera.lens(), {.field_rad = radians(field), .z = -HUGE_VAL});
      ASSERT_EQ(chief.status, AimStatus::converged);
      const auto& [o, d] = chief.end.ray;
      const Vec2<double> raster = camera.film().raster(FilmPoint{0, o.y + d.y / d.z * (camera.film().z() - o.z)});
      const CameraRay own = map.ray(0, raster.x, raster.y);
      ASSERT_TRUE(own) << field;
      EXPECT_LT(glm::length(glm::cross(own.ray.direction, chief.ray.direction)), 1e-4);
      EXPECT_LT(glm::length(glm::cross(own.ray.origin - chief.ray.origin, chief.ray.direction)), 0.02);
    }
    // The weight is the irradiance.
    double sum = 0;
    for (int i = 0; i < 400; ++i) {
      sum += camera.sample({.film = {0, 0}, .pupil_u = i % 20 / 20.0, .pupil_v = (i / 20 + 0.5) / 20}).weight;
    }
    EXPECT_NEAR(map.ray(0, 96, 64).weight / (sum / 400), 1, 0.01);
  }
}

TEST(RayMap, PinholeHasOneRay) {
  const Camera camera = camera_of("double_gauss_100mm_f2.0", 48, ModelKind::pinhole);
  const RayMap map = ray_map(camera, {.lens_samples = 1});
  EXPECT_FALSE(map.chief_rays);
  EXPECT_LT(map.rms_px, 1e-4);  // slopes of a pinhole are linear in the raster
  for (std::size_t i = 0; i < 48 * 32; ++i) {
    EXPECT_LT(std::hypot(map.channel(0, 0)[i], map.channel(0, 1)[i]), 1e-4) << "x and y in the pupil";
  }
}

TEST(RayMap, ObscuredPupilsHaveARayBesideTheObscuration) {
  const Camera camera(data_lens("catadioptric_maksutov_1280mm_f14.4"), {.columns = 24, .rows = 16},
                      {.model = ModelKind::exact_double});
  const RayMap map = ray_map(camera, {.lens_samples = 1});
  EXPECT_FALSE(map.chief_rays);
  EXPECT_TRUE(map.ray(0, 12, 8));
}

TEST(RayMap, OptionsOutOfRangeAreRefused) {
  const Camera camera = camera_of("double_gauss_100mm_f2.0", 24);
  EXPECT_THROW(ray_map(camera, {.lens_samples = 0}), Error);
  EXPECT_THROW(ray_map(camera, {.lens_samples = 257}), Error);
  EXPECT_THROW(ray_map(camera_of("double_gauss_100mm_f2.0", 6000), {.lens_samples = 256}), Error);
}

}  // namespace
}  // namespace petzval
