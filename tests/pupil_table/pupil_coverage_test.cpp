// SPDX-License-Identifier: Apache-2.0
// Tables cover the pupils of every lens up to the edge of the image circle, including small and disconnected pupils.
#include "pupil_coverage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil/pupil_boundary.hpp"

namespace pupil_coverage_test {

using namespace petzval;
using petzval::testing::Coverage;
using petzval::testing::coverage;
using petzval::testing::data_lens;
using petzval::testing::data_prescriptions;
using petzval::testing::declared_radius;
using petzval::testing::passing;

class DoubleGauss : public ::testing::TestWithParam<double> {};

TEST_P(DoubleGauss, SamplesPassAtEveryField) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2.0"), GetParam());
  constexpr double corner = 40.4;  // mm, 22 degrees
  const Coverage c = coverage(lens, FilmPupilTable::enclosing(lens, corner), corner, 64, 8000);
  RecordProperty("worst", std::to_string(c.worst));
  EXPECT_GT(c.worst, 0.98);
  EXPECT_LE(c.missed, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(FilmPupilTable, DoubleGauss, ::testing::Values(2.01, 4.0, 22.0));

TEST(FilmPupilTable, CoversThePupilsOfEveryLens) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    const double radius = declared_radius(p, lens);
    const Coverage c = coverage(lens, FilmPupilTable::enclosing(lens, radius), radius, 20, 2500);
    EXPECT_GT(c.mean, 0.93) << p.name;
    EXPECT_LE(c.missed, 1e-5) << p.name;
  }
}

TEST(FilmPupilTable, CoversSmallPupils) {
  for (const auto& [id, f_number, radius] :
       {std::tuple{"petzval_100mm_f1.25", 16.0, 21.0}, std::tuple{"modern_58mm_f0.95", 64.0, 21.0},
        std::tuple{"catadioptric_mangin_1000mm_f7.5", 16.0, 21.6}, std::tuple{"fisheye_8mm_f2.8", 32.0, 8.0},
        std::tuple{"anamorphic_60mm_2x", 16.0, 14.4}, std::tuple{"phone_5.6mm_f3.5", 11.0, 3.6}}) {
    const Lens lens = with_f_number(data_lens(id), f_number);
    const Coverage c = coverage(lens, FilmPupilTable::enclosing(lens, radius), radius, 16, 1500);
    EXPECT_GT(c.mean, 0.93) << id;
    EXPECT_LE(c.missed, 1e-5) << id;
  }
}

// Aberrations move the pupil by more than its size, so that first order does not predict its position.
TEST(FilmPupilTable, CoversTheFilmBehindTinyStops) {
  for (const auto& [id, f_number, least] :
       {std::tuple{"modern_58mm_f0.95", 1e3, 0.9}, std::tuple{"biogon_35mm_f2.8", 1e3, 0.95},
        std::tuple{"double_gauss_100mm_f2_28deg", 1e5, 0.65}, std::tuple{"tessar_100mm_f2.8", 1e5, 0.8}}) {
    const Lens lens = with_f_number(data_lens(id), f_number);
    constexpr double radius = 21.6;
    const FilmPupilTable table = FilmPupilTable::enclosing(lens, radius);
    EXPECT_EQ(table.lit_radius(), radius) << id;
    const Coverage c = coverage(lens, table, radius, 24, 2000);
    EXPECT_GT(c.mean, least) << id;
    EXPECT_LE(c.missed, 1e-3) << id;
  }
}

