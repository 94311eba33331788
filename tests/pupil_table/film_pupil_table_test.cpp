// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/film_pupil_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil_coverage.hpp"

namespace film_pupil_table_test {

using namespace petzval;
using petzval::testing::data_lens;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
using petzval::testing::message;
using petzval::testing::passing;

double clearance(const FilmPupilTable& table, const FilmPoint& film, double x, double y, Wavelength wavelength = {}) {
  double result = 0;
  table.clearances(1, {&film.x, &film.y, &x, &y}, wavelength, &result);
  return result;
}

TEST(FilmPupilTable, AcceptsAPlateCloseToTheFilm) {
  Prescription p = petzval::testing::data_prescription("double_gauss_100mm_f2.0");
  // A plate of 2 mm in front of the film, at 0.1 mm; the film is moved by the focus shift of the plate.
  const Lens bare = compile(p);
  const double gap = bare.film_z() - bare.surfaces().back().vertex_z;
  p.surfaces.back().thickness = gap - 2 / 1.5 - 0.1;
  p.surfaces.push_back({.thickness = 2, .medium = {.nd = 1.5}, .semi_diameter = 40});
  p.surfaces.push_back({.thickness = 0.1, .semi_diameter = 40});
  for (const double f_number : {2.8, 16.0}) {
    const FilmPupilTable table = FilmPupilTable::enclosing(with_f_number(compile(p), f_number), 21);
    for (int i = 0; i <= 100; ++i) EXPECT_GT(table.area({0, 0.21 * i}), 0) << f_number << " at " << 0.21 * i;
  }
}

TEST(FilmPupilTable, MatchesTheShapeOfPupils) {
  for (const char* id : {"double_gauss_100mm_f1.35", "fisheye_8mm_f2.8", "catadioptric_mangin_1000mm_f7.5"}) {
    const Lens lens = data_lens(id);
    const double radius = 7.5;
    const FilmPupilTable table = FilmPupilTable::equal_area(lens, radius),
                         cover = FilmPupilTable::enclosing(lens, radius);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const double r : {0.0, 0.31, 0.77, 0.99}) {
      const FilmPoint film{0.6 * r * radius, 0.8 * r * radius};
      std::vector<std::array<double, 2>> places;
      for (int i = 0; i < 20000; ++i) {
        const PupilSample s = cover.sample(film, unit(random), unit(random));
        places.push_back({s.x, s.y});
      }
      const auto in = passing(lens, table, film, places);
      double differ = 0, passes = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        differ += table.contains(film, places[i][0], places[i][1]) != in[i];
        passes += in[i];
      }
      EXPECT_LT(differ / passes, 0.005) << id << ", film point at " << r;
      EXPECT_NEAR(table.area(film) / cover.area(film), passes / static_cast<double>(places.size()), 0.004) << id;
    }
  }
}

TEST(FilmPupilTable, ClearanceIsTheDistanceToTheEdge) {
  for (const char* id : {"double_gauss_100mm_f1.35", "catadioptric_mangin_1000mm_f7.5", "anamorphic_60mm_2x"}) {
    constexpr double radius = 18;
    const FilmPupilTable table = FilmPupilTable::enclosing(data_lens(id), radius);
    const double reach = 1.5 * std::sqrt(table.area({0, 0}));
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 4000; ++i) {
      const FilmPoint film{0.6 * radius * unit(random), 0.6 * radius * unit(random)};
      const Vec2<double> middle = table.middle(film);
      const double x = middle.x + reach * unit(random), y = middle.y + reach * unit(random);
      const double here = clearance(table, film, x, y);
      EXPECT_EQ(here >= 0, table.contains(film, x, y)) << id << ' ' << here;
      EXPECT_GT(here, -1) << id;
      constexpr double step = 1e-7;
      EXPECT_NEAR(clearance(table, film, x + step * reach, y), here, 20 * step) << id;
      EXPECT_NEAR(clearance(table, {film.x, film.y + step * radius}, x, y), here, 20 * step) << id;
      EXPECT_NEAR(clearance(table, film, x, y) - clearance(table, {-film.x, -film.y}, -x, -y), 0, 1e-9) << id;
    }
    EXPECT_EQ(clearance(table, {0, 2 * radius}, 0, 0), -1) << id;
    for (const double none : {HUGE_VAL, std::nan("")}) EXPECT_EQ(table.projected_solid_angle({0, none}), 0) << id;
    for (const double far : {1e160, 1e308, HUGE_VAL}) EXPECT_EQ(clearance(table, {0, 1}, far, -far / 3), -1) << id;
  }
}

