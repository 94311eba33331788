// SPDX-License-Identifier: Apache-2.0
// Pupils at wavelengths that the lens was not compiled for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace any_wavelength_test {

using namespace petzval;

Lens compiled(const Prescription& prescription, const std::vector<double>& wavelengths_nm) {
  static const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return compile(prescription, wavelengths_nm, {.glasses = &glasses, .missing_glass = MissingGlass::abbe});
}

constexpr std::array ids{"double_gauss_100mm_f2.0",
                         "fisheye_6.3mm_f2.8",
                         "tessar_100mm_f2.8",
                         "telephoto_200mm_f1.8",
                         "modern_58mm_f0.95",
                         "catadioptric_mangin_1000mm_f7.5",
                         "catadioptric_corrector_25mm_f1.25",
                         "anamorphic_60mm_2x"};

struct Shares {
  double missed = 0, passing = 0;  // fraction of passing rays outside the samples; fraction of samples that pass
};

/// Measured with samples of the table, and with rays in a band around its polygons that has a tenth of their area.
Shares shares(const Lens& lens, const FilmPupilTable& table, double radius, Wavelength wavelength) {
  constexpr int points = 24, samples = 1500;
  const TwoPlanes& space = table.space();
  const double towards = towards_scene(lens, space);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int lit = 0, in = 0, missed = 0;
  for (int i = 0; i < points; ++i) {
    const double r = radius * (i + unit(random)) / points, azimuth = 2 * std::numbers::pi * unit(random);
    const FilmPoint film{r * std::sin(azimuth), r * std::cos(azimuth)};
    if (!(table.area(film, wavelength) > 0)) continue;
    lit += samples;
    const Vec2<double> middle = table.middle(film, wavelength);
    const auto passes = [&](double x, double y) {
      const Vec3<double> d{x - film.x, y - film.y, space.depth()};
      const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) * towards;
      return trace(lens, Ray<double>{{x, y, space.pupil_z}, d / length}, {Travel::to_scene, wavelength}).transmitted();
    };
    for (int k = 0; k < samples; ++k) {
      const PupilSample s = table.sample(film, unit(random), unit(random), wavelength);
      in += passes(s.x, s.y);
      const PupilSample edge = table.sample(film, unit(random), 1, wavelength);
      const double out = std::sqrt(1 + 0.1 * unit(random));
      const double x = middle.x + out * (edge.x - middle.x), y = middle.y + out * (edge.y - middle.y);
      missed += !table.contains(film, x, y, wavelength) && passes(x, y);
    }
  }
  return {0.1 * missed / std::max(lit, 1), static_cast<double>(in) / std::max(lit, 1)};
}

/// A lens with three wavelengths and its table over the declared field.
struct Tabled {
  Prescription prescription;
  Lens lens;
  double radius;
  FilmPupilTable table;
};

Tabled tabled(const char* id) {
  const Prescription prescription = petzval::testing::data_prescription(id);
  const Lens lens = compiled(prescription, {550, 400, 700});
  const double radius = petzval::testing::declared_radius(prescription, lens);
  return {prescription, lens, radius, FilmPupilTable::enclosing(lens, radius)};
}

TEST(AnyWavelength, NearestCompiledPupilsEncloseIt) {
  for (const char* id : ids) {
    const auto [prescription, lens, radius, table] = tabled(id);
    double worst_share = 1;
    for (const double nm : {474.9, 475.1, 624.9, 625.1, 430., 512.}) {
      const Shares found = shares(lens, table, radius, Wavelength::nm(nm));
      EXPECT_LE(found.missed, 1e-5) << id << " at " << nm;
      worst_share = std::min(worst_share, found.passing);
    }
    // A table of one wavelength is tighter; the difference is the cost of covering adjacent wavelengths.
    const Lens alone = compiled(prescription, {550});
    const double own = shares(alone, FilmPupilTable::enclosing(alone, radius), radius, {}).passing;
    const double shared = shares(lens, table, radius, 0).passing;
    RecordProperty(id, std::to_string(own) + " " + std::to_string(shared) + " " + std::to_string(worst_share));
    EXPECT_GT(shared, own - 0.02) << id;
    EXPECT_GT(worst_share, own - 0.04) << id;
  }
}

