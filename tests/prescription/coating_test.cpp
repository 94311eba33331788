// SPDX-License-Identifier: Apache-2.0
// Fresnel's equations and coatings: closed forms, conservation of energy, reversal.
#include "petzval/prescription/coating.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "../expect_error.hpp"

namespace petzval {
namespace coating_test {

double snell_cosine(double n, double m, double cosine) {
  return std::sqrt(1 - n * n / (m * m) * (1 - cosine * cosine));
}

TEST(SurfaceLight, WithoutCoatingIsFresnel) {
  for (const double cosine : {1.0, 0.8, 0.3, 0.01}) {
    const double behind = snell_cosine(1, 1.5, cosine);
    const SurfaceLight light = surface_light({}, 1, 1.5, cosine, 550);
    EXPECT_NEAR(light.reflectance_s, std::pow((cosine - 1.5 * behind) / (cosine + 1.5 * behind), 2), 1e-14);
    EXPECT_NEAR(light.reflectance_p, std::pow((1.5 * cosine - behind) / (1.5 * cosine + behind), 2), 1e-14);
  }
  EXPECT_NEAR(surface_light({}, 1, 1.5, 1, 550).reflectance(), 0.04, 1e-15);
}

TEST(SurfaceLight, AtBrewstersAngleReflectsNoP) {
  const double cosine = std::cos(std::atan(1.62));
  EXPECT_LT(surface_light({}, 1, 1.62, cosine, 550).reflectance_p, 1e-30);
  EXPECT_GT(surface_light({}, 1, 1.62, cosine, 550).reflectance_s, 0.1);
}

TEST(SurfaceLight, BeyondTheCriticalAngleIsReflected) {
  const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));
  for (const Coating& coating : {Coating{}, Coating::quarter_wave(), Coating{.table = {{400, 0.1}, {700, 0.1}}}}) {
    const SurfaceLight light = surface_light(coating, 1.5, 1, 0.9 * critical, 550);
    EXPECT_NEAR(light.reflectance(), 1, 1e-13);
    EXPECT_NEAR(light.transmittance(), 0, 1e-13);
    EXPECT_EQ(surface_light(coating, 1, 1.5, 0, 550).reflectance(), 1);
  }
}

// Hecht, Optics: magnesium fluoride (1.38) on glass of 1.52 reflects 1.26 % at the wavelength of its quarter wave.
TEST(SurfaceLight, OfAQuarterWaveIsTheClosedForm) {
  const Coating coating = Coating::quarter_wave(1.38, 550);
  for (const double glass : {1.5, 1.52, 1.8}) {
    const double expected = std::pow((glass - 1.38 * 1.38) / (glass + 1.38 * 1.38), 2);
    EXPECT_NEAR(surface_light(coating, 1, glass, 1, 550).reflectance(), expected, 1e-15) << glass;
  }
  EXPECT_NEAR(surface_light(coating, 1, 1.52, 1, 550).reflectance(), 0.0126, 5e-5);
  // A perfect match.
  EXPECT_LT(surface_light(Coating::quarter_wave(std::sqrt(1.52), 550), 1, 1.52, 1, 550).reflectance(), 1e-30);
}

TEST(SurfaceLight, OfAHalfWaveIsThatOfTheBareSurface) {
  const Coating half{.layers = {{.index = 2.1, .thickness_nm = 550 / (2 * 2.1)}}};
  EXPECT_NEAR(surface_light(half, 1, 1.52, 1, 550).reflectance(), surface_light({}, 1, 1.52, 1, 550).reflectance(),
              1e-14);
}

TEST(SurfaceLight, OfLayersWithoutThicknessIsThatOfTheBareSurface) {
  const Coating nothing{.layers = {{.index = 2.1, .absorption = 3}, {.index = 1.38}}};
  const SurfaceLight bare = surface_light({}, 1, 1.7, 0.6, 480), coated = surface_light(nothing, 1, 1.7, 0.6, 480);
  EXPECT_EQ(bare.reflectance_s, coated.reflectance_s);
  EXPECT_EQ(bare.transmittance_p, coated.transmittance_p);
}

