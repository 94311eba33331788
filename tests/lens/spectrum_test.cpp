// SPDX-License-Identifier: Apache-2.0
// Indices between compiled wavelengths.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "lens/between_wavelengths.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace spectrum_test {

using petzval::compile;
using petzval::CompileOptions;
using petzval::Glass;
using petzval::GlassCatalogue;
using petzval::Lens;
using petzval::Prescription;
using petzval::RayWavelengths;
using petzval::Wavelength;
namespace lens_detail = petzval::lens_detail;
using petzval::testing::expect_error;

const std::filesystem::path data = PETZVAL_TEST_DATA;

const CompileOptions& by_catalogue() {
  static const auto glasses = GlassCatalogue::load(data / "glass");
  static const CompileOptions options{.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe};
  return options;
}

/// Equal steps from one wavelength to another.
std::vector<double> steps(double from, double to, std::size_t count) {
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i) {
    result.push_back(from +
                     (to - from) * static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(count, 2) - 1));
  }
  return result;
}

/// A prescription with one glass.
Prescription window(const Glass& glass) {
  Prescription p;
  p.name = "window of " + glass.name;
  p.surfaces = {{.thickness = 5, .medium = {.glass = glass.name, .catalogue = glass.catalogue, .nd = glass.nd}},
                {.thickness = 50}};
  return p;
}

/// Largest difference between interpolated indices and the indices of a lens compiled for the wavelength, over a fine
/// comb.
double largest_error(const Lens& lens, const Prescription& prescription, const CompileOptions& options) {
  const auto [from, to] = std::minmax_element(lens.wavelengths_nm().begin(), lens.wavelengths_nm().end());
  double largest = 0;
  for (const double nm : steps(*from, *to, 61)) {
    const Lens own = compile(prescription, std::vector{nm}, options);
    for (std::size_t space = 0; space <= lens.surface_count(); ++space) {
      largest = std::max(largest, std::abs(lens.index(space, Wavelength::nm(nm)) - own.index(space)));
    }
  }
  return largest;
}

TEST(Spectrum, EightWavelengthsGiveTheIndicesOfAllLenses) {
  double worst = 0;
  std::size_t lenses = 0;
  for (const Prescription& prescription : petzval::testing::data_prescriptions()) {
    try {
      compile(prescription, steps(400, 700, 8), by_catalogue());
    } catch (const petzval::Error&) {
      continue;  // unknown dispersion
    }
    const Lens lens = compile(prescription, steps(400, 700, 8), by_catalogue());
    const double found = largest_error(lens, prescription, by_catalogue());
    EXPECT_LE(found, lens.index_error() + 1e-15) << prescription.id;
    EXPECT_LT(found, 5e-8) << prescription.id;
    worst = std::max(worst, found);
    ++lenses;
  }
  EXPECT_GT(lenses, 50u);
  EXPECT_GT(worst, 1e-9) << "the comparison shows nothing";
}

TEST(Spectrum, StatedErrorOfEveryGlassHolds) {
  for (const auto& [from, to, limit] :
       {std::tuple(400., 700., 7e-7), std::tuple(380., 780., 6e-6), std::tuple(400., 1000., 4e-6)}) {
    double worst = 0;
    for (const Glass& glass : by_catalogue().glasses->glasses()) {
      if (glass.shortest_nm > from || glass.longest_nm < to) continue;
      const CompileOptions options{.glasses = by_catalogue().glasses, .index_policy = petzval::IndexPolicy::catalogue};
      const Prescription prescription = window(glass);
      const Lens lens = compile(prescription, std::vector{from, to}, options);
      const double found = largest_error(lens, prescription, options);
      ASSERT_LE(found, lens.index_error() + 1e-15) << glass.name << " of " << glass.catalogue;
      worst = std::max(worst, lens.index_error());
    }
    EXPECT_LT(worst, limit) << from << " to " << to;
    EXPECT_GT(worst, limit / 100) << from << " to " << to;
  }
}

