// SPDX-License-Identifier: Apache-2.0
// Samples of a FilmPupilTable: density, continuity over the film, batches.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace film_pupil_samples_test {

using namespace petzval;
using petzval::testing::data_lens;

class UniformSamples : public ::testing::TestWithParam<std::pair<const char*, FilmPoint>> {};

TEST_P(UniformSamples, DensityIsTheInverseArea) {
  const auto& [id, film] = GetParam();
  const FilmPupilTable table = FilmPupilTable::enclosing(data_lens(id), 22);
  // Means over samples and over uniform points inside the pupil.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<double, 5> sampled{}, inside{};
  double sampled_area = 0;
  const auto moments = [](double x, double y) { return std::array<double, 5>{x, y, x * x, x * y, y * y}; };
  constexpr int side = 512;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const PupilSample s = table.sample(film, (i + 0.5) / side, (j + 0.5) / side);
      const auto m = moments(s.x, s.y);
      for (std::size_t k = 0; k < 5; ++k) sampled[k] += s.area * m[k];
      sampled_area += s.area;
    }
  }
  const Vec2<double> middle = table.middle(film);
  constexpr double half = 50;
  int count = 0;
  for (int i = 0; i < 1024; ++i) {
    for (int j = 0; j < 1024; ++j) {
      const double x = middle.x + half * ((i + 0.5) / 512 - 1), y = middle.y + half * ((j + 0.5) / 512 - 1);
      if (!table.contains(film, x, y)) continue;
      const auto m = moments(x, y);
      for (std::size_t k = 0; k < 5; ++k) inside[k] += m[k];
      ++count;
    }
  }
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(sampled[k] / sampled_area, inside[k] / count, k < 2 ? 0.02 : 0.3) << k;
  EXPECT_NEAR(table.area(film), count * std::pow(2 * half / 1024, 2), 1e-3 * table.area(film));
}

INSTANTIATE_TEST_SUITE_P(FilmPupilTable, UniformSamples,
                         ::testing::Values(std::pair{"double_gauss_100mm_f1.35", FilmPoint{-9, 17}},
                                           std::pair{"anamorphic_60mm_2x", FilmPoint{-9.4, 8.1}}));

TEST(FilmPupilTable, IsContinuousAcrossTheTable) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  constexpr double radius = 40;
  const FilmPupilTable table = FilmPupilTable::enclosing(lens, radius);
  for (const auto& [u, v] : {std::array{0.1, 0.9}, std::array{0.43, 0.5}, std::array{0.86, 0.99}}) {
    const auto at = [&, u = u, v = v](double r) { return table.sample({0.28 * r, -0.96 * r}, u, v); };
    // Steps across the nodes of the table, compared with steps within its strips.
    constexpr int strips = 32, places = 32, steps = strips * places;
    double across = 0, within = 0;
    for (int i = 1; i < steps; ++i) {
      const PupilSample a = at(radius * (i - 0.5) / steps), b = at(radius * (i + 0.5) / steps);
      double& largest = i % places == 0 ? across : within;
      largest = std::max(largest, std::hypot(a.x - b.x, a.y - b.y));
    }
    EXPECT_LT(across, 1.5 * within);
    for (int i = 1; i < strips; ++i) {
      const double node = radius * i / strips, next = std::nextafter(node, radius), before = std::nextafter(node, 0);
      EXPECT_NEAR(at(before).x, at(next).x, 1e-10);
      EXPECT_NEAR(at(before).y, at(next).y, 1e-10);
      EXPECT_NEAR(at(before).area, at(next).area, 1e-9);
    }
  }
}

/// Checks that film points at 1e-4 mm down to the smallest numbers from the axis have the axial pupil.
template <class T>
void expect_the_pupil_of_the_axis(const FilmPupilTable& table, double share) {
  std::vector<T> film_x, film_y;
  for (T r = 10; r > 0; r /= 2) {
    film_x.push_back(r), film_y.push_back(0);
    film_x.push_back(r * T(-0.6)), film_y.push_back(r * T(0.8));
  }
  const std::size_t count = film_x.size();
  std::vector<T> u(count, static_cast<T>(share)), v(count, T(0.8)), areas(count);
  table.sample<T>(count, film_x.data(), film_y.data(), u.data(), v.data(), {}, u.data(), v.data(), areas.data());
  const PupilSample axis = table.sample({0, 0}, share, T(0.8));
  for (std::size_t i = 0; i < count; ++i) {
    const double r = std::hypot(film_x[i], film_y[i]);
    if (r > 1e-4) continue;
    const PupilSample one = table.sample({film_x[i], film_y[i]}, share, T(0.8));
    EXPECT_NEAR(std::hypot(one.x - axis.x, one.y - axis.y), 0, 2e-3 * std::sqrt(axis.area)) << r;
    EXPECT_NEAR(std::hypot(u[i] - axis.x, v[i] - axis.y), 0, 2e-3 * std::sqrt(axis.area)) << r;
  }
}

TEST(FilmPupilTable, IsContinuousNextToTheAxis) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  for (const FilmPupilTable& table :
       {FilmPupilTable::enclosing(lens, 22), FilmPupilTable::enclosing(with_iris(lens, {.blades = 5}), 22),
        FilmPupilTable::enclosing(data_lens("anamorphic_60mm_2x"), 22)}) {
    for (const double share : {0.0, 0.3, 0.7}) {
      expect_the_pupil_of_the_axis<float>(table, share);
      expect_the_pupil_of_the_axis<double>(table, share);
    }
  }
}

class SampledTable : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(FilmPupilTable, SampledTable,
                         ::testing::Values("catadioptric_mangin_1000mm_f7.5", "anamorphic_60mm_2x"));

TEST_P(SampledTable, PositionsMapBackToTheirSamples) {
  const Lens lens = data_lens(GetParam());
  std::vector<FilmPupilTable> tables{FilmPupilTable::enclosing(lens, 20)};
  const Lens round = data_lens("double_gauss_100mm_f1.35");
  tables.push_back(FilmPupilTable::enclosing(with_iris(round, {.blades = 5, .rotation_rad = 0.3}), 20));
  const PupilImage image{{-0.4, -0.4}, {20, 18}};
  tables.push_back(FilmPupilTable::of_iris(two_planes(round), {.blades = 7, .roundness = 0.4}, {&image, 1}, 20));
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const FilmPupilTable& table : tables) {
    for (int i = 0; i < 2000; ++i) {
      const FilmPoint film{20 * unit(random) - 10, 20 * unit(random) - 10};
      const double u = unit(random), v = unit(random);
      const PupilSample s = table.sample(film, u, v);
      const Vec2<double> at = table.position(film, s.x, s.y);
      EXPECT_NEAR(std::remainder(at.x - u, 1), 0, 1e-9 / v);
      EXPECT_NEAR(at.y, v, 1e-9);
      const PupilSample edge = table.sample(film, u, 1);
      const Vec2<double> middle = table.middle(film);
      const Vec2<double> beyond = middle + 1.1 * (Vec2<double>{edge.x, edge.y} - middle);
      EXPECT_GT(table.position(film, beyond.x, beyond.y).y, 1);
    }
    EXPECT_GT(table.position({100, 0}, 0, 0).y, 1);
  }
}

}  // namespace film_pupil_samples_test
