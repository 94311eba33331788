// SPDX-License-Identifier: Apache-2.0
// Cat's eyes: pupils clipped by a rim.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "../blades.hpp"
#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "core/low_discrepancy.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval {
namespace rim_test {

using testing::data_lens;
using testing::expect_error;

constexpr double pi = std::numbers::pi, film_radius = 20;

/// Area of the intersection of two discs of radii 1 and r at a distance.
double lens_area(double r, double distance) {
  if (distance >= 1 + r) return 0;
  if (distance <= std::abs(1 - r)) return pi * std::min(1.0, r * r);
  const double a = (distance * distance + 1 - r * r) / (2 * distance), b = distance - a;
  return std::acos(a) - a * std::sqrt(1 - a * a) + r * r * std::acos(b / r) - b * std::sqrt(r * r - b * b);
}

FilmPupilTable image(const Lens& lens, const Iris& iris) {
  const PupilImage of_stop{{0.2, 0.2}, {10, 10}};
  return FilmPupilTable::of_iris(two_planes(lens), iris, {&of_stop, 1}, film_radius);
}

TEST(PupilRim, AreaEqualsTheIntersectionOfDiscs) {
  const FilmPupilTable pupils = image(data_lens("double_gauss_100mm_f2.0"), {});
  for (const PupilRim& rim : {PupilRim{1, 0.05}, PupilRim{1.5, 0.08}, PupilRim{0.7, 0.06}, PupilRim{2, -0.1}}) {
    const FilmPupilTable cut = pupils.clipped_by_rim(rim);
    EXPECT_TRUE(cut.is_clipped());
    EXPECT_FALSE(pupils.is_clipped());
    for (const double r : {0.0, 3.0, 9.0, 13.0, 19.0}) {
      for (const double azimuth : {0.0, 0.8, 2.0}) {
        const FilmPoint film{r * std::sin(azimuth), r * std::cos(azimuth)};
        const double wanted = 100 * lens_area(rim.ratio, std::abs(rim.shift_per_mm) * r);
        EXPECT_NEAR(cut.area(film), wanted, 0.01 * wanted + 0.1) << rim.ratio << ' ' << r;
        EXPECT_EQ(cut.unclipped().area(film), pupils.area(film));
      }
    }
  }
}

// Samples lie in the unclipped pupil and in the disc and cover their intersection, for pupils of any kind.
TEST(PupilRim, ClippedPupilIsThePartWithinTheDisc) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const Iris blades{.blades = 5, .rotation_rad = 0.4};
  const PupilRim rim{1.2, 0.05};
  for (const FilmPupilTable& pupils :
       {image(lens, {}), image(lens, blades), FilmPupilTable::equal_area(lens, film_radius),
        FilmPupilTable::enclosing(with_iris(lens, blades), film_radius)}) {
    const FilmPupilTable cut = pupils.clipped_by_rim(rim);
    double radius = 0;
    for (int k = 0; k < 64; ++k) {
      const PupilSample edge = pupils.with_round_stop().sample({}, k / 64., 1);
      radius = std::max(radius, std::hypot(edge.x, edge.y));
    }
    const double shift = pupils.with_round_stop().middle({0, 0.5}).y / 0.5 - rim.shift_per_mm * radius;
    const core_detail::Kronecker<4> random(3);
    double outside = 0, missed = 0, both = 0, area = 0;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const auto [r, azimuth, u, v] = random(i);
      const FilmPoint film{16 * r * std::sin(2 * pi * azimuth), 16 * r * std::cos(2 * pi * azimuth)};
      const auto room = [&](const PupilSample& s) {
        return 1 - std::hypot(s.x - shift * film.x, s.y - shift * film.y) / (rim.ratio * radius);
      };
      const PupilSample own = cut.sample(film, u, v), before = pupils.sample(film, u, v);
      if (!(own.area > 0)) continue;
      area += own.area;
      if (!pupils.contains(film, own.x, own.y) || room(own) < 0) outside += own.area;
      if (room(before) < 0) continue;
      both += before.area;
      if (!cut.contains(film, before.x, before.y)) missed += before.area;
    }
    EXPECT_LT(outside, 0.012 * area);
    EXPECT_LT(missed, 0.015 * both);
    EXPECT_NEAR(area / both, 1, 0.01);
    EXPECT_LT(area, 20000 * 0.98 * pupils.area({}));
  }
}

TEST(PupilRim, RefusesInvalidRimsAndPupils) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FilmPupilTable pupils = image(lens, {});
  for (const PupilRim& rim : {PupilRim{0, 0}, PupilRim{-1, 0}, PupilRim{std::nan(""), 0}, PupilRim{1, std::nan("")},
                              PupilRim{std::numeric_limits<double>::infinity(), 0}}) {
    expect_error([&] { pupils.clipped_by_rim(rim); }, {"pupils", "rim", rim.ratio, rim.shift_per_mm});
  }
  // At the limit the film is dark except on the axis, and samples stay finite.
  const double most = 1e6 / pupils.film_radius();
  const FilmPupilTable narrow = pupils.clipped_by_rim({1, most * (1 - 1e-12)});
  EXPECT_EQ(narrow.area({0, pupils.film_radius()}), 0);
  EXPECT_TRUE(std::isfinite(narrow.sample({0, pupils.film_radius()}, 0.3, 0.7).y));
  for (const double rate : {1.001 * most, -1e40, 1e200}) {
    expect_error([&] { pupils.clipped_by_rim({1, rate}); }, {"pupils", "rim", "film", 1e6});
  }
  for (const char* id : {"anamorphic_60mm_2x", "catadioptric_mangin_1000mm_f7.5"}) {
    expect_error([&] { FilmPupilTable::enclosing(data_lens(id), 10).clipped_by_rim({1, 0.1}); }, {"pupils", "rim"});
  }
}

}  // namespace rim_test
}  // namespace petzval