TEST(Spectrum, ErrorIsIndependentOfNumberAndSpacingOfWavelengths) {
  const Prescription prescription = petzval::read_prescription(data / "lenses/double_gauss_100mm_f2.0.json");
  std::vector<double> cluster = steps(550, 550.001, 40);
  cluster.push_back(400), cluster.push_back(700);
  for (const auto& wavelengths :
       {std::vector{700., 400.}, steps(400, 700, 40), cluster, std::vector{587.5618, 400., 700.}}) {
    const Lens lens = compile(prescription, wavelengths, by_catalogue());
    EXPECT_LT(lens.index_error(), 2e-8);
    EXPECT_LT(largest_error(lens, prescription, by_catalogue()), 2e-8);
  }
  for (const auto& wavelengths : {steps(550, 550.001, 40), std::vector{550., 550.000002}}) {
    const Lens lens = compile(prescription, wavelengths, by_catalogue());
    EXPECT_LT(lens.index_error(), 1e-13);
    EXPECT_LT(largest_error(lens, prescription, by_catalogue()), 3e-10);  // compiled wavelengths match within 1e-6 nm
  }
  const Lens one = compile(prescription, std::vector{550.}, by_catalogue());
  EXPECT_EQ(one.index_error(), 0);
  EXPECT_TRUE(one.covers(Wavelength::nm(550)));
  EXPECT_FALSE(one.covers(Wavelength::nm(550.01)));
}

TEST(Spectrum, CompiledWavelengthsInNmHaveTheirIndices) {
  const Prescription prescription = petzval::read_prescription(data / "lenses/double_gauss_100mm_f2.0.json");
  const Lens lens = compile(prescription, steps(400, 700, 8), by_catalogue());
  for (std::size_t w = 0; w < 8; ++w) {
    const Wavelength own = Wavelength::nm(lens.wavelengths_nm()[w] + 5e-7);
    EXPECT_EQ(lens.wavelength_index(own), w);
    for (std::size_t space = 0; space <= lens.surface_count(); ++space) {
      EXPECT_EQ(lens.index(space, own), lens.index(space, w));
    }
  }
}

TEST(Spectrum, FirstOrderTakesAnyWavelength) {
  const Prescription prescription = petzval::read_prescription(data / "lenses/double_gauss_100mm_f2.0.json");
  const Lens lens = compile(prescription, std::vector{400., 700.}, by_catalogue());
  const Lens own = compile(prescription, std::vector{546.1}, by_catalogue());
  const auto found = first_order(lens, Wavelength::nm(546.1)), wanted = first_order(own);
  EXPECT_NEAR(found.effective_focal_length, wanted.effective_focal_length, 1e-5);
  EXPECT_NEAR(pupils(lens, Wavelength::nm(546.1)).entrance.z, pupils(own).entrance.z, 1e-5);
}

TEST(Spectrum, OtherWavelengthsAreRefused) {
  const Prescription prescription = petzval::read_prescription(data / "lenses/double_gauss_100mm_f2.0.json");
  const Lens lens = compile(prescription, std::vector{400., 550., 700.}, by_catalogue());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double nm : {nan, infinity, -infinity, 0., -550., 399.9, 700.1}) {
    const Wavelength bad = Wavelength::nm(nm);
    EXPECT_FALSE(lens.covers(bad)) << nm;
    EXPECT_THROW(lens.index(0, bad), petzval::Error) << nm;
    EXPECT_THROW(lens.wavelength_index(bad), petzval::Error) << nm;
  }
  EXPECT_TRUE(lens.covers(Wavelength::nm(double{400.f * (1 - 0x1p-24f)})));
  expect_error([&] { lens.index(1, Wavelength::nm(710)); }, {lens.name(), "wavelength", 710});
  expect_error([&] { lens.wavelength_index(Wavelength::nm(510)); }, {lens.name(), "wavelength", 510});
  EXPECT_FALSE(lens.covers(3));
  EXPECT_TRUE(lens.covers(2));
}