TEST(FilmPupilTable, RefusesInvalidTilts) {
  const FilmPupilTable table = FilmPupilTable::enclosing(data_lens("double_gauss_100mm_f2.0"), 20);
  expect_error([&] { (void)table.for_tilted_film({.radius = -1}); }, {"tilted film", "radius", -1});
  expect_error([&] { (void)table.for_tilted_film({.radius = std::nan("")}); }, {"tilted film", "radius", "nan"});
  const FilmPupilTable discs = FilmPupilTable::of_iris({50, 0}, {}, std::array{PupilImage{.radius = {10, 10}}}, 20);
  for (const FilmPupilTable& each : {table, discs}) {
    expect_error([&] { (void)each.for_tilted_film({.radius = 5}, 0); }, {"tilted film", "threads", 0});
  }
}

TEST(FilmPupilTable, IntersectionOfDiscs) {
  const std::vector<std::vector<PupilDisc>> discs{{{0.2, 10}, {-0.5, 9}}};
  const FilmPupilTable table = FilmPupilTable::of_discs({50, 0}, discs, 12);
  for (const double r : {0.0, 3.0, 8.0, 12.0}) {
    const double distance = 0.7 * r, a = 10, b = 9;
    double area = std::numbers::pi * b * b;
    if (distance > a - b) {
      const double x = (distance * distance + a * a - b * b) / (2 * distance), y = std::sqrt(a * a - x * x);
      area = a * a * std::atan2(y, x) + b * b * std::atan2(y, distance - x) - distance * y;
    }
    EXPECT_NEAR(table.area({0, r}), area, 1e-4 * area) << r;
    EXPECT_TRUE(table.contains({r, 0}, -0.15 * r, 0));
    EXPECT_FALSE(table.contains({r, 0}, 0.2 * r - 10.1, 0));
  }
}

/// Hexagonal pupils at two wavelengths with different shifts.
FilmPupilTable hexagons(const Iris& iris) {
  const std::array images{PupilImage{{-0.3, -0.3}, {9, 9}}, PupilImage{{0.95, 0.95}, {4, 4}}};
  return FilmPupilTable::of_iris({50, 0}, iris, images, 12);
}

TEST(FilmPupilTable, ImagesOfAnIris) {
  for (const Iris& iris : {Iris{}, Iris{.blades = 6, .rotation_rad = 0.2}}) {
    const FilmPupilTable table = hexagons(iris);
    const double share = iris.round() ? std::numbers::pi : 3 * std::sin(std::numbers::pi / 3);
    for (const std::size_t w : {0, 1}) {
      const double shift = w == 0 ? -0.3 : 0.95, radius = w == 0 ? 9 : 4;
      const FilmPoint film{7, -5};
      EXPECT_NEAR(table.area(film, w), share * radius * radius, 1e-12 * radius * radius);
      EXPECT_EQ(table.middle(film, w), (Vec2<double>(shift * 7, shift * -5)));
      const double corner = 0.2 + std::numbers::pi / 2, edge = corner + std::numbers::pi / 6, inwards = 0.999;
      const auto at = [&](double part) {
        return table.contains(film, shift * 7 + part * radius * std::cos(corner),
                              shift * -5 + part * radius * std::sin(corner), w);
      };
      EXPECT_TRUE(at(inwards));
      EXPECT_FALSE(at(1 / inwards));
      EXPECT_EQ(table.contains(film, shift * 7 + 0.9 * radius * std::cos(edge),
                               shift * -5 + 0.9 * radius * std::sin(edge), w),
                iris.round());
    }
  }
}

