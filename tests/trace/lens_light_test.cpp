// SPDX-License-Identifier: Apache-2.0
// The light that exact rays keep, in batches and one by one, against transmittance() of a ray.
#include "trace/lens_light.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/core/sobol.hpp"

namespace petzval {
namespace lens_light_test {

using trace_detail::LensLight;
using trace_detail::trace_light;

const std::vector<double> visible{420, 486.1327, 546.074, 587.5618, 656.2725};

const Coating stack{.layers = {{.index = 1.38, .thickness_nm = 99},
                               {.index = 2.05, .absorption = 0.001, .thickness_nm = 130},
                               {.index = 1.63, .thickness_nm = 85}}};

/// Rays in arrays.
template <class T>
struct Rays {
  std::array<std::vector<T>, 6> v;
  std::vector<RayFate> fates;
  std::vector<T> light;

  explicit Rays(const std::vector<Ray<double>>& rays) : fates(rays.size()), light(rays.size()) {
    for (const auto& [o, d] : rays) {
      const std::array own{o.x, o.y, o.z, d.x, d.y, d.z};
      for (std::size_t k = 0; k < 6; ++k) v[k].push_back(static_cast<T>(own[k]));
    }
  }
  RayArrays<T> arrays() { return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(), v[5].data()}; }
  RayArrays<const T> given() const {
    return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(), v[5].data()};
  }
};

/// Rays that pass a lens to the film.
std::vector<Ray<double>> passing(const Lens& lens) {
  std::vector<Ray<double>> rays;
  const double rim = std::min(lens.surfaces()[0].semi_diameter, 1e3);
  for (std::uint32_t k = 0; k < 1500; ++k) {
    const auto uv1 = owen_sobol(k, 1);
    const double a = uv1.x, b = uv1.y;
    const auto uv2 = owen_sobol(k, 2);
    const double c = uv2.x, d = uv2.y;
    const double tilt = 0.3 * (d - 0.5);
    const Ray<double> ray{{rim * (2 * a - 1), rim * (2 * b - 1), -1},
                          {0.2 * (c - 0.5), tilt, std::sqrt(1 - tilt * tilt - 0.04 * (c - 0.5) * (c - 0.5))}};
    if (trace(lens, ray).transmitted()) rays.push_back(ray);
  }
  return rays;
}

class LensLightOf : public ::testing::TestWithParam<std::string> {};

TEST_P(LensLightOf, EqualsTheTransmittanceOfEachRay) {
  const Lens bare = compile(testing::data_prescription(GetParam()), visible, {.missing_glass = MissingGlass::abbe});
  for (const Coating& coating : {Coating{}, Coating::quarter_wave(), stack}) {
    const Lens lens = with_coating(bare, coating);
    const LensLight light(lens);
    const auto rays = passing(lens);
    ASSERT_GT(rays.size(), 20u);
    EXPECT_LT(light.error(), coating == stack ? 5e-3 : 2e-3);
    std::vector<std::uint16_t> each;
    std::vector<float> nm;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      each.push_back(static_cast<std::uint16_t>(i % visible.size()));
      nm.push_back(static_cast<float>(visible[i % visible.size()]));
    }
    Rays<float> in_float(rays);
    Rays<double> own(rays), same(rays), between(rays), back(rays);
    trace_light<double>(lens, light, rays.size(), own.given(), own.arrays(), own.fates.data(), own.light.data(), {});
    trace_light<float>(lens, light, rays.size(), in_float.given(), in_float.arrays(), in_float.fates.data(),
                       in_float.light.data(), {});
    const RayWavelengths by_index{.each = each.data()}, by_nm{.each_nm = nm.data()};
    trace_light<double>(lens, light, rays.size(), same.given(), same.arrays(), same.fates.data(), same.light.data(),
                        {.wavelengths = by_index});
    trace_light<double>(lens, light, rays.size(), between.given(), between.arrays(), between.fates.data(),
                        between.light.data(), {.wavelengths = by_nm});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double exact = transmittance(lens, rays[i]).value();
      EXPECT_NEAR(own.light[i], exact, light.error() + 1e-9) << i;
      EXPECT_NEAR(in_float.light[i], exact, light.error() + 2e-5) << i;
      const std::size_t w = each[i];
      const double exact_at = transmittance(lens, rays[i], w).value();
      EXPECT_NEAR(same.light[i], exact_at, light.error() + 1e-9) << i;
      EXPECT_NEAR(between.light[i], exact_at, light.error() + 1e-6) << i;
      double one = 0;
      trace_light<double>(lens, light, rays[i], one, {.wavelength = w});
      EXPECT_NEAR(one, same.light[i], 1e-8) << i;
      trace_light<double>(lens, light, rays[i], one, {.wavelength = Wavelength::nm(visible[w])});
      EXPECT_NEAR(one, between.light[i], 1e-6) << i;
      // The reversed ray.
      const Ray<double> end{{own.v[0][i], own.v[1][i], own.v[2][i]}, {-own.v[3][i], -own.v[4][i], -own.v[5][i]}};
      trace_light<double>(lens, light, end, one, {.travel = Travel::to_scene});
      EXPECT_NEAR(one, own.light[i], 1e-9) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, LensLightOf,
                         ::testing::Values("double_gauss_100mm_f1.35", "fisheye_16mm_f2.8", "phone_5.6mm_f3.5",
                                           "anamorphic_60mm_2x", "catadioptric_mangin_1000mm_f7.5", "ball_10mm"),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& c : name) c = c == '.' ? '_' : c;
                           return name;
                         });