TEST(Spectrum, MediumWithoutIndicesBetweenWavelengthsKeepsCompiledIndices) {
  // A formula with a pole at 500 nm.
  const Glass odd{.catalogue = "test",
                  .name = "POLE",
                  .nd = 1.5,
                  .vd = 30,
                  .formula = petzval::DispersionFormula::sellmeier,
                  .shortest_nm = 300,
                  .longest_nm = 2000,
                  .coefficients = {0, 0.3, 0.25, 1, 0.01}};
  const GlassCatalogue glasses({odd});
  const CompileOptions options{.glasses = &glasses, .index_policy = petzval::IndexPolicy::catalogue};
  const Lens lens = compile(window(odd), std::vector{400., 700.}, options);
  EXPECT_TRUE(std::isinf(lens.index_error()));
  EXPECT_FALSE(lens.covers(Wavelength::nm(550)));
  EXPECT_EQ(lens.index(1, Wavelength::nm(700)), lens.index(1, 1));
  expect_error([&] { lens.index(1, Wavelength::nm(550)); }, {"POLE", "wavelength", 550});
}

// For any spacing, functions linear in 1 / nm are exact, and values at compiled wavelengths are kept.
TEST(Spectrum, ValuesAreInterpolatedBetweenWavelengths) {
  for (const std::vector<double>& nm : {std::vector{400., 700.}, std::vector{400., 550., 700.},
                                        std::vector{400., 500., 600., 700.}, std::vector{700., 400., 475., 550., 625.},
                                        std::vector{400., 405., 700.}, std::vector{400., 550., 555., 560., 700.},
                                        std::vector{404.7, 435.8, 480., 486.1, 546.1, 587.6, 589.3, 706.5}}) {
    const auto line = [](double at) { return 3 - 800 / at; };
    std::vector<std::array<double, 2>> values;
    for (std::size_t i = 0; i < nm.size(); ++i) values.push_back({line(nm[i]), i % 2 ? 1. : -1.});
    const lens_detail::BetweenWavelengths<2> between(lens_detail::CompiledWavelengths(nm), values);
    for (double at = 405; at < 700; at += 0.5) EXPECT_NEAR(between(at)[0], line(at), 1e-4) << nm.size() << " " << at;
    const lens_detail::CompiledWavelengths wavelengths(nm);
    for (std::size_t i = 0; i < nm.size(); ++i) {
      const auto [first, weights] = wavelengths.about(nm[i]);
      double sum = 0;
      for (std::size_t k = 0; k < weights.size() && first + k < nm.size(); ++k) {
        sum += weights[k] * values[wavelengths.position(first + k)][1];
      }
      EXPECT_NEAR(sum, values[i][1], 1e-9) << nm[i];
    }
  }
}

// Equally spaced wavelengths are interpolated by cubics. The worst case for 15 parabolas is a cubic in 1 / nm of height
// 0.3 over the whole range.
TEST(Spectrum, EquallySpacedValuesAreInterpolatedByCubics) {
  for (int count = 4; count <= 9; ++count) {
    std::vector<double> nm;
    for (int i = 0; i < count; ++i) nm.push_back(400 + 300. * i / (count - 1));
    const auto cubic = [](double at) { return std::pow(1000 / at - 2, 3); };
    std::vector<std::array<double, 1>> values;
    for (const double at : nm) values.push_back({cubic(at)});
    const lens_detail::BetweenWavelengths<1> between(lens_detail::CompiledWavelengths(nm), values);
    for (double at = 400; at < 700; at += 0.5) EXPECT_NEAR(between(at)[0], cubic(at), 2e-4) << count << " " << at;
  }
}

TEST(Spectrum, EachRayHasItsWavelength) {
  constexpr float nm[] = {450, 550.5f, 650};
  constexpr std::uint16_t positions[] = {2, 0, 1};
  const RayWavelengths any{.each_nm = nm}, each{.each = positions}, all{.all = Wavelength::nm(500)}, primary{};
  EXPECT_TRUE(any.in_nm());
  EXPECT_TRUE(all.in_nm());
  EXPECT_FALSE(each.in_nm());
  EXPECT_FALSE(primary.in_nm());
  EXPECT_EQ(any.at(1).in_nm(), 550.5);
  EXPECT_EQ(any.from(2).at(0).in_nm(), 650);
  EXPECT_EQ(all.at(7).in_nm(), 500);
  EXPECT_EQ(all.resolved(4).at(7).in_nm(), 500);
  EXPECT_EQ(any.resolved(4).at(1).in_nm(), 550.5);
  EXPECT_EQ(each.index(0, 4), 2u);
  EXPECT_EQ(primary.index(0, 4), 4u);
  EXPECT_GT(any.index(0, 4), 70000u);
}