TEST(FilmPupilTable, SolidAngleEqualsIntegral) {
  // A disc on the axis has the projected solid angle pi sin^2 of its half angle.
  for (const double radius : {1.0, 9.0, 40.0}) {
    const PupilImage disc{{1, 1}, {radius, radius}};
    const FilmPupilTable table = FilmPupilTable::of_iris({50, 0}, {}, {&disc, 1}, 12);
    for (const FilmPoint& film : {FilmPoint{0, 0}, FilmPoint{-7, 5}}) {
      EXPECT_NEAR(table.projected_solid_angle(film) * (radius * radius + 2500) / (radius * radius), std::numbers::pi,
                  3e-4);
    }
  }
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FilmPupilTable table = FilmPupilTable::equal_area(lens, 20);
  // Pupils with other shapes and positions keep the irradiance.
  const std::vector<std::vector<PupilDisc>> discs{{{0.3, 30}, {-0.2, 20}}};
  const FilmPupilTable other = table.with_discs(discs);
  for (const FilmPoint& film : {FilmPoint{0, 0}, FilmPoint{3, -9}, FilmPoint{14, 14}}) {
    EXPECT_NEAR(table.projected_solid_angle(film) / film_irradiance(lens, film), 1, 2e-3);
    EXPECT_NEAR(other.projected_solid_angle(film) / table.projected_solid_angle(film), 1, 1e-3);
    EXPECT_GE(std::abs(other.middle(film).y - table.middle(film).y), 1e-3 * std::abs(film.y));
  }
}

// The ray of a virtual film point V through q meets the upright film in V - (slope . V) q.
TEST(FilmPupilTable, TiltedFilmImagesAreExact) {
  const FilmTilt tilt{.slope_x = 0.012, .slope_y = -0.02, .radius = 8};
  for (const Iris& iris : {Iris{}, Iris{.blades = 5, .roundness = 0.4, .rotation_rad = 0.1}}) {
    const FilmPupilTable upright = hexagons(iris), tilted = upright.for_tilted_film(tilt);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-1, 1);
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const FilmPoint film{5 * unit(random), 5 * unit(random)};
      const double x = 12 * unit(random), y = 12 * unit(random), slope = tilt.slope_x * film.x + tilt.slope_y * film.y;
      const bool seen = tilted.contains(film, x, y, i % 2);
      EXPECT_EQ(seen, upright.contains({film.x - slope * x, film.y - slope * y}, x, y, i % 2));
      inside += seen;
      const double u = (unit(random) + 1) / 2, v = (unit(random) + 1) / 2, h = 1e-5;
      const auto moves = tilted.derivatives(film, u, v, i % 2);
      const auto at = [&](double dx, double dy) { return tilted.sample({film.x + dx, film.y + dy}, u, v, i % 2); };
      EXPECT_NEAR(moves.by_film_x[0], (at(h, 0).x - at(-h, 0).x) / (2 * h), 1e-8);
      EXPECT_NEAR(moves.by_film_x[1], (at(h, 0).y - at(-h, 0).y) / (2 * h), 1e-8);
      EXPECT_NEAR(moves.by_film_y[0], (at(0, h).x - at(0, -h).x) / (2 * h), 1e-8);
      EXPECT_NEAR(moves.by_film_y[1], (at(0, h).y - at(0, -h).y) / (2 * h), 1e-8);
    }
    EXPECT_GT(inside, 400);
  }
}

TEST(FilmPupilTable, IsEmptyOutsideItsFilm) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FilmPupilTable table = FilmPupilTable::enclosing(lens, 20);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<double> x{0, 21, nan, 0, 0, infinity, 3, 3, 0, 0}, y(10, 0), u{0.5, 0.5, 0.5, nan, 0.5, 0.5, -1, 2, 1, 0},
      v{0.5, 0.5, 0.5, 0.5, infinity, 0.5, -1, 2, 1, 0}, px(10), py(10), areas(10);
  table.sample<double>(10, x.data(), y.data(), u.data(), v.data(), {}, px.data(), py.data(), areas.data());
  for (std::size_t i = 0; i < 10; ++i) {
    const PupilSample s = table.sample({x[i], y[i]}, u[i], v[i]);
    const bool sound = i == 0 || i > 5;
    EXPECT_EQ(s.area > 0, sound) << i;
    EXPECT_EQ(areas[i] > 0, sound) << i;
    EXPECT_TRUE(std::isfinite(px[i]) && std::isfinite(py[i]) && std::isfinite(s.x) && std::isfinite(s.y));
    EXPECT_TRUE(sound || px[i] == 0);
  }
  EXPECT_EQ(table.sample({0, 0}, 0.5, 0.5, 1).area, 0);
  EXPECT_EQ(table.area({0, 21}), 0);
  EXPECT_FALSE(table.contains({0, 21}, 0, 0));
  expect_error([&] { (void)FilmPupilTable::enclosing(lens, nan); }, {lens.name(), "film", "radius", "nan"});
  expect_error([&] { (void)FilmPupilTable::enclosing(lens, -1); }, {lens.name(), "film", "radius", -1});
  const double last_z = lens.surfaces().back().vertex_z;
  expect_error([&] { (void)FilmPupilTable::enclosing(with_film(lens, last_z), 10); }, {lens.name(), "film", last_z});
  expect_error([&] { (void)FilmPupilTable::of_iris({50, 0}, {}, {}, nan); }, {"radius", "nan"});
  expect_error([&] { (void)hexagons({.blades = 2}); }, {"blades", 2});
  const FilmPupilTable dark = FilmPupilTable::enclosing(with_semi_diameter(lens, *lens.stop(), 0), 20);
  EXPECT_EQ(dark.sample({1, 2}, 0.5, 0.5).area, 0);
}