// Quarter waves of high and low index: R = ((n0 - Y) / (n0 + Y))^2 with Y = (nH / nL)^(2 pairs) nH^2 / ns.
TEST(SurfaceLight, OfAQuarterWaveMirrorIsTheClosedForm) {
  Coating mirror;
  for (int pair = 0; pair < 5; ++pair) {
    mirror.layers.push_back({.index = 2.35, .thickness_nm = 550 / (4 * 2.35)});
    mirror.layers.push_back({.index = 1.45, .thickness_nm = 550 / (4 * 1.45)});
  }
  mirror.layers.push_back({.index = 2.35, .thickness_nm = 550 / (4 * 2.35)});
  const double y = std::pow(2.35 / 1.45, 10) * 2.35 * 2.35 / 1.52;
  EXPECT_NEAR(surface_light(mirror, 1, 1.52, 1, 550).reflectance(), std::pow((1 - y) / (1 + y), 2), 1e-13);
}

/// Random stacks of up to eight layers.
class Stacks : public ::testing::Test {
 protected:
  Coating next(bool absorbing) {
    Coating coating;
    const int count = 1 + static_cast<int>(uniform(random_) * 8);
    for (int i = 0; i < count; ++i) {
      coating.layers.push_back({.index = 1.2 + 1.5 * uniform(random_),
                                .absorption = absorbing ? 2 * uniform(random_) * uniform(random_) : 0,
                                .thickness_nm = 300 * uniform(random_)});
    }
    return coating;
  }
  double between(double low, double high) { return low + (high - low) * uniform(random_); }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> uniform{0, 1};
};

TEST_F(Stacks, ReflectTransmitAndAbsorbAllLight) {
  for (int i = 0; i < 2000; ++i) {
    const bool absorbing = i % 2 == 1;
    const SurfaceLight light =
        surface_light(next(absorbing), between(1, 2), between(1, 2), between(0.05, 1), between(400, 700));
    EXPECT_NEAR(light.reflectance_s + light.transmittance_s + light.absorptance_s, 1, 1e-12);
    EXPECT_NEAR(light.reflectance_p + light.transmittance_p + light.absorptance_p, 1, 1e-12);
    for (const double part : {light.reflectance_s, light.transmittance_s, light.absorptance_s, light.reflectance_p,
                              light.transmittance_p, light.absorptance_p}) {
      EXPECT_GE(part, -1e-12);
    }
    EXPECT_EQ(light.absorptance() > 1e-9, absorbing);
  }
}

// The transmittance of a reversed ray is the same, also with absorption; the reflectance differs with absorption.
TEST_F(Stacks, TransmitTheSameFromBothSides) {
  for (int i = 0; i < 1000; ++i) {
    const Coating coating = next(i % 2 == 1);
    const double before = between(1, 1.3), behind = between(1.3, 2), cosine = between(0.05, 1), nm = between(400, 700);
    const SurfaceLight there = surface_light(coating, before, behind, cosine, nm);
    const SurfaceLight back =
        surface_light(reversed(coating), behind, before, snell_cosine(before, behind, cosine), nm);
    EXPECT_NEAR(there.transmittance_s, back.transmittance_s, 1e-12);
    EXPECT_NEAR(there.transmittance_p, back.transmittance_p, 1e-12);
  }
}

TEST(SurfaceLight, OfAThickMetalIsTheReflectanceOfTheMetal) {
  const std::complex<double> aluminium{0.96, 6.69};  // at 550 nm
  const double expected = std::norm((1.0 - aluminium) / (1.0 + aluminium));
  for (const double thickness : {500.0, 1e6}) {
    const Coating metal{.layers = {{.index = 0.96, .absorption = 6.69, .thickness_nm = thickness}}};
    const SurfaceLight light = surface_light(metal, 1, 1.5, 1, 550);
    EXPECT_NEAR(light.reflectance(), expected, 1e-12);
    EXPECT_NEAR(light.transmittance(), 0, 1e-12);
  }
  EXPECT_NEAR(expected, 0.92, 0.01);
}

