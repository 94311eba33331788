// SPDX-License-Identifier: Apache-2.0
// Pupils at wavelengths that the lens was not compiled for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "petzval/glass/glass.hpp"
#include "pupil_coverage.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace any_wavelength_test {

using namespace petzval;
using petzval::testing::Coverage;
using petzval::testing::coverage;

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
      const Coverage found = coverage(lens, table, radius, 24, 1500, Wavelength::nm(nm));
      EXPECT_LE(found.missed, 1e-5) << id << " at " << nm;
      worst_share = std::min(worst_share, found.mean);
    }
    // A table of one wavelength is tighter; the difference is the cost of covering adjacent wavelengths.
    const Lens alone = compiled(prescription, {550});
    const double own = coverage(alone, FilmPupilTable::enclosing(alone, radius), radius, 24, 1500).mean;
    const double shared = coverage(lens, table, radius, 24, 1500).mean;
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

}  // namespace any_wavelength_test
