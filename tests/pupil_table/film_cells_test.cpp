// SPDX-License-Identifier: Apache-2.0
// The pupils of films behind lenses with cylinders, tabulated over both axes of the film.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

}  // namespace film_cells_test
