// SPDX-License-Identifier: Apache-2.0
// The pupils of films behind lenses with cylinders, tabulated over both axes of the film.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil_coverage.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace film_cells_test {

using namespace petzval;
using petzval::testing::Coverage;
using petzval::testing::coverage;
using petzval::testing::data_lens;
using petzval::testing::passing;

constexpr double format = 14.4;  ///< mm: half the diagonal of the film of anamorphic_60mm_2x, 21.95 x 18.6 mm

Lens anamorphic(double f_number) {
  const Lens open = data_lens("anamorphic_60mm_2x");
  return f_number > 0 ? with_f_number(open, f_number) : open;
}

class Anamorphic : public ::testing::TestWithParam<double> {};

TEST_P(Anamorphic, SamplesPassAndCoverThePupil) {
  const Lens lens = anamorphic(GetParam());
  const Coverage c = coverage(lens, FilmPupilTable::enclosing(lens, format), format, 200, 2000);
  EXPECT_GT(c.mean, 0.95);
  EXPECT_LE(c.missed, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(FilmCells, Anamorphic, ::testing::Values(0, 4, 8, 16, 32, 45, 64));

/// Irradiance of a film point in a scene of radiance 1, by rays through uniform points of an area in the pupil plane.
template <class PlaceAt>
double irradiance(const Lens& lens, const FilmPupilTable& table, const FilmPoint& film, const PlaceAt& place_at) {
  constexpr std::uint32_t count = 1 << 16;
  std::vector<std::array<double, 2>> places;
  std::vector<double> weights;
  const double depth = table.space().depth();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec2<double> at = owen_sobol(i, 7);
    const PupilSample s = place_at(at.x, at.y);
    const double dx = s.x - film.x, dy = s.y - film.y, length2 = dx * dx + dy * dy + depth * depth;
    places.push_back({s.x, s.y});
    weights.push_back(s.area * depth * depth / (length2 * length2));
  }
  const std::vector<bool> through = passing(lens, table, film, places);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += through[i] ? weights[i] : 0;
  const double n = lens.index(lens.surface_count(), {});
  return n * n * sum / count;
}

TEST(FilmCells, IrradianceEqualsRaysThroughTheLastSurface) {
  for (const auto& [id, f_number, radius, film] :
       {std::tuple{"cylinder_3.9mm", 0.0, 1.0, FilmPoint{0, 0}},
        std::tuple{"cylinder_3.9mm", 0.0, 1.0, FilmPoint{0.4, -0.6}},
        std::tuple{"cylinder_3.9mm", 0.0, 4.3, FilmPoint{-2.9, -2.9}},
        std::tuple{"cylinder_3.9mm", 16.0, 1.0, FilmPoint{0, 0}},
        std::tuple{"cylinder_3.9mm", 16.0, 1.0, FilmPoint{-0.5, 0.7}},
        std::tuple{"anamorphic_60mm_2x", 0.0, format, FilmPoint{-9, 7}},
        std::tuple{"anamorphic_60mm_2x", 0.0, 21.6, FilmPoint{-16.9, -5.8}},
        std::tuple{"anamorphic_60mm_2x", 0.0, 21.6, FilmPoint{17.6, 0.3}},
        std::tuple{"anamorphic_60mm_2x", 45.0, format, FilmPoint{12.46, 0}},
        std::tuple{"anamorphic_60mm_2x", 64.0, format, FilmPoint{-14.3, 0.3}},
        std::tuple{"anamorphic_60mm_2x", 11.0, format, FilmPoint{8, 11.5}}}) {
    SCOPED_TRACE(std::string(id) + " f/" + std::to_string(f_number) + " at x = " + std::to_string(film.x));
    const Lens open = data_lens(id), lens = f_number > 0 ? with_f_number(open, f_number) : open;
    const FilmPupilTable table = FilmPupilTable::enclosing(lens, radius);
    const double sampled =
        irradiance(lens, table, film, [&, &at = film](double u, double v) { return table.sample(at, u, v); });
    EXPECT_NEAR(sampled / film_irradiance(lens, film), 1, 2e-3);
    // The bounding square of the last surface, projected from the film point into the pupil plane.
    const LensSurface& last = lens.surfaces().back();
    const double to_pupil = table.space().depth() / (last.vertex_z - lens.film_z());
    const double half = 1.5 * last.semi_diameter * std::abs(to_pupil);
    const double brute = irradiance(lens, table, film, [&, &at = film](double u, double v) {
      return PupilSample{at.x * (1 - to_pupil) + half * (2 * u - 1), at.y * (1 - to_pupil) + half * (2 * v - 1),
                         4 * half * half};
    });
    EXPECT_NEAR(sampled / brute, 1, 1.5 / std::sqrt(65536 * table.area(film) / (4 * half * half)));
  }
}

TEST(FilmCells, EqualAreaGivesTheIrradianceOfThePupils) {
  for (const double f_number : {0.0, 8.0}) {
    const Lens lens = anamorphic(f_number);
    const FilmPupilTable table = FilmPupilTable::equal_area(lens, format);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-1, 1);
    double mean = 0;
    constexpr int points = 60;
    for (int i = 0; i < points; ++i) {
      const FilmPoint film{10.9 * unit(random), 9.3 * unit(random)};
      const double off = table.projected_solid_angle(film) / film_irradiance(lens, film) - 1;
      EXPECT_NEAR(off, 0, 0.03) << film.x << ", " << film.y;
      mean += std::abs(off) / points;
    }
    EXPECT_LT(mean, 0.004);
  }
}