TEST(Clamp, WavelengthsBeyondAGlass_HaveTheIndexAtTheEndOfItsRange) {
  const Glass& glass = *petzval::glass_tables().find("N-SF5", "schott");  // 370 to 2500 nm
  const Prescription p = window(glass);
  expect_error([&] { compile(p, std::array{360.0, 830.0}); }, {"N-SF5", 370, 2500});
  const Lens lens = compile(p, std::array{360.0, 370.0, 587.5618, 830.0}, {.clamp_wavelengths = true});
  EXPECT_EQ(lens.index(1, 0), lens.index(1, 1));
  EXPECT_EQ(lens.index(1, 2), glass.nd);
  EXPECT_EQ(lens.index(1, 3) - lens.index(1, 2),
            petzval::refractive_index(glass, 830) - petzval::refractive_index(glass, petzval::d_line_nm));
  ASSERT_EQ(lens.clamped_glasses().size(), 1u);
  for (const char* word : {"surface 0", "N-SF5", "370", "2500"}) {
    EXPECT_NE(lens.clamped_glasses()[0].find(word), std::string::npos) << lens.clamped_glasses()[0];
  }
  EXPECT_TRUE(lens.covers(Wavelength::nm(360)));
  EXPECT_FALSE(lens.covers(Wavelength::nm(355)));
  EXPECT_TRUE(compile(p, std::array{370.0, 830.0}, {.clamp_wavelengths = true}).clamped_glasses().empty());
}

TEST(Clamp, ModelOfNdAndVd_IsClampedTo365To1014Nm) {
  Prescription p;
  p.surfaces = {{.thickness = 5, .medium = {.nd = 1.673, .vd = 32.2}}, {.thickness = 50}};
  const CompileOptions options{.missing_glass = petzval::MissingGlass::abbe, .clamp_wavelengths = true};
  const Lens lens = compile(p, std::array{360.0, 365.0, 1014.0, 1100.0}, options);
  EXPECT_EQ(lens.index(1, 0), petzval::abbe_index(1.673, 32.2, 365));
  EXPECT_EQ(lens.index(1, 0), lens.index(1, 1));
  EXPECT_EQ(lens.index(1, 2), lens.index(1, 3));
  EXPECT_EQ(lens.clamped_glasses().size(), 1u);
}

TEST(Clamp, EveryLensOfTheData_CompilesFrom360To830Nm) {
  const CompileOptions options{.missing_glass = petzval::MissingGlass::abbe, .clamp_wavelengths = true};
  double worst = 0;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    if (compile(p).dispersion() == petzval::Dispersion::none) continue;
    const Lens lens = compile(p, std::array{360.0, 830.0}, options);
    worst = std::max(worst, lens.index_error());
  }
  EXPECT_LT(worst, 6e-3);
}

// index_error() covers the whole range, also between the nodes and at the kinks of a clamped formula.
TEST(Clamp, IndexError_BoundsTheDistanceFromTheClampedFormula) {
  double worst = 0;
  for (const Glass& glass : petzval::glass_tables().glasses()) {
    if (glass.catalogue == "infrared") continue;  // opaque, or a small part of the visible range
    const Lens lens = compile(window(glass), std::array{360.0, 830.0}, {.clamp_wavelengths = true});
    for (const double nm : steps(360, 830, 1500)) {
      const double clamped = std::clamp(nm, glass.shortest_nm, glass.longest_nm);
      const double error =
          std::abs(lens.index(1, Wavelength::nm(nm)) - (petzval::refractive_index(glass, clamped) + glass.nd -
                                                        petzval::refractive_index(glass, petzval::d_line_nm)));
      ASSERT_LE(error, lens.index_error() + 1e-12) << glass.catalogue << ' ' << glass.name << ' ' << nm;
      worst = std::max(worst, error);
    }
  }
  EXPECT_LT(worst, 9e-3);
}

}  // namespace spectrum_test