TEST(FilmPupilTable, RefusesInvalidInput) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  using Nm = std::vector<double>;
  // Discs and images are checked by the same rules.
  const auto refusals = [](const TwoPlanes& space, const std::vector<PupilDisc>& discs, std::size_t primary,
                           const Nm& nm) {
    std::vector<std::vector<PupilDisc>> lists;
    std::vector<PupilImage> images;
    for (const auto& disc : discs) {
      lists.push_back({disc}), images.push_back({{0, disc.shift}, {5, disc.radius}});
    }
    const std::string of_discs = message([&] { (void)FilmPupilTable::of_discs(space, lists, 10, primary, nm); });
    const std::string of_iris = message([&] { (void)FilmPupilTable::of_iris(space, {}, images, 10, primary, nm); });
    EXPECT_EQ(of_discs, of_iris);
    return of_discs;
  };
  const TwoPlanes space{100, 0};
  EXPECT_EQ(refusals(space, {{0, 5}}, 0, {}), "no error");
  EXPECT_EQ(refusals(space, {{0, 0}, {-2, 5}}, 1, {400, 500}), "no error");
  expect_tokens(refusals(space, {{0, -5}}, 0, {}), {"pupil table", "wavelength 0", "shift", 0, "radius", -5});
  expect_tokens(refusals(space, {{nan, 5}}, 0, {}), {"pupil table", "wavelength 0", "shift", "nan", "radius", 5});
  expect_tokens(refusals(space, {{0, infinity}}, 0, {}), {"pupil table", "wavelength 0", "shift", 0, "radius", "inf"});
  expect_tokens(refusals(space, {}, 0, {}), {"pupil table", "wavelengths", 0, 65535});
  expect_tokens(refusals(space, std::vector<PupilDisc>(65536, {0, 5}), 0, {}),
                {"pupil table", "wavelengths", 65536, 65535});
  expect_tokens(refusals(space, {{0, 5}}, 7, {}), {"pupil table", "primary_wavelength", 7});
  expect_tokens(refusals({0, 0}, {{0, 5}}, 0, {}), {"pupil table", "film", "z", 0});
  expect_tokens(refusals({nan, 0}, {{0, 5}}, 0, {}), {"pupil table", "film", "z", "nan"});
  expect_tokens(refusals(space, {{0, 5}}, 0, {400, 500}), {"pupil table", "wavelengths_nm", 2, 1});
  expect_tokens(refusals(space, {{0, 5}}, 0, {nan}), {"pupil table", "wavelength", "nan"});
  expect_tokens(refusals(space, {{0, 5}, {0, 5}, {0, 5}}, 0, {400, 500, 400}),
                {"pupil table", "wavelength 2", 400, "nm"});
  expect_tokens(refusals(space, {{0, 5}, {0, 5}, {0, 5}}, 0, {400, 400, 500}),
                {"pupil table", "wavelength 1", 400, "nm"});

  std::vector<std::vector<PupilDisc>> lists{{}};
  expect_error([&] { (void)FilmPupilTable::of_discs(space, lists, 10); }, {"pupil table", "wavelength 0", "disc"});
  const FilmPupilTable table = FilmPupilTable::of_discs(space, std::array{std::vector<PupilDisc>{{0, 5}}}, 10);
  expect_error([&] { (void)table.with_discs(lists); }, {"pupil table", "wavelength 0", "disc"});
  lists.assign(3, {{0, 5}});
  expect_error([&] { (void)table.with_discs(lists); }, {"pupil table", "discs", "wavelengths", 3, 1});
}

