// SPDX-License-Identifier: Apache-2.0
#include "pupil_table/entrance_pupil_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval {
namespace entrance_pupil_table_test {

constexpr double pi = std::numbers::pi;

/// A lens and its tables for a film radius.
struct Seen {
  Lens lens;
  double radius;
  FilmPupilTable pupils;
  EntrancePupilTable table;

  Seen(const Lens& l, double film_radius)
      : lens(l),
        radius(film_radius),
        pupils(FilmPupilTable::enclosing(l, film_radius)),
        table(traced_entrances(l, pupils)) {}

  /// The ray to the scene through a film point and a pupil point.
  TracedRay<double> leaving(const FilmPoint& film, double pupil_x, double pupil_y) const {
    const double depth = pupils.space().depth();
    const Vec3<double> along = glm::normalize(Vec3<double>{pupil_x - film.x, pupil_y - film.y, depth});
    return trace(lens, Ray<double>{{pupil_x, pupil_y, pupils.space().pupil_z}, along * (depth < 0 ? 1.0 : -1.0)},
                 {.travel = Travel::to_scene});
  }
};

double film_radius(const Prescription& p, const Lens& lens) {
  if (p.image_diagonal_mm) return *p.image_diagonal_mm / 2;
  const double field = p.half_field_deg.value_or(15) * pi / 180;
  return std::abs(first_order(lens).effective_focal_length) * (field > 1 ? field : std::tan(field));
}

Seen seen(const std::string& id) {
  const Prescription p = testing::data_prescription(id);
  const Lens lens = compile(p);
  return {lens, film_radius(p, lens)};
}

/// Numbers of random lines through film and pupils that pass the lens, and of passing lines that the table does not
/// sample from scene points at distances from 10 mm to 1 km.
struct Count {
  std::uint32_t passed = 0, missed = 0;
};

Count count_missed(const Seen& s, std::uint32_t lines) {
  const core_detail::Kronecker<5> random(1);
  Count count;
  for (std::uint32_t i = 0; i < lines; ++i) {
    const auto [a, b, u, v, e] = random(i);
    const double r = s.radius * std::sqrt(a);
    const FilmPoint film{r * std::sin(2 * pi * b), r * std::cos(2 * pi * b)};
    const PupilSample at = s.pupils.sample(film, u, v);
    if (!(at.area > 0)) continue;
    const auto end = s.leaving(film, at.x, at.y);
    if (!end.transmitted()) continue;
    const Vec3<double> point = end.ray.origin + end.ray.direction * std::pow(10, 1 + 5 * e);
    ++count.passed;
    count.missed += !(s.table.pdf(point, {point, -end.ray.direction}) > 0);
  }
  return count;
}

class EntranceTables : public ::testing::TestWithParam<const char*> {};

// If more than 1e-5 of the lines were missed, the test would pass with a probability below 5 %.
TEST_P(EntranceTables, Cover300000LinesFromTheFilm) {
  const Count count = count_missed(seen(GetParam()), 300000);
  EXPECT_GT(count.passed, 250000U);
  EXPECT_EQ(count.missed, 0U);
}

INSTANTIATE_TEST_SUITE_P(Lenses, EntranceTables,
                         ::testing::Values("double_gauss_100mm_f2_28deg", "biogon_35mm_f2.8", "fisheye_6.3mm_f2.8",
                                           "petzval_100mm_f1.25", "anamorphic_60mm_2x"));

TEST(EntrancePupilTable, MostSamplesPassCylinders) {
  for (const double f_number : {3.0, 8.0, 32.0}) {
    const Seen s(with_f_number(testing::data_lens("anamorphic_60mm_2x"), f_number), 14.4);
    const core_detail::Kronecker<5> random(3);
    int passed = 0, all = 0;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const auto [x, y, u, v, e] = random(i);
      const FilmPoint film{21.95 * (x - 0.5), 18.6 * (y - 0.5)};
      const PupilSample at = s.pupils.sample(film, u, v);
      const auto end = s.leaving(film, at.x, at.y);
      if (!end.transmitted()) continue;
      const Vec3<double> point = end.ray.origin + end.ray.direction * (300 * std::pow(10, 3 * e));
      const EntranceSample sample = s.table.sample(point, v, u);
      EXPECT_NEAR(s.table.pdf(point, {point, sample.direction}) / sample.pdf, 1, 1e-6);
      ++all;
      passed += trace(s.lens, Ray<double>{sample.origin, sample.direction}).transmitted();
    }
    EXPECT_GT(all, 3800);
    EXPECT_GT(passed, 0.8 * all) << f_number;
  }
}