TEST(AnyWavelength, ClosedFormPupilsAreInterpolated) {
  const TwoPlanes space{.film_z = 0, .pupil_z = -50};
  // Radii are linear and shifts quadratic in 1 / nm.
  const auto disc_at = [](double nm) {
    const double shift = 0.1 + 9e3 / (nm * nm), radius = 5 + 500 / nm;
    return PupilImage{.shift = {shift, shift}, .radius = {radius, radius}};
  };
  const std::vector<double> nm{400, 450, 520, 610, 700};
  std::vector<PupilImage> discs;
  for (const double at : nm) discs.push_back(disc_at(at));
  const auto table = FilmPupilTable::of_iris(space, {}, discs, 20, 2, nm);
  for (double at = 400; at <= 700; at += 7.3) {
    const PupilImage wanted = disc_at(at);
    const FilmPoint film{3, 10};
    EXPECT_NEAR(table.area(film, Wavelength::nm(at)), std::numbers::pi * wanted.radius.x * wanted.radius.x, 1e-3);
    EXPECT_NEAR(table.middle(film, Wavelength::nm(at)).y, wanted.shift.y * film.y, 1e-4);
    const PupilSample edge = table.sample(film, 0.25, 1, Wavelength::nm(at));
    EXPECT_NEAR(std::hypot(edge.x - wanted.shift.x * film.x, edge.y - wanted.shift.y * film.y), wanted.radius.x, 1e-3);
    EXPECT_TRUE(table.contains(film, 0.999 * edge.x, 0.999 * edge.y, Wavelength::nm(at)));
  }
}

TEST(AnyWavelength, TablesWithoutWavelengthsHaveNoPupils) {
  const PupilImage disc{{0, 0}, {2, 2}};
  const auto table = FilmPupilTable::of_iris({.film_z = 0, .pupil_z = -50}, {}, {&disc, 1}, 20);
  EXPECT_FALSE(table.covers(Wavelength::nm(550)));
  EXPECT_EQ(table.area({}, Wavelength::nm(550)), 0);
  EXPECT_GT(table.area({}), 0);
}

TEST(AnyWavelength, ScenePointSamplesCoverEveryRay) {
  for (const char* id : ids) {
    const auto [prescription, lens, radius, table] = tabled(id);
    const EntrancePupilTable entrances = traced_entrances(lens, table);
    const double towards = towards_scene(lens, table.space()), depth = table.space().depth();
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    int passing = 0, missed = 0;
    for (int i = 0; i < 40000; ++i) {
      const Wavelength nm = Wavelength::nm(400 + 300 * unit(random));
      const double r = radius * unit(random), azimuth = 2 * std::numbers::pi * unit(random);
      const FilmPoint film{r * std::sin(azimuth), r * std::cos(azimuth)};
      if (!(table.area(film, nm) > 0)) continue;
      const PupilSample s = table.sample(film, unit(random), std::sqrt(unit(random)), nm);
      const Vec3<double> d{s.x - film.x, s.y - film.y, depth};
      const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) * towards;
      const auto end = trace(lens, Ray<double>{{s.x, s.y, table.space().pupil_z}, d / length}, {Travel::to_scene, nm});
      if (!end.transmitted()) continue;
      const Vec3<double> point = end.ray.origin + end.ray.direction * (i % 2 == 0 ? 1e5 : 3 * lens.film_z());
      if (!entrances.in_front(point)) continue;
      ++passing;
      missed += !(entrances.pdf(point, {point, -end.ray.direction}, nm) > 0);
    }
    EXPECT_GT(passing, 10000) << id;
    EXPECT_LE(missed, 3) << id << " of " << passing;  // 1e-5, as at compiled wavelengths
  }
}

}  // namespace any_wavelength_test