// The tolerance of edges is relative to the search line: a line across a face of 1e9 pupil diameters would not resolve
// the pupil.
TEST(FilmPupilTable, CoversTinyPupilsBehindHugeFaces) {
  const auto area = [](double semi_diameter) {
    Prescription p;
    p.name = "huge face";
    SurfaceRow stop, front, back;
    stop.semi_diameter = 1e-3, stop.stop = true, stop.thickness = 10;
    front.radius = 1000, front.medium.nd = 1.5, front.thickness = 5;
    back.radius = -1000, back.thickness = 900;
    front.semi_diameter = back.semi_diameter = semi_diameter;
    p.surfaces = {stop, front, back};
    return FilmPupilTable::enclosing(compile(p), 10).area({0, 5});
  };
  const double wanted = area(20);
  EXPECT_NEAR(wanted / (std::numbers::pi * 1e-6), 1, 0.1);
  for (const double semi_diameter : {1e3, 1e6, 1e100, 1e160})
    EXPECT_NEAR(area(semi_diameter) / wanted, 1, 0.02) << semi_diameter;
}

/// Fraction of the passing rays that lie outside the pupil; rays cover the last surface, seen from the film point.
double missed_anywhere(const Lens& lens, const FilmPupilTable& table, const FilmPoint& film, double widths,
                       int side = 700) {
  const LensSurface& last = lens.surfaces().back();
  const double gap = lens.film_z() - last.vertex_z, reach = widths * last.semi_diameter;
  const double scale = table.space().depth() / -gap;
  std::vector<std::array<double, 2>> places;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const double x = reach * ((2 * i + 1.0) / side - 1), y = reach * ((2 * j + 1.0) / side - 1);
      places.push_back({film.x + scale * (x - film.x), film.y + scale * (y - film.y)});
    }
  }
  const std::vector<bool> passes = passing(lens, table, film, places);
  double all = 0, missed = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!passes[i]) continue;
    all += 1, missed += !table.contains(film, places[i][0], places[i][1]);
  }
  EXPECT_GT(all, 50);
  return missed / all;
}

TEST(FilmPupilTable, CoversDisconnectedPupils) {
  // The primoplan has a sliver that is smaller than 1/48 of the last surface.
  for (const auto& [id, f_number, radius, widths, side, most] :
       {std::tuple{"catadioptric_mangin_1000mm_f7.5", 16.0, 21.6, 1.2, 700, 1e-3},
        std::tuple{"primoplan_100mm_f1.9", 45.0, 39.5, 1.2, 700, 0.05}}) {
    const Lens lens = with_f_number(data_lens(id), f_number);
    const FilmPupilTable table = FilmPupilTable::enclosing(lens, radius);
    for (const double share : {0.05, 0.3, 0.45, 0.7, 0.98}) {
      EXPECT_LE(missed_anywhere(lens, table, {0.6 * share * radius, 0.8 * share * radius}, widths, side), most)
          << id << " f/" << f_number << " at " << share;
    }
  }
}

// The table finds the edge of the image circle on films of any size.
TEST(FilmPupilTable, FindsTheEdgeOfTheImageCircle) {
  for (const auto& [id, radius] : {std::pair{"fisheye_8mm_f2.8", 13.0},
                                   {"phone_5.6mm_f3.5", 5.0},
                                   {"zoom_57-143mm_f2.8:wide", 60.0},
                                   {"catadioptric_mangin_1000mm_f7.5", 80.0}}) {
    const Lens lens = data_lens(id);
    const auto lit = [&](double height) { return !exit_pupil_boundary(lens, {0, height}).empty(); };
    for (const double beyond : {1.0, 7.3, 300.0}) {
      const FilmPupilTable table = FilmPupilTable::enclosing(lens, beyond * radius);
      const double edge = table.lit_radius();
      ASSERT_LT(edge, radius) << id;
      EXPECT_TRUE(lit(0.999 * edge)) << id << ", " << beyond << " times as far: " << edge;
      EXPECT_FALSE(lit(1.001 * edge)) << id << ", " << beyond << " times as far: " << edge;
      EXPECT_GT(table.area({0, 0.9999 * edge}), 0) << id;
      EXPECT_EQ(table.area({0, 1.0001 * edge}), 0) << id;
    }
  }
}

}  // namespace pupil_coverage_test