TEST(EntrancePupilTable, CoversThePupilsOfEveryLens) {
  for (const Prescription& p : testing::data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const double radius = film_radius(p, lens);
    if (!std::isfinite(radius)) continue;
    // Of 100000 lines, 97 are missed for the ball, which forms no sharp image, and 1 in total for all other lenses.
    EXPECT_LE(count_missed({lens, radius}, 10000).missed, p.id == "ball_10mm" ? 20U : 0U);
  }
}

TEST(EntrancePupilTable, DensityIntegratesToOne) {
  for (const char* id : {"double_gauss_100mm_f2_28deg", "fisheye_8mm_f2.8", "cylinder_3.9mm"}) {
    SCOPED_TRACE(id);
    const Seen s = seen(id);
    for (const Vec3<double> point : {Vec3<double>{0, 0, -2000}, Vec3<double>{300, -200, -3000},
                                     Vec3<double>{-15, 20, -60}, Vec3<double>{4, 3, -30}}) {
      SCOPED_TRACE(point.z);
      // The mean of 1 / pdf is the sampled solid angle.
      constexpr std::uint32_t draws = 1 << 12;
      double solid = 0, widest = 0;
      const Vec3<double> axis = s.table.sample(point, 0.5, 0).direction;
      for (std::uint32_t i = 0; i < draws; ++i) {
        const auto uv = owen_sobol(i, 4);
        const double u = uv.x, v = uv.y;
        const EntranceSample sample = s.table.sample(point, u, v);
        ASSERT_GT(sample.pdf, 0);
        EXPECT_NEAR(glm::length(sample.direction), 1, 1e-12);
        EXPECT_NEAR(s.table.pdf(point, {point, sample.direction}) / sample.pdf, 1, 1e-7);
        EXPECT_NEAR(glm::distance(point + sample.direction * sample.distance, sample.origin), 0, 1e-9);
        solid += 1 / sample.pdf / draws;
        widest = std::max(widest, 1 - glm::dot(axis, sample.direction));
      }
      // Uniform directions in a cone around the pupil give the same solid angle.
      const double cone = std::min(1.01 * widest, 2.0);
      const Vec3<double> x = glm::normalize(glm::cross(axis, Vec3<double>{0.3, 1, 0.2})), y = glm::cross(axis, x);
      double met = 0, whole = 0;
      for (std::uint32_t i = 0; i < 4 * draws; ++i) {
        const auto uv = owen_sobol(i, 5);
        const double u = uv.x, v = uv.y;
        const double sine = std::sqrt(cone * v * (2 - cone * v));
        const Vec3<double> d =
            axis * (1 - cone * v) + x * (sine * std::cos(2 * pi * u)) + y * (sine * std::sin(2 * pi * u));
        const double pdf = s.table.pdf(point, {point, d});
        met += (pdf > 0 ? 1.0 : 0.0) * 2 * pi * cone / (4 * draws);
        whole += pdf * 2 * pi * cone / (4 * draws);
      }
      EXPECT_NEAR(met / solid, 1, 0.01);
      EXPECT_NEAR(whole, 1, 0.01);
    }
  }
}

TEST(EntrancePupilTable, SpreadSamplesAreUniform) {
  const Seen s = seen("double_gauss_100mm_f2_28deg");
  const Vec3<double> point{30, 250, -1500};
  std::vector<double> u, v;
  Vec3<double> mean{0, 0, 0};
  double all = 0;
  constexpr int side = 256;
  for (int i = 0; i < side * side; ++i) {
    u.push_back((i % side + 0.5) / side), v.push_back((i / side + 0.5) / side);
    // For a small pupil 1 / pdf is nearly proportional to the area of a sample.
    const EntranceSample one = s.table.sample(point, u.back(), v.back());
    mean += one.origin / one.pdf, all += 1 / one.pdf;
  }
  mean /= all;
  std::vector<EntranceSample> samples(u.size());
  s.table.spread(point, u.size(), u.data(), v.data(), 0, samples.data());
  Vec3<double> even{0, 0, 0};
  for (const EntranceSample& sample : samples) {
    EXPECT_NEAR(sample.pdf * all / side / side, 1, 0.05);
    even += sample.origin / static_cast<double>(u.size());
  }
  EXPECT_NEAR(glm::length(even - mean), 0, 0.02);
}