TEST(FilmPupilTable, IsEmptyAtOtherWavelengths) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const PupilImage image{.radius = {10, 10}};
  const FilmPupilTable tables[]{FilmPupilTable::enclosing(lens, 20),
                                FilmPupilTable::enclosing(data_lens("anamorphic_60mm_2x"), 10),
                                FilmPupilTable::enclosing(with_iris(lens, {.blades = 6}), 20),
                                FilmPupilTable::of_iris({50, 0}, {}, std::array{image}, 20)};
  for (const FilmPupilTable& table : tables) {
    const FilmPoint film{1, 2};
    const Vec2<double> inside = table.middle(film);
    ASSERT_GT(table.area(film), 0);
    ASSERT_TRUE(table.contains(film, inside.x, inside.y));
    for (const Wavelength beyond : {Wavelength(table.wavelengths()), Wavelength(60000), Wavelength::nm(10000)}) {
      EXPECT_FALSE(table.covers(beyond));
      EXPECT_EQ(table.area(film, beyond), 0);
      EXPECT_EQ(table.sample(film, 0.3, 0.7, beyond).area, 0);
      EXPECT_FALSE(table.contains(film, inside.x, inside.y, beyond));
      EXPECT_LT(clearance(table, film, inside.x, inside.y, beyond), 0);
      EXPECT_GT(table.position(film, inside.x, inside.y, beyond).y, 1);
    }
    const auto last = static_cast<std::uint16_t>(table.wavelengths());
    const std::vector<std::uint16_t> each{last, 60000, last, 60000, 0, last, last, last};
    std::vector<double> x(8, film.x), y(8, film.y), u(8, 0.3), v(8, 0.7), areas(8);
    table.sample<double>(8, x.data(), y.data(), u.data(), v.data(), {.each = each.data()}, u.data(), v.data(),
                         areas.data());
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(areas[i] > 0, each[i] == 0) << i;
  }
}

TEST(FilmPupilTable, FilmOfRadiusZeroHasTheAxialPupil) {
  const std::vector<std::vector<PupilDisc>> discs{{{0.1, 10}}};
  const PupilSample wanted = FilmPupilTable::of_discs({50, 0}, discs, 1).sample({0, 0}, 0.3, 0.7);
  ASSERT_GT(wanted.area, 300);
  for (const double radius : {0., 5e-324, 1e-310, 1e-307, 1e-305, 1e-155, 1e-40, 1e-37, 1e-31, 1e-29, 1e-9}) {
    SCOPED_TRACE(radius);
    const FilmPupilTable table = FilmPupilTable::of_discs({50, 0}, discs, radius);
    const FilmPoint edge{0, radius};
    const PupilSample s = table.sample(edge, 0.3, 0.7);
    EXPECT_NEAR(s.x, wanted.x, 1e-8);
    EXPECT_NEAR(s.y, wanted.y, 1e-8);
    EXPECT_NEAR(table.area(edge), wanted.area, 1e-6);
    EXPECT_TRUE(table.contains(edge, s.x, s.y));
    const auto [by_x, by_y] = table.derivatives(edge, 0.3, 0.7);
    EXPECT_TRUE(std::isfinite(by_x.x + by_x.y + by_y.x + by_y.y));
    const auto batch = [&]<class T>(T near) {
      std::vector<T> x(9, 0), y(9, static_cast<T>(radius)), u(9, T(0.3)), v(9, T(0.7)), px(9), py(9), areas(9);
      table.sample<T>(9, x.data(), y.data(), u.data(), v.data(), {}, px.data(), py.data(), areas.data());
      EXPECT_NEAR(px[8], wanted.x, near);
      EXPECT_NEAR(py[8], wanted.y, near);
      EXPECT_NEAR(areas[8], wanted.area, 100 * near);
    };
    batch(1e-8);
    batch(1e-4F);
  }
}

}  // namespace film_pupil_table_test
