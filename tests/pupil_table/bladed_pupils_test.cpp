// SPDX-License-Identifier: Apache-2.0
// The pupils of lenses of revolution with bladed irises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <tuple>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil_coverage.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace bladed_pupils_test {

using namespace petzval;
using petzval::testing::Coverage;
using petzval::testing::coverage;
using petzval::testing::data_lens;
using petzval::testing::data_prescription;
using petzval::testing::declared_radius;

constexpr double pi = std::numbers::pi;

class Bladed : public ::testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(Bladed, SamplesPassAndCoverThePupil) {
  const auto& [id, f_number] = GetParam();
  const Lens open = data_lens(id);
  const double radius = declared_radius(data_prescription(id), open);
  for (const Iris& iris :
       {Iris{.blades = 5}, Iris{.blades = 5, .roundness = -1, .rotation_rad = 1}, Iris{.blades = 6, .roundness = 0.5},
        Iris{.blades = 7, .rotation_rad = -2}, Iris{.blades = 8, .roundness = 0.9}, Iris{.blades = 9}}) {
    const Lens lens = with_iris(with_f_number(open, f_number), iris);
    const Coverage c = coverage(lens, FilmPupilTable::enclosing(lens, radius), radius, 32, 2000);
    EXPECT_GT(c.mean, 0.975) << iris.blades << " " << iris.roundness;
    EXPECT_GT(c.worst, 0.93) << iris.blades << " " << iris.roundness;
    EXPECT_LE(c.missed, 1e-5) << iris.blades << " " << iris.roundness;
  }
}

INSTANTIATE_TEST_SUITE_P(FilmPupilTable, Bladed,
                         ::testing::Combine(::testing::Values("double_gauss_100mm_f2.0", "tessar_100mm_f2.8",
                                                              "fisheye_8mm_f2.8"),
                                            ::testing::Values(2.87, 5.6, 16)));

TEST(BladedPupils, CoverPupilsThatEndAbruptly) {
  for (const auto& [id, part, blades] :
       {std::tuple{"phone_5.6mm_f3.5", 0.5, 3}, std::tuple{"phone_5.6mm_f3.5", 1.0, 5},
        std::tuple{"biogon_35mm_f2.8", 0.5, 5}, std::tuple{"telephoto_100mm_f5.6", 0.5, 3},
        std::tuple{"wide_100mm_roosinov", 0.5, 20}, std::tuple{"catadioptric_mangin_1000mm_f7.5", 0.5, 8}}) {
    Lens lens = data_lens(id);
    const double radius = declared_radius(data_prescription(id), lens);
    lens = with_semi_diameter(lens, *lens.stop(), part * lens.surfaces()[*lens.stop()].semi_diameter);
    lens = with_iris(lens, {.blades = blades, .rotation_rad = 0.3});
    EXPECT_LE(coverage(lens, FilmPupilTable::enclosing(lens, radius), radius, 64, 1500).missed, 1e-5) << id;
  }
}

/// A lens with pupils clipped by rims; its only symmetry is the symmetry of the five blades.
const Iris pentagon{.blades = 5, .roundness = 0.2, .rotation_rad = 0.7};
Lens vignetting() { return with_iris(with_f_number(data_lens("double_gauss_100mm_f2.0"), 2.4), pentagon); }
constexpr double corner = 40;  // mm

TEST(BladedPupils, HaveTheSymmetryOfTheBlades) {
  const FilmPupilTable table = FilmPupilTable::enclosing(vignetting(), corner);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    const double r = corner * unit(random), azimuth = 2 * pi * unit(random), u = unit(random);
    const double v = 0.999 * unit(random);
    const auto at = [r](double angle) { return FilmPoint{r * std::sin(angle), r * std::cos(angle)}; };
    const PupilSample own = table.sample(at(azimuth), u, v);
    // Rotated by one blade.
    const double step = 2 * pi / 5, cosine = std::cos(step), sine = std::sin(step);
    EXPECT_NEAR(table.area(at(azimuth + step)) / table.area(at(azimuth)), 1, 1e-3);
    EXPECT_NEAR(table.sample_area(at(azimuth + step), cosine * own.x + sine * own.y, cosine * own.y - sine * own.x),
                own.area, 1e-5 * own.area);
    // Mirrored in the direction of the first corner.
    const double first = -pentagon.rotation_rad, mirrored = 2 * first - azimuth;
    const double turn = 2 * first, x = std::sin(turn) * own.y - std::cos(turn) * own.x,
                 y = std::sin(turn) * own.x + std::cos(turn) * own.y;
    EXPECT_NEAR(table.sample_area(at(mirrored), x, y), own.area, 1e-5 * own.area);
  }
}