TEST(EntrancePupilTable, SpreadSkipsInvalidNumbersAndPoints) {
  const Seen s = seen("double_gauss_100mm_f2_28deg");
  const std::vector<double> u{0, 0.3, 0.99, std::numeric_limits<double>::quiet_NaN(), 1}, v{0.5, 0, 1, 0.5, 0.7};
  // A point in the table, a point too close for the table (sampled by a cone), and a point outside all fields.
  for (const Vec3<double> point : {Vec3<double>{30, 50, -800}, Vec3<double>{0, 1, -3}, Vec3<double>{0, 9000, -1000}}) {
    std::vector<EntranceSample> samples(u.size(), EntranceSample{.distance = 7, .pdf = 7});
    s.table.spread(point, u.size(), u.data(), v.data(), 0, samples.data());
    EXPECT_EQ(samples[3].pdf, 0);
    for (const std::size_t i : {0, 1, 2, 4}) EXPECT_EQ(samples[i].pdf > 0, point.y < 9000);
  }
}

TEST(EntrancePupilTable, PointsBehindTheFrontHaveNoSamples) {
  const Seen s = seen("double_gauss_100mm_f2_28deg");
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Vec3<double> point : {Vec3<double>{0, 0, 20}, Vec3<double>{0, 0, 1}, Vec3<double>{5, 5, 500},
                                   Vec3<double>{0, 5000, 300}, Vec3<double>{nan, 0, -100}, Vec3<double>{0, inf, -100},
                                   Vec3<double>{0, 0, -inf}, Vec3<double>{0, 9000, -1000}}) {
    const EntranceSample sample = s.table.sample(point, 0.4, 0.6);
    EXPECT_EQ(sample.pdf, 0) << point.x << ' ' << point.y << ' ' << point.z;
    EXPECT_TRUE(std::isfinite(sample.origin.x + sample.direction.x + sample.distance));
    EXPECT_EQ(s.table.pdf(point, {point, {0, 0, 1}}), 0);
  }
  EXPECT_EQ(s.table.sample({0, 0, -1000}, 0.4, 0.6, 1).pdf, 0);
  EXPECT_EQ(s.table.sample({0, 0, -1000}, nan, 0.6).pdf, 0);
  EXPECT_EQ(s.table.pdf({0, 0, -1000}, {{0, 0, -1000}, {nan, 0, 1}}), 0);
  EXPECT_EQ(s.table.pdf({0, 0, -1000}, {{0, 0, -1000}, {0, 0, -1}}), 0);
  EXPECT_GT(s.table.sample({0, 0, -1000}, 0, 1).pdf, 0);
}

// Film points reach the edge of the image circle in every direction; with cylinders the edge depends on the direction.
TEST(LeavingRays, CoverTheFilm) {
  const FilmPupilTable pupils = FilmPupilTable::enclosing(testing::data_lens("anamorphic_60mm_2x"), 40);
  constexpr std::size_t directions = 256;
  std::array<double, directions> reach{};
  const auto rays =
      leaving_rays(pupils, false,
                   [&](std::size_t count, const TwoPlaneRays<const double>& lines, std::size_t,
                       const RayArrays<double>&, RayFate* fates) {
                     for (std::size_t i = 0; i < count; ++i) {
                       const double x = lines.film_x[i], y = lines.film_y[i], turn = std::atan2(x, y) / (2 * pi);
                       const auto k = static_cast<std::size_t>((turn - std::floor(turn)) * directions) % directions;
                       reach[k] = std::max(reach[k], std::hypot(x, y));
                       fates[i] = RayFate::missed_surface;
                     }
                   });
  EXPECT_EQ(rays.size(), 1u);
  EXPECT_TRUE(rays[0].empty());
  const auto lit_at = [&](double direction) {
    const double turn = 2 * pi * direction / directions;
    double lit = 40;
    while (lit > 0 && pupils.area({lit * std::sin(turn), lit * std::cos(turn)}) == 0) lit -= 0.05;
    return lit;
  };
  double least = 40, most = 0;
  for (std::size_t k = 0; k < directions; ++k) {
    const auto direction = static_cast<double>(k);
    const auto [low, high] = std::minmax({lit_at(direction), lit_at(direction + 0.5), lit_at(direction + 1)});
    least = std::min(least, low), most = std::max(most, high);
    EXPECT_GT(reach[k], 0.98 * low) << k;
    EXPECT_LT(reach[k], 1.01 * high) << k;
  }
  EXPECT_LT(least, 0.9 * most);
}

}  // namespace entrance_pupil_table_test
}  // namespace petzval
