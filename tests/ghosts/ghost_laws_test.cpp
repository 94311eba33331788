// SPDX-License-Identifier: Apache-2.0
// Laws of ghosts: paraxial images, symmetry, scale, conservation of energy in pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/pupil/aim.hpp"
#include "plain_optics.hpp"

namespace petzval {
namespace ghost_laws_test {

constexpr std::array primary{Wavelength{}};
const GhostOptions coarse{.tolerance = 0.02};  // for laws that hold with few rays

Prescription plate(double index = 1.5) {
  Prescription p;
  p.name = "plate";
  p.surfaces = {{.thickness = 1, .semi_diameter = 5, .stop = true},
                {.thickness = 5, .medium = {.nd = index}, .semi_diameter = 40},
                {.thickness = 50, .semi_diameter = 40}};
  return p;
}

/// The singlet of data/lenses behind a stop.
Lens stopped_singlet(double semi_diameter) {
  Prescription p = petzval::testing::data_prescription("singlet_50mm_biconvex");
  p.surfaces[0].stop = false;
  p.surfaces.insert(p.surfaces.begin(), SurfaceRow{.semi_diameter = semi_diameter, .stop = true});
  p.surfaces[0].thickness = 1;
  return compile(p);
}

/// Direction towards a light at infinity.
ScenePoint far_light(double degrees, double azimuth_degrees = 0) {
  const double sine = std::sin(radians(degrees)), azimuth = radians(azimuth_degrees);
  return {{sine * std::sin(azimuth), sine * std::cos(azimuth), -std::cos(radians(degrees))}, true};
}

double total(const Ghosts& ghosts) {
  double sum = 0;
  for (const GhostPair& pair : ghosts.pairs) sum += pair.energy;
  return sum;
}

std::vector<float> picture(const Lens& lens, const ScenePoint& light, const Film& film, GhostOptions options = {}) {
  std::vector<float> result(static_cast<std::size_t>(film.columns) * static_cast<std::size_t>(film.rows));
  add_ghosts(lens, light, film, primary, result, options);
  return result;
}

double sum_of(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(GhostLaws, GhostOfAPlateIsTheDirectLightTwiceDelayed) {
  const Lens lens = compile(plate());
  for (const double degrees : {0.0, 20.0, 50.0}) {
    const Ghosts ghosts = ghost_pairs(lens, far_light(degrees));
    ASSERT_EQ(ghosts.pairs.size(), 1U);
    const GhostPair& pair = ghosts.pairs[0];
    const double sine = std::sin(radians(degrees)), cosine = std::cos(radians(degrees));
    const double inside = std::sqrt(1 - sine * sine / 2.25);
    const testing::Bare in(1, 1.5, cosine), out(1.5, 1, inside);
    const double power = (in.ts * out.s * out.s * out.ts + in.tp * out.p * out.p * out.tp) / 2;
    EXPECT_NEAR(ghosts.entering_mm2, 25 * std::numbers::pi * cosine, 2e-4 * 25 * std::numbers::pi);
    EXPECT_NEAR(pair.energy, power, 1e-3 * power) << degrees;
    EXPECT_LT(pair.error, 1e-3);
    // Three passages of the plate and 51 mm of air; the beam falls from +y to -y.
    EXPECT_NEAR(pair.centre.y, -(3 * 5 * sine / 1.5 / inside + 51 * sine / cosine), 2e-3);
    EXPECT_NEAR(pair.centre.x, 0, 1e-9);
    EXPECT_NEAR(pair.rms_radius_mm, 5 / std::numbers::sqrt2, 2e-3);
    EXPECT_NEAR(pair.peak_per_mm2, power / (25 * std::numbers::pi), 2e-3 * power / 78);
    EXPECT_FALSE(pair.caustic);
  }
}

TEST(GhostLaws, GhostsOfTwoPlatesAreDelayedByTheSpacesBetweenTheirSurfaces) {
  constexpr std::array indices{1.0, 1.0, 1.5, 1.0, 1.8, 1.0}, lengths{0.0, 1.0, 5.0, 2.0, 4.0, 30.0};
  Prescription p;
  p.name = "two plates";
  for (std::size_t k = 1; k < 6; ++k) {
    p.surfaces.push_back({.thickness = lengths[k], .semi_diameter = k == 1 ? 5.0 : 80.0, .stop = k == 1});
    if (indices[k] > 1) p.surfaces.back().medium.nd = indices[k];
  }
  const Lens lens = compile(p);
  for (const double degrees : {0.0, 35.0, 60.0}) {
    const double sine = std::sin(radians(degrees));
    const auto cosine = [&](std::size_t space) { return std::sqrt(1 - std::pow(sine / indices[space], 2)); };
    const Ghosts ghosts = ghost_pairs(lens, far_light(degrees));
    ASSERT_EQ(ghosts.pairs.size(), 6U);
    for (const GhostPair& pair : ghosts.pairs) {
      double s = 0.5, p_power = 0.5, y = 0;
      for (std::size_t k = 1; k <= 5; ++k) {
        const bool between = pair.first < k && k <= pair.second;  // the space behind the surface k - 1
        y -= (between ? 3 : 1) * lengths[k] * sine / indices[k] / cosine(k);
      }
      // Each surface transmits once, those between the reflections three times.
      for (std::size_t k = 1; k <= 4; ++k) {
        const testing::Bare bare(indices[k], indices[k + 1], cosine(k));
        const int times = pair.first < k && k < pair.second ? 3 : 1;
        const bool reflects = k == pair.first || k == pair.second;
        s *= std::pow(bare.ts, times) * (reflects ? bare.s : 1);
        p_power *= std::pow(bare.tp, times) * (reflects ? bare.p : 1);
      }
      SCOPED_TRACE(std::to_string(pair.first) + ' ' + std::to_string(pair.second));
      EXPECT_NEAR(pair.energy, s + p_power, 1e-3 * (s + p_power)) << degrees;
      EXPECT_NEAR(pair.centre.y, y, 2e-3);
    }
  }
}

TEST(GhostLaws, UniformSheetIsFlatAndHasTheIrradianceOfThePair) {
  const Lens lens = compile(plate());
  const Film film{.width_mm = 12, .height_mm = 12, .columns = 300, .rows = 300};
  const std::vector<float> values = picture(lens, far_light(0), film);
  const double expected = 0.96 * 0.04 * 0.04 * 0.96;
  for (int row = 0; row < 300; ++row) {
    for (int column = 0; column < 300; ++column) {
      const FilmPoint at = film.point(column + 0.5, row + 0.5);
      const double r = std::hypot(at.x, at.y), value = values[static_cast<std::size_t>(300 * row + column)];
      if (std::abs(r - 5) < 0.04) continue;
      ASSERT_NEAR(value, r < 5 ? expected : 0, 1e-5 * expected) << column << ", " << row;
    }
  }
}

// The density falls by 20 % from the middle to the edge, in steps from deposit to deposit.
TEST(GhostLaws, SlantedSheetHasStepsBelowOnePercent) {
  const Film film{.width_mm = 24, .height_mm = 24, .columns = 600, .rows = 600, .shift_y_mm = -2};
  const std::vector<float> values = picture(stopped_singlet(2), far_light(6), film);
  const float peak = *std::ranges::max_element(values);
  int inner = 0;
  for (std::size_t i = 4 * 600; i < values.size() - 4 * 600; ++i) {
    if (std::min({values[i - 4], values[i + 4], values[i - 2400], values[i + 2400]}) < 0.2F * peak) continue;
    ++inner;
    ASSERT_NEAR(values[i], (values[i - 1] + values[i + 1]) / 2, 0.01 * values[i]) << i;
    ASSERT_NEAR(values[i], (values[i - 600] + values[i + 600]) / 2, 0.01 * values[i]) << i;
  }
  EXPECT_GT(inner, 10'000);
}

using Matrix = std::array<double, 4>;  // acts on the height and the slope per length travelled

Matrix after(const Matrix& b, const Matrix& a) {
  return {b[0] * a[0] + b[1] * a[2], b[0] * a[1] + b[1] * a[3], b[2] * a[0] + b[3] * a[2], b[2] * a[1] + b[3] * a[3]};
}
Matrix travel(double distance) { return {1, distance, 0, 1}; }
Matrix refraction(double in, double out, double curvature) { return {1, 0, (in - out) * curvature / out, in / out}; }
/// @param curvature positive if the centre lies in front of the mirror, on the side of the light
Matrix mirror(double curvature) { return {1, 0, -2 * curvature, 1}; }

TEST(GhostLaws, GhostsOfASingletAndAConcentricMeniscusAreParaxial) {
  for (const auto& [front_radius, back_radius] : {std::pair{50.0, -50.0}, {-40.0, -46.0}, {46.0, 40.0}}) {
    SCOPED_TRACE(front_radius);
    Prescription p;
    p.name = "singlet";
    p.surfaces = {{.thickness = 1, .semi_diameter = 0.2, .stop = true},
                  {.radius = front_radius, .thickness = 6, .medium = {.nd = 1.6}, .semi_diameter = 12},
                  {.radius = back_radius, .thickness = 45, .semi_diameter = 12}};
    const Lens lens = compile(p);
    const double front = 1 / front_radius, back = 1 / back_radius;
    Matrix m = after(refraction(1, 1.6, front), travel(1));
    m = after(travel(6), m);
    m = after(travel(6), after(mirror(-back), m));  // light towards +z: the centre of the back is at -z
    m = after(travel(6), after(mirror(front), m));
    m = after(travel(45), after(refraction(1.6, 1, back), m));
    const Ghosts ghosts = ghost_pairs(lens, far_light(1));
    ASSERT_EQ(ghosts.pairs.size(), 1U);
    const double centre = -m[1] * std::tan(radians(1)), radius = std::abs(m[0]) * 0.2 / std::numbers::sqrt2;
    EXPECT_NEAR(ghosts.pairs[0].centre.y, centre, 3e-3 * std::abs(m[1]) * radians(1));
    EXPECT_NEAR(ghosts.pairs[0].rms_radius_mm, radius, 2e-3 * std::abs(m[0]) * 0.2);
    EXPECT_FALSE(ghosts.pairs[0].caustic);
  }
}

TEST(GhostLaws, ScaledLensHasScaledGhosts) {
  const Prescription p = petzval::testing::data_prescription("double_gauss_100mm_f2.0");
  const Ghosts one = ghost_pairs(compile(p), far_light(7), coarse),
               two = ghost_pairs(compile(scale(p, 2)), far_light(7), coarse);
  ASSERT_EQ(one.pairs.size(), two.pairs.size());
  EXPECT_NEAR(two.entering_mm2, 4 * one.entering_mm2, 1e-9 * one.entering_mm2);
  for (std::size_t k = 0; k < one.pairs.size(); ++k) {
    const GhostPair &a = one.pairs[k], &b = two.pairs[k];
    ASSERT_EQ(a.first, b.first);
    EXPECT_NEAR(b.energy, a.energy, 1e-9 * a.energy);
    EXPECT_NEAR(b.centre.y, 2 * a.centre.y, 1e-6);
    EXPECT_NEAR(b.rms_radius_mm, 2 * a.rms_radius_mm, 1e-6);
  }
}

TEST(GhostLaws, TurnedLightHasTurnedGhosts) {
  const Lens lens = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  const Ghosts one = ghost_pairs(lens, far_light(7), coarse), turned = ghost_pairs(lens, far_light(7, 90), coarse);
  const Ghosts slanted = ghost_pairs(lens, far_light(7, 33), coarse);
  ASSERT_EQ(one.pairs.size(), turned.pairs.size());
  EXPECT_NEAR(total(slanted), total(one), 1e-3 * total(one));
  for (std::size_t k = 0; k < 10; ++k) {
    const GhostPair &a = one.pairs[k], &b = turned.pairs[k], &c = slanted.pairs[k];
    EXPECT_NEAR(b.energy, a.energy, 1e-9);
    EXPECT_NEAR(b.centre.x, a.centre.y, 1e-6);
    EXPECT_NEAR(c.centre.x, a.centre.y * std::sin(radians(33)), 0.01);
    EXPECT_NEAR(c.centre.y, a.centre.y * std::cos(radians(33)), 0.01);
  }
}

TEST(GhostLaws, NearLightApproachesALightAtInfinity) {
  const Lens lens = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  const Ghosts far = ghost_pairs(lens, far_light(5), coarse);
  const Vec3<double> towards = far_light(5).position;
  double last = std::numeric_limits<double>::infinity();
  for (const double distance : {1e4, 1e6}) {
    const Ghosts near = ghost_pairs(lens, {towards * distance, false}, coarse);
    const double difference = std::abs(total(near) - total(far));
    EXPECT_LT(difference, last / 10);
    last = difference;
  }
  EXPECT_LT(last, 1e-3 * total(far));
}

TEST(GhostLaws, PictureHoldsTheEnergyOfCaustics) {
  const Lens singlet = petzval::testing::data_lens("singlet_50mm_biconvex");
  const Film film{.width_mm = 400, .height_mm = 400, .columns = 400, .rows = 400};
  const double pixel = film.area_mm2() / (400.0 * 400);
  bool caustic = false;
  // From in front of the focus of the ghost to behind it.
  const double last_z = singlet.surfaces().back().vertex_z;
  for (const double z : {1.0, 3.0, 5.0, 7.0, 9.0, 12.0}) {
    const Lens lens = with_film(singlet, last_z + z);
    const Ghosts ghosts = ghost_pairs(lens, far_light(3));
    caustic = caustic || ghosts.pairs.at(0).caustic;
    const double expected = total(ghosts) * ghosts.entering_mm2;
    EXPECT_NEAR(sum_of(picture(lens, far_light(3), film)) * pixel, expected, 0.005 * expected) << z;
  }
  EXPECT_TRUE(caustic);
}

TEST(GhostLaws, PicturesHoldTheEnergyOfAllPairs) {
  const Lens lens = with_iris(petzval::testing::data_lens("double_gauss_100mm_f2.0"), {.blades = 6});
  const Film film{.width_mm = 4000, .height_mm = 4000, .columns = 100, .rows = 100, .tilt_rad = 0.05};
  const Ghosts ghosts = ghost_pairs(lens, far_light(5));
  const double expected = total(ghosts) * ghosts.entering_mm2;
  const std::vector<float> values = picture(lens, far_light(5), film);
  EXPECT_NEAR(sum_of(values) * 1600, expected, 0.01 * expected);
  EXPECT_EQ(values, picture(lens, far_light(5), film, {.threads = 3}));
  std::vector<float> twice = values;
  add_ghosts(lens, far_light(5), film, primary, twice);
  EXPECT_NEAR(sum_of(twice), 2 * sum_of(values), 1e-5 * sum_of(values));
}

// Blades of a stop between the reflecting surfaces clip three times, of a stop behind them once.
TEST(GhostLaws, IrisClipsAtEveryPassage) {
  const Lens round = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  const Lens bladed = with_iris(round, {.blades = 3});
  const Ghosts all = ghost_pairs(round, far_light(0), coarse), clipped = ghost_pairs(bladed, far_light(0), coarse);
  EXPECT_LT(total(clipped), total(all));
  for (const GhostPair& pair : clipped.pairs) {
    const auto same = std::ranges::find_if(
        all.pairs, [&](const GhostPair& own) { return own.first == pair.first && own.second == pair.second; });
    ASSERT_NE(same, all.pairs.end());
    EXPECT_LE(pair.energy, same->energy * 1.002);
  }
}

TEST(GhostLaws, LimitedPairsAreCounted) {
  const Lens lens = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  const Ghosts all = ghost_pairs(lens, far_light(0), coarse),
               some = ghost_pairs(lens, far_light(0), {.max_pairs = 10, .tolerance = 0.02});
  EXPECT_EQ(all.left_out, 0U);
  EXPECT_EQ(some.left_out, all.left_out + 10 * 9 / 2 - 10);
  EXPECT_GT(some.left_out_energy, 0);
  EXPECT_LE(total(some), total(all));
  EXPECT_LE(total(all), total(some) + some.left_out_energy * 1.5);
}

TEST(GhostLaws, ThreadsDoNotMatter) {
  const Lens lens = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  const Ghosts one = ghost_pairs(lens, far_light(9), coarse),
               four = ghost_pairs(lens, far_light(9), {.tolerance = 0.02, .threads = 4});
  ASSERT_EQ(one.pairs.size(), four.pairs.size());
  for (std::size_t k = 0; k < one.pairs.size(); ++k) {
    EXPECT_EQ(one.pairs[k].energy, four.pairs[k].energy);
    EXPECT_EQ(one.pairs[k].peak_per_mm2, four.pairs[k].peak_per_mm2);
  }
}

// A front surface that turns away from the light: rays miss it inside of its rim.
TEST(GhostLaws, LightEntersSteepFrontsUpToTheirOutline) {
  const Lens lens = petzval::testing::data_lens("hologon_15mm_f8");
  const testing::PlainLens plain(lens);
  for (const double degrees : {0.0, 22.5, 45.0}) {
    const double angle = radians(degrees), half = 2 * plain.surfaces[0].rim, step = half / 500;
    const testing::V d{0, std::sin(angle), std::cos(angle)};
    int entered = 0;
    for (int k = 0; k < 1'000'000; ++k) {
      const double x = (k % 1000 + 0.5) * step - half, y = (k / 1000 + 0.5) * step - half;
      testing::V normal;
      if (plain.meet(0, {x, y * d.z, -y * d.y}, d, normal)) ++entered;
    }
    const double area = entered * step * step;
    EXPECT_NEAR(ghost_pairs(lens, far_light(-degrees), {.only = {{0, 1}}}).entering_mm2, area, 1e-3 * area) << degrees;
  }
}

TEST(GhostLaws, RefusesBadInput) {
  const Lens lens = compile(plate());
  const auto refused = [&](const ScenePoint& light, std::vector<petzval::testing::Token> tokens,
                           const GhostOptions& options = {}) {
    petzval::testing::expect_error([&] { ghost_pairs(lens, light, options); }, tokens);
  };
  refused({{0, 0, 1}, true}, {"light"});                                   // behind the lens
  refused({{0, 0, lens.film_z()}, false}, {"light", "z", lens.film_z()});  // on the film
  refused({{0, 0, 2.5}, false}, {"light", "z", 2.5});                      // inside the glass
  refused({{0, 0, 0}, false}, {"light", "position"});                      // on the front vertex
  refused({{0, 0, std::numeric_limits<double>::infinity()}, false}, {"light", "position"});
  refused({{0, 0, -0.1}, false}, {"light", "distance", 0.1});
  refused(far_light(0), {"film_reflectance", 1.5}, {.film_reflectance = 1.5});
  refused(far_light(0), {"threads", 0}, {.threads = 0});
  refused(far_light(0), {"tolerance", 0}, {.tolerance = 0});
  std::vector<float> values(4);
  const auto add = [&](const Film& film) {
    return [&, film] { add_ghosts(lens, far_light(0), film, primary, values); };
  };
  petzval::testing::expect_error(add({.width_mm = 0, .columns = 2, .rows = 2}), {"film", "width_mm", 0});
  petzval::testing::expect_error(add({.columns = 2, .rows = 3}), {"pictures", 4, 6});
  Prescription open = plate();
  open.surfaces[0].semi_diameter = std::numeric_limits<double>::infinity();
  petzval::testing::expect_error([&] { ghost_pairs(compile(open), far_light(0)); }, {"surface 0", "semi_diameter"});
}

TEST(GhostLaws, ParaxialGhostsEqualExactOnesNearTheAxis) {
  for (const char* const id : {"double_gauss_52mm_f1.8", "anamorphic_60mm_2x"}) {
    for (const int blades : {0, 5}) {
      Lens lens = petzval::testing::data_lens(id);
      for (std::size_t i = 0; i < lens.surface_count(); ++i) {
        lens = with_semi_diameter(lens, i, 0.01 * lens.surfaces()[i].semi_diameter);
      }
      lens = with_iris(lens, {.blades = blades});
      const ScenePoint light = far_light(0.1);
      const Ghosts exact = ghost_pairs(lens, light),
                   paraxial = ghost_pairs(lens, light, {.model = GhostModel::paraxial});
      double off = 0;
      for (const GhostPair& pair : exact.pairs) {
        const auto same = std::ranges::find_if(paraxial.pairs, [&](const GhostPair& other) {
          return other.first == pair.first && other.second == pair.second;
        });
        if (pair.energy < 0.01 * total(exact)) continue;
        ASSERT_NE(same, paraxial.pairs.end()) << id << ", " << pair.first << ", " << pair.second;
        off += std::abs(same->energy - pair.energy);
        const double radius = pair.rms_radius_mm;
        EXPECT_NEAR(same->rms_radius_mm, radius, 0.02 * radius) << id << ", " << pair.first << ", " << pair.second;
        EXPECT_NEAR(same->centre.x, pair.centre.x, 0.02 * radius);
        EXPECT_NEAR(same->centre.y, pair.centre.y, 0.02 * radius);
      }
      EXPECT_LT(off, 0.01 * total(exact)) << id << ", " << blades << " blades";
    }
  }
}

}  // namespace ghost_laws_test
}  // namespace petzval
