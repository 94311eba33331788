// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "distorting_lenses.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace st_map_test {

using testing::data_lens;
using testing::expect_error;
using testing::small_film;

LensDistortion distortion_of(const std::string& id, const Film& film, ModelKind model = ModelKind::exact_double) {
  return LensDistortion(Camera(data_lens(id), film, {.model = model}));
}

std::size_t index(const StMap& map, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(column);
}

/// The raster position that a pixel shows.
Vec2<double> shown(const StMap& map, const Film& film, int column, int row) {
  const std::size_t i = index(map, column, row);
  return {map.s[i] * static_cast<double>(film.columns), (1 - static_cast<double>(map.t[i])) * film.rows};
}

double far_apart(const Vec2<double>& a, const Vec2<double>& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(StMap, PinholeIsTheIdentity) {
  const Film film = small_film(36);
  const StMaps maps = st_maps(distortion_of("biogon_35mm_f2.8", film, ModelKind::pinhole));
  for (const StMap* map : {&maps.undistort, &maps.redistort}) {
    ASSERT_EQ(map->width, film.columns);
    ASSERT_EQ(map->height, film.rows);
    for (int row = 0; row < film.rows; ++row) {
      for (int column = 0; column < film.columns; ++column) {
        const std::size_t i = index(*map, column, row);
        ASSERT_NEAR(map->s[i], (column + 0.5) / film.columns, 1e-6);
        ASSERT_NEAR(map->t[i], 1 - (row + 0.5) / film.rows, 1e-6);
      }
    }
  }
}

struct Case {
  std::string lens;
  Film film;
  ModelKind model = ModelKind::exact_double;
  double largest_px = 1e-3;
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.lens; }

class StMapsOf : public ::testing::TestWithParam<Case> {};

TEST_P(StMapsOf, EqualTheDistortionInBothDirections) {
  const auto& [id, film, model, largest_px] = GetParam();
  const LensDistortion distortion = distortion_of(id, film, model);
  const StMaps maps = st_maps(distortion);
  for (int i = 0; i < 300; ++i) {
    const int column = i * 7919 % maps.undistort.width, row = i * 6101 % maps.undistort.height;
    const Vec2<double> at{column + 0.5 - maps.undistort.margin_x, row + 0.5 - maps.undistort.margin_y};
    const auto wanted = distortion.distorted(at);
    ASSERT_EQ(wanted.has_value(), maps.undistort.has_source(column, row)) << at.x << ", " << at.y;
    if (!wanted) continue;
    EXPECT_LT(far_apart(shown(maps.undistort, film, column, row), *wanted), largest_px);
  }
  for (int i = 0; i < 300; ++i) {
    const int column = i * 7919 % film.columns, row = i * 6101 % film.rows;
    const auto wanted = distortion.undistorted({column + 0.5, row + 0.5});
    ASSERT_EQ(wanted.has_value(), maps.redistort.has_source(column, row)) << column << ", " << row;
    if (!wanted) continue;
    EXPECT_LT(far_apart(shown(maps.redistort, film, column, row), *wanted), largest_px);
  }
}

Film tilted_film() {
  Film film = small_film(36);
  film.tilt_rad = 0.03, film.swing_rad = -0.02;
  return film;
}

INSTANTIATE_TEST_SUITE_P(Lenses, StMapsOf,
                         ::testing::Values(Case{"double_gauss_100mm_f2_28deg", small_film(36)},
                                           Case{"biogon_35mm_f2.8", small_film(36), ModelKind::exact_float},
                                           Case{"zoom_14-30mm_f4:wide", small_film(36)},
                                           Case{"anamorphic_60mm_2x", small_film(24)},
                                           Case{"catadioptric_mangin_1000mm_f7.5", small_film(36)},
                                           Case{"double_gauss_100mm_f2_28deg", tilted_film()},
                                           Case{"biogon_35mm_f2.8", small_film(36), ModelKind::thin}));

// The chief rays end within these images.
TEST(StMap, EqualsTheDistortionUpToTheImageCircle) {
  for (const char* id : {"anamorphic_60mm_2x", "tessar_100mm_f3.5", "primoplan_100mm_f1.9", "fisheye_16mm_f2.8"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    Film film = default_film(lens, testing::data_prescription(id).image_diagonal_mm);
    film.columns = 480, film.rows = 320;
    const LensDistortion distortion(Camera(lens, film, {.model = ModelKind::exact_double}));
    const StMaps maps = st_maps(distortion);
    int seen = 0;
    for (int row = 0; row < film.rows; row += 3) {
      for (int column = 0; column < film.columns; column += 3) {
        const Vec2<double> at{column + 0.5, row + 0.5};
        const auto back = distortion.undistorted(at);
        if (!back || !maps.redistort.has_source(column, row)) continue;
        ++seen;
        const double off = far_apart(shown(maps.redistort, film, column, row), *back);
        EXPECT_LT(off, far_apart(*back, distortion.centre()) < film.columns ? 0.005 : 0.1) << column << ' ' << row;
      }
    }
    EXPECT_GT(seen, 2000);
  }
}

TEST(StMap, MarksPixelsWithoutLight) {
  const Film film = small_film(36);
  const LensDistortion distortion = distortion_of("fisheye_8mm_f2.8", film);
  const StMaps maps = st_maps(distortion);
  const StMap& lens = maps.redistort;
  EXPECT_FALSE(lens.has_source(0, 0));
  EXPECT_EQ(lens.s[0], -1);
  EXPECT_EQ(lens.t[0], -1);
  EXPECT_TRUE(lens.has_source(film.columns / 2, film.rows / 2));
  int seen = 0;
  for (int row = 0; row < film.rows; ++row) {
    for (int column = 0; column < film.columns; ++column) seen += lens.has_source(column, row);
  }
  // The image circle of 89 degrees lies within the film.
  int wanted = 0;
  for (int row = 0; row < film.rows; row += 4) {
    for (int column = 0; column < film.columns; column += 4) {
      wanted += distortion.undistorted({column + 0.5, row + 0.5}).has_value();
    }
  }
  EXPECT_NEAR(seen / (wanted * 16.0), 1, 0.02);
  EXPECT_EQ(maps.undistort.margin_x, film.columns / 2);  // limited
}

TEST(StMap, IsEmptyOutsideTheMap) {
  EXPECT_FALSE(StMap{}.has_source(0, 0));
  const StMap map{.width = 2, .height = 1, .s = {0.5f, 0.5f}, .t = {0.5f, 0.5f}};
  EXPECT_TRUE(map.has_source(1, 0));
  for (const auto& [column, row] : {std::pair{-1, 0}, {2, 0}, {0, -1}, {0, 1}, {-1, 1}}) {
    EXPECT_FALSE(map.has_source(column, row)) << column << ' ' << row;
  }
  EXPECT_FALSE((StMap{.width = 2, .height = 1, .s = {0.5f}, .t = {0.5f}}.has_source(1, 0)));
}

TEST(StMap, MarginsContainTheOverscan) {
  const Film film = small_film(36);
  const LensDistortion distortion = distortion_of("zoom_14-30mm_f4:wide", film);
  const StMaps tight = st_maps(distortion, 1);
  EXPECT_EQ(tight.undistort.width, film.columns);
  const StMaps wide = st_maps(distortion, 1.5);
  EXPECT_EQ(wide.undistort.width, film.columns * 3 / 2);
  EXPECT_EQ(wide.undistort.margin_y, film.rows / 4);
  const StMaps fitting = st_maps(distortion);
  EXPECT_EQ(fitting.redistort.width, film.columns);
  // Every pixel of the distorted image lies in the pinhole image.
  for (int row : {0, film.rows / 2, film.rows - 1}) {
    for (int column : {0, film.columns / 2, film.columns - 1}) {
      const Vec2<double> at = shown(fitting.redistort, film, column, row);
      EXPECT_GE(at.x, -fitting.undistort.margin_x);
      EXPECT_LE(at.x, film.columns + fitting.undistort.margin_x);
      EXPECT_GE(at.y, -fitting.undistort.margin_y);
      EXPECT_LE(at.y, film.rows + fitting.undistort.margin_y);
    }
  }
  // Positions are independent of the margin.
  for (int row = 7; row < film.rows; row += 50) {
    for (int column = 3; column < film.columns; column += 50) {
      const Vec2<double> a = shown(tight.undistort, film, column, row);
      const Vec2<double> b =
          shown(wide.undistort, film, column + wide.undistort.margin_x, row + wide.undistort.margin_y);
      EXPECT_LT(far_apart(a, b), 1e-3);
    }
  }
}

TEST(StMap, RefusesOverscansOutOfRange) {
  const LensDistortion distortion = distortion_of("double_gauss_100mm_f2_28deg", small_film(36));
  for (const double overscan : {0.9, 11.0, std::nan("")}) {
    expect_error([&] { st_maps(distortion, overscan); }, {"overscan", overscan});
  }
}

}  // namespace st_map_test
}  // namespace petzval