TEST(BladedPupils, AreContinuousOverTheFilm) {
  const FilmPupilTable table = FilmPupilTable::enclosing(vignetting(), corner);
  for (const double v : {0.2, 0.9}) {  // at the centre of the film the azimuth is undefined
    const PupilSample centre = table.sample({0, 0}, 0.37, v), beside = table.sample({0, 1e-9}, 0.37, v);
    EXPECT_NEAR(std::hypot(centre.x - beside.x, centre.y - beside.y), 0, 1e-6);
    EXPECT_TRUE(table.contains({0, 0}, 0.99 * centre.x, 0.99 * centre.y));
    EXPECT_FALSE(table.contains({0, 0}, 3 * centre.x, 3 * centre.y));
  }
  for (const double r : {1e-6, 3.0, 20.0, 39.9}) {
    PupilSample before = table.sample({0, r}, 0.37, 0.9);
    double longest = 0;
    constexpr int steps = 20000;
    for (int i = 1; i <= steps; ++i) {
      const double azimuth = 2 * pi * i / steps;
      const PupilSample here = table.sample({r * std::sin(azimuth), r * std::cos(azimuth)}, 0.37, 0.9);
      longest = std::max(longest, std::hypot(here.x - before.x, here.y - before.y));
      before = here;
    }
    // The path around the edge is a few pupil radii long; a jump would be a fraction of a radius.
    const double radius = std::sqrt(before.area / pi);
    EXPECT_LT(longest, 0.01 * radius) << r;
  }
}

TEST(BladedPupils, RoundStopIsUsedForTiltedFilmsAndOnRequest) {
  const Lens lens = vignetting();
  const FilmPupilTable table = FilmPupilTable::enclosing(lens, corner);
  const FilmPupilTable round = FilmPupilTable::enclosing(with_iris(lens, {}), corner), same = table.with_round_stop();
  const PupilSample wanted = round.sample({20, -7}, 0.3, 0.8), found = same.sample({20, -7}, 0.3, 0.8);
  EXPECT_EQ(found.x, wanted.x);
  EXPECT_EQ(found.y, wanted.y);
  EXPECT_EQ(found.area, wanted.area);
  EXPECT_GT(found.area, table.area({20, -7}));
}

TEST(BladedPupils, StopPointsEqualTracedRays) {
  const Lens lens = vignetting();
  const FilmPupilTable table = FilmPupilTable::enclosing(lens, corner), round = table.with_round_stop();
  const double semi_diameter = lens.surfaces()[*lens.stop()].semi_diameter;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const double r = corner * unit(random), azimuth = 2 * pi * unit(random);
    const FilmPoint film{r * std::sin(azimuth), r * std::cos(azimuth)};
    const PupilSample at = round.sample(film, unit(random), unit(random));
    const Vec3<double> line{at.x - film.x, at.y - film.y, table.space().depth()};
    const double towards = towards_scene(lens, table.space()) / std::sqrt(glm::dot(line, line));
    Vec3<double> stop{0, 0, 0};
    const auto ray =
        trace<double>(lens, {{at.x, at.y, table.space().pupil_z}, line * towards},
                      {.travel = Travel::to_scene, .apertures = false}, [&](int surface, const Vec3<double>& point) {
                        if (surface == static_cast<int>(*lens.stop())) stop = point;
                      });
    if (!ray.transmitted()) continue;
    double x = 0, y = 0;
    table.stop_points<double>(1, {&film.x, &film.y, &at.x, &at.y}, {}, &x, &y);
    EXPECT_NEAR(std::hypot(x - stop.x / semi_diameter, y - stop.y / semi_diameter), 0, 5e-3) << r;
    ++met;
  }
  EXPECT_GT(met, 200);
}

}  // namespace bladed_pupils_test
