// SPDX-License-Identifier: Apache-2.0
// Batches of pupil samples and of membership tests, for every kind of table.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval {
namespace pupil_batch_test {

using testing::data_lens;

enum class Wavelengths { primary, index, nm };

struct Case {
  std::string name;
  std::function<FilmPupilTable()> table;
  Wavelengths wavelengths = Wavelengths::primary;
  double eps = 1e-12, float_eps = 2e-4;  ///< tolerance of positions in units of the square root of the area
  double lit = 0.4;                      ///< lower bound for the fraction of film points with a pupil
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Lens coloured(const char* id, const std::vector<double>& nm = {450, 650}) {
  return compile(testing::data_prescription(id), nm, {.missing_glass = MissingGlass::abbe});
}

/// Two images with different shifts, one far from the film points.
FilmPupilTable images(const Iris& iris) {
  const std::array images{PupilImage{{-0.3, -0.3}, {9, 9}}, PupilImage{{0.95, 0.95}, {4, 4}}};
  return FilmPupilTable::of_iris({50, 0}, iris, images, 12);
}

std::vector<Case> cases() {
  const auto enclosing = [](const char* id, double radius) {
    return [=] { return FilmPupilTable::enclosing(data_lens(id), radius); };
  };
  const auto by_index = [](const char* id, double radius) {
    return [=] { return FilmPupilTable::enclosing(coloured(id), radius); };
  };
  const Iris pentagon{.blades = 5, .roundness = 0.2, .rotation_rad = 0.7};
  std::vector<Case> result{
      {"obscured", enclosing("catadioptric_mangin_1000mm_f7.5", 20)},
      {"cells", enclosing("anamorphic_60mm_2x", 20)},
      {"blades",
       [=] {
         const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2.0"), 2.4);
         return FilmPupilTable::enclosing(with_iris(lens, pentagon), 40);
       },
       Wavelengths::primary, 1e-10, 1e-4, 0.9},
      {"double_gauss_index", by_index("double_gauss_100mm_f1.35", 22), Wavelengths::index},
      {"fisheye_index", [] { return FilmPupilTable::equal_area(coloured("fisheye_8mm_f2.8"), 9); }, Wavelengths::index},
      {"obscured_index", by_index("catadioptric_mangin_1000mm_f7.5", 22), Wavelengths::index},
      {"cells_index", by_index("anamorphic_60mm_2x", 22), Wavelengths::index},
      {"biogon_index", by_index("biogon_35mm_f2.8", 30), Wavelengths::index}};
  int number = 0;
  for (const Iris& iris : {Iris{}, Iris{.blades = 6, .rotation_rad = 0.2}, Iris{.blades = 3, .roundness = -1}}) {
    const std::string name = "images_" + std::to_string(number++);
    result.push_back({name, [=] { return images(iris); }, Wavelengths::index, 5e-15, 2e-6});
    result.push_back({name + "_tilted",
                      [=] { return images(iris).for_tilted_film({.slope_x = 0.01, .slope_y = -0.02, .radius = 11}); },
                      Wavelengths::index, 5e-15, 2e-6});
  }
  const std::vector<double> nm{550, 400, 700};
  const auto lens = [=] { return coloured("double_gauss_100mm_f2.0", nm); };
  result.push_back({"enclosing_nm", [=] { return FilmPupilTable::enclosing(lens(), 20); }, Wavelengths::nm, 1e-7});
  result.push_back({"equal_area_nm", [=] { return FilmPupilTable::equal_area(lens(), 20); }, Wavelengths::nm, 1e-7});
  result.push_back({"images_nm",
                    [=] {
                      const std::array<PupilImage, 3> discs{
                          {{{0.1, 0.1}, {10, 10}}, {{0.12, 0.1}, {11, 10}}, {{0.09, 0.08}, {9, 8}}}};
                      return FilmPupilTable::of_iris(two_planes(lens()), {}, discs, 20, 0, nm);
                    },
                    Wavelengths::nm, 1e-7});
  return result;
}

template <class T>
struct Columns {
  std::vector<T> film_x, film_y, u, v, x, y, area;