TEST(FilmCells, QuadrantsOfTheFilmAreEqual) {
  const FilmPupilTable table = FilmPupilTable::enclosing(anamorphic(5.6), format);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    const FilmPoint film{10 * unit(random), 10 * unit(random)};
    const double u = unit(random), v = unit(random);
    const PupilSample s = table.sample(film, u, v), left = table.sample({-film.x, film.y}, 1 - u, v),
                      below = table.sample({film.x, -film.y}, u, v);
    EXPECT_NEAR(left.x, -s.x, 1e-9);
    EXPECT_NEAR(left.y, s.y, 1e-9);
    EXPECT_EQ(left.area, s.area);
    // As u starts at +y, the mirror image of a pupil without symmetry in x has other samples.
    EXPECT_TRUE(table.contains(film, below.x, -below.y)) << v;
    EXPECT_EQ(table.polygon_area({film.x, -film.y}), table.polygon_area(film));
    EXPECT_TRUE(table.contains({-film.x, film.y}, left.x * (1 - 1e-9), left.y)) << v;
  }
}

// Samples are continuous across the axes and the borders of cells, so that images have no seams.
TEST(FilmCells, ContinuousOverTheFilm) {
  const FilmPupilTable table = FilmPupilTable::enclosing(anamorphic(0), format);
  for (const auto& [u, v] : {std::array{0.1, 0.9}, std::array{0.43, 0.5}, std::array{0.86, 0.99}, std::array{0.0, 1.0},
                             std::array{0.5, 0.7}}) {
    for (const bool along_x : {true, false}) {
      for (const double across : {-5.3, 0.0, 1e-12, 3.1}) {
        const auto at = [&, u = u, v = v](double along) {
          return table.sample(along_x ? FilmPoint{along, across} : FilmPoint{across, along}, u, v);
        };
        constexpr int steps = 4000;
        PupilSample before = at(-10);
        for (int i = 1; i <= steps; ++i) {
          const PupilSample now = at(-10 + 20.0 * i / steps);
          ASSERT_GT(now.area, 0);
          EXPECT_LT(std::hypot(now.x - before.x, now.y - before.y), 0.02) << u << ' ' << across << " step " << i;
          // At the border of two sectors, areas jump.
          if (u != 0 && u != 0.5) {
            EXPECT_LT(std::abs(now.area - before.area), 2e-3 * now.area);
          }
          before = now;
        }
      }
    }
  }
}

TEST(FilmCells, CoverTheLinesOfATiltedFilm) {
  const FilmPupilTable upright = FilmPupilTable::enclosing(anamorphic(8), 1.4 * format);
  const double steep = 0.1 / -upright.space().depth();
  const double most = steep * format;
  const FilmTilt tilt{
      .slope_x = 0.8 * steep, .slope_y = -0.6 * steep, .min_excess = -most, .max_excess = most, .radius = format};
  const FilmPupilTable table = upright.for_tilted_film(tilt);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const FilmPoint film{10 * unit(random) - 5, 20 * unit(random) - 10};
    const PupilSample s = upright.sample(film, unit(random), unit(random));
    const double part = (tilt.slope_x * film.x + tilt.slope_y * film.y) / (1 - tilt.slope_x * s.x - tilt.slope_y * s.y);
    EXPECT_TRUE(table.contains({film.x + part * s.x, film.y + part * s.y}, s.x, s.y));
  }
}

}  // namespace film_cells_test