// At the ends of the valid ranges, and for stacks whose fields exceed the range of doubles.
TEST(SurfaceLight, OfExtremeLayersIsFinite) {
  for (const double index : {1e-3, 1.0, 1e3}) {
    for (const double absorption : {0.0, 1e-9, 1e3}) {
      for (const double thickness : {1e-6, 100.0, 1e7}) {
        const Coating coating{.layers = {500, {index, absorption, thickness}}};
        for (const double cosine : {1.0, 0.3, 1e-6}) {
          const SurfaceLight light = surface_light(coating, 1, 1.5, cosine, 550);
          for (const double part : {light.reflectance(), light.transmittance()}) EXPECT_GE(part, 0) << index;
          EXPECT_NEAR(light.reflectance() + light.transmittance() + light.absorptance(), 1, 1e-6)
              << index << ' ' << absorption << ' ' << thickness << ' ' << cosine;
        }
      }
    }
  }
  Coating mirror;
  for (int i = 0; i < 5000; ++i) {
    mirror.layers.push_back({.index = 2.35, .thickness_nm = 550 / (4 * 2.35)});
    mirror.layers.push_back({.index = 1.45, .thickness_nm = 550 / (4 * 1.45)});
  }
  EXPECT_NEAR(surface_light(mirror, 1, 1.5, 1, 550).reflectance(), 1, 1e-12);
  EXPECT_EQ(surface_light(mirror, 1, 1.5, 1, 550).transmittance(), 0);
}

TEST(SurfaceLight, OfATableIsLinearAndRefusesOtherWavelengths) {
  const Coating coating{.table = {{400, 0.02}, {500, 0.004}, {700, 0.01}}};
  EXPECT_NEAR(surface_light(coating, 1, 1.5, 0.7, 600).reflectance(), 0.007, 1e-15);
  EXPECT_NEAR(surface_light(coating, 1, 1.5, 0.7, 600).transmittance(), 0.993, 1e-15);
  EXPECT_NEAR(surface_light(coating, 1, 1.5, 1, 400).reflectance(), 0.02, 1e-15);
  testing::expect_error([&] { surface_light(coating, 1, 1.5, 1, 399); }, {"wavelength", 399, 400, 700});
}

TEST(Coating, MustBeValid) {
  const auto refused = [](const Coating& coating, std::vector<testing::Token> words) {
    testing::expect_error([&] { validate(coating, "surface 3"); }, words);
  };
  refused({.layers = {{.index = 0}}}, {"surface 3", "index", 0});
  refused({.layers = {{.index = 1.4, .absorption = -1}}}, {"absorption", -1});
  refused({.layers = {{.index = 1.4, .thickness_nm = -5}}}, {"thickness_nm", -5});
  refused({.layers = {{.index = 1e-300}}}, {"index", 1e-300, 0.001});
  refused({.layers = {{.index = 1e5}}}, {"index", 1000});
  refused({.layers = {{.index = 1.4, .absorption = 1e5}}}, {"absorption", 1000});
  refused({.layers = {{.index = 1.4, .thickness_nm = 1e300}}}, {"thickness_nm", 1e300});
  refused({.layers = {{}}, .table = {{500, 0.1}}}, {"layers", "table"});
  refused({.table = {{500, 0.1}, {500, 0.2}}}, {"wavelength_nm", 500});
  refused({.table = {{500, 1.1}}}, {"reflectance", 1.1});
  testing::expect_error([] { surface_light({}, 0, 1.5, 1, 550); }, {"index_before", 0});
  testing::expect_error([] { surface_light({}, 1, 1.5, 1.1, 550); }, {"cosine", 1.1});
}

}  // namespace coating_test
}  // namespace petzval