  void run(const FilmPupilTable& table, std::size_t count, const RayWavelengths& wavelengths) {
    for (auto* column : {&x, &y, &area}) column->assign(u.size(), 7);
    table.sample<T>(count, film_x.data(), film_y.data(), u.data(), v.data(), wavelengths, x.data(), y.data(),
                    area.data());
  }
  std::vector<std::uint8_t> within(const FilmPupilTable& table, const RayWavelengths& wavelengths) const {
    std::vector<std::uint8_t> result(u.size());
    table.contains<T>(u.size(), {film_x.data(), film_y.data(), x.data(), y.data()}, wavelengths, result.data());
    return result;
  }
};

class PupilBatches : public ::testing::TestWithParam<Case> {};

TEST_P(PupilBatches, EqualSinglePoints) {
  const Case& c = GetParam();
  const FilmPupilTable table = c.table();
  constexpr std::size_t count = 1500;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  Columns<double> twice;
  Columns<float> single;
  std::vector<std::uint16_t> index;
  std::vector<float> nm;
  for (std::size_t i = 0; i < count; ++i) {
    const float r = 1.02f * static_cast<float>(table.film_radius()) * std::sqrt(unit(random)),
                azimuth = 6.2831853f * unit(random);
    single.film_x.push_back(r * std::sin(azimuth)), single.film_y.push_back(r * std::cos(azimuth));
    single.u.push_back(unit(random)), single.v.push_back(unit(random));
    index.push_back(static_cast<std::uint16_t>(i % 3)), nm.push_back(390 + 320 * unit(random));
  }
  single.film_x[6] = nan, single.u[9] = nan, single.v[12] = nan, nm[5] = nan;
  single.film_x[15] = 1.1f * static_cast<float>(table.film_radius());
  single.u[18] = single.v[18] = 1, single.u[21] = single.v[21] = 0;
  const auto copy = [](const std::vector<float>& from) { return std::vector<double>(from.begin(), from.end()); };
  twice.film_x = copy(single.film_x), twice.film_y = copy(single.film_y), twice.u = copy(single.u),
  twice.v = copy(single.v);
  RayWavelengths wavelengths;
  if (c.wavelengths == Wavelengths::index) wavelengths.each = index.data();
  if (c.wavelengths == Wavelengths::nm) wavelengths.each_nm = nm.data();

  single.run(table, count, wavelengths), twice.run(table, count, wavelengths);
  const Columns<double> all = twice;
  for (const std::size_t fewer : {1u, 7u, 8u, 63u, 64u, 129u}) {
    twice.run(table, fewer, wavelengths);
    for (std::size_t i = 0; i < fewer; ++i) {
      const double size = std::sqrt(all.area[i]);
      EXPECT_NEAR(twice.x[i], all.x[i], c.eps * size);
      EXPECT_NEAR(twice.y[i], all.y[i], c.eps * size);
      EXPECT_NEAR(twice.area[i], all.area[i], c.eps * all.area[i]);
    }
  }
  twice = all;
  const auto within = twice.within(table, wavelengths);
  int lit = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint film{twice.film_x[i], twice.film_y[i]};
    const Wavelength own = wavelengths.at(i);
    const PupilSample s = table.sample(film, twice.u[i], twice.v[i], own);
    const double size = std::sqrt(s.area);
    EXPECT_NEAR(twice.x[i], s.x, c.eps * size) << i;
    EXPECT_NEAR(twice.y[i], s.y, c.eps * size) << i;
    EXPECT_NEAR(twice.area[i], s.area, c.eps * s.area) << i;
    // Rounding decides at the rim, and at the edge of a central obscuration.
    const bool on_edge = twice.v[i] > 0.999 || twice.v[i] < 0.001;
    EXPECT_TRUE(on_edge || (within[i] != 0) == table.contains(film, twice.x[i], twice.y[i], own)) << i;
    if (c.wavelengths == Wavelengths::nm) {
      EXPECT_EQ(table.covers(own), nm[i] >= 400 && nm[i] <= 700) << nm[i];
    }
    if (!table.covers(own)) {
      EXPECT_EQ(s.area, 0) << i;
    }
    if (s.area == 0) continue;
    ++lit;
    EXPECT_NEAR(single.x[i], s.x, c.float_eps * size) << i;
    EXPECT_NEAR(single.y[i], s.y, c.float_eps * size) << i;
    EXPECT_NEAR(single.area[i], s.area, 1e-5 * s.area) << i;
    // The centre of traced pupils, at v = 0, may count as outside.
    if (on_edge || (twice.v[i] == 0 && !c.name.starts_with("images"))) continue;
    EXPECT_TRUE(within[i]) << i;
    EXPECT_NEAR(table.sample_area(film, s.x, s.y, own), s.area, 1e-6 * s.area) << i;
  }
  EXPECT_GT(lit, c.lit * count);
  EXPECT_EQ(twice.area[6] + twice.area[9] + twice.area[12] + twice.area[15], 0);
  EXPECT_EQ(single.area[6] + single.area[9] + single.area[12] + single.area[15], 0);

  // Output may overwrite the input.
  Columns<double> in_place = all;
  table.sample<double>(count, in_place.film_x.data(), in_place.film_y.data(), in_place.u.data(), in_place.v.data(),
                       wavelengths, in_place.u.data(), in_place.v.data(), in_place.area.data());
  EXPECT_EQ(in_place.u, all.x);
  EXPECT_EQ(in_place.v, all.y);

  // Points inside and outside the pupils.
  const double size = std::sqrt(table.area({}));
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2<double> middle = table.middle({twice.film_x[i], twice.film_y[i]});
    single.x[i] = static_cast<float>(middle.x + size * (2.2 * unit(random) - 1.1));
    single.y[i] = static_cast<float>(middle.y + size * (2.2 * unit(random) - 1.1));
  }
  single.x[1] = nan;
  twice.x = copy(single.x), twice.y = copy(single.y);
  const auto inside = twice.within(table, wavelengths), inside_float = single.within(table, wavelengths);
  int others = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint film{twice.film_x[i], twice.film_y[i]};
    EXPECT_EQ(inside[i] != 0, table.contains(film, twice.x[i], twice.y[i], wavelengths.at(i))) << i;
    others += inside[i] != inside_float[i];
  }
  EXPECT_GT(std::count(inside.begin(), inside.end(), 1), 100);
  EXPECT_LE(others, 5);
}

INSTANTIATE_TEST_SUITE_P(FilmPupilTable, PupilBatches, ::testing::ValuesIn(cases()),
                         [](const auto& c) { return c.param.name; });

}  // namespace pupil_batch_test
}  // namespace petzval