TEST(LensLight, OfALostRayIsNone) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.35");
  double left = 1;
  EXPECT_FALSE(trace_light<double>(lens, LensLight(lens), {{0, 500, -1}, {0, 0, 1}}, left, {}).transmitted());
  EXPECT_EQ(left, 0);
}

// A window of the glass of twice the thickness keeps the square.
TEST(LensLight, IncludesAbsorption) {
  const Glass grey{.catalogue = "test",
                   .name = "GREY",
                   .nd = 1.5,
                   .vd = 60,
                   .formula = DispersionFormula::cauchy,
                   .shortest_nm = 300,
                   .longest_nm = 1000,
                   .coefficients = {0.5},
                   .absorption = {{300, 0.02}, {1000, 0.01}}};
  const GlassCatalogue glasses({grey});
  const auto window = [&](double thickness) {
    Prescription p;
    p.name = "window";
    p.surfaces = {{.thickness = thickness, .medium = {.glass = "GREY"}, .semi_diameter = 90},
                  {.thickness = 50, .semi_diameter = 90}};
    return compile(p, visible, {.glasses = &glasses});
  };
  for (const double slope : {0.0, 0.5}) {
    const Ray<double> ray{{0, 0, -1}, {0, slope, std::sqrt(1 - slope * slope)}};
    const auto left = [&](double thickness, Wavelength wavelength) {
      const Lens lens = window(thickness);
      double one = 0;
      trace_light<double>(lens, LensLight(lens), ray, one, {.wavelength = wavelength});
      return one;
    };
    const double surfaces = left(0, {});
    const double per_mm = 0.02 - 0.01 * (587.5618 - 300) / 700, path = 20 / std::sqrt(1 - slope * slope / 2.25);
    EXPECT_NEAR(left(20, {}), surfaces * std::exp(-per_mm * path), 1e-9);
    EXPECT_NEAR(left(40, {}) * surfaces, left(20, {}) * left(20, {}), 1e-9);
    EXPECT_NEAR(left(20, Wavelength::nm(500)),
                left(0, Wavelength::nm(500)) * std::exp(-(0.02 - 0.01 * 200 / 700) * path), 1e-5);
  }
}

TEST(LensLight, RefusesWavelengthsOutsideATable) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  p.surfaces[2].coating = Coating{.table = {{500, 0.1}, {600, 0.1}}};
  testing::expect_error([&] { LensLight(compile(p, visible)); }, {"surface 2", "wavelength", 420, 500, 600});
}

}  // namespace lens_light_test
}  // namespace petzval
