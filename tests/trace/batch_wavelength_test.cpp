// SPDX-License-Identifier: Apache-2.0
// Batches with a wavelength for each ray.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "batches.hpp"
#include "petzval/media/glass.hpp"

namespace {

using namespace testing_batches;

const std::vector<double> wavelengths_nm{587.5618, 435.8343, 656.2725, 486.1327, 546.0740};

/// A lens at several wavelengths; at one if its dispersion is unknown.
testing_lenses::Sample colourful(const testing_lenses::Sample& sample) {
  static const auto glasses = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  auto result = sample;
  result.lens = petzval::compile(sample.prescription, wavelengths_nm,
                                 {.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe});
  return result;
}

template <class T>
class BatchWavelengths : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchWavelengths, Plain);

TYPED_TEST(BatchWavelengths, MixedInABatchAreWhatEachGivesAlone) {
  using T = TypeParam;
  constexpr std::uint16_t beyond[] = {5, 6, 64, 4096, 65535};
  for (const char* id : {"double_gauss_100mm_f2.0", "modern_58mm_f0.95", "fisheye_6.3mm_f2.8",
                         "catadioptric_mangin_1000mm_f7.5", "zoom_14-30mm_f4_wide"}) {
    const auto sample = colourful(testing_lenses::load(id));
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 333);
      std::vector<std::uint16_t> mixed(rays.size());
      Numbers random(3);
      for (auto& w : mixed) w = static_cast<std::uint16_t>(random() % wavelengths_nm.size());
      for (std::size_t i = 17; i < mixed.size(); i += 19) mixed[i] = beyond[i % 5];

      for (BatchOptions options : ways(travel)) {
        std::vector<Answer<T>> alone;
        for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
          options.wavelengths = {w};
          alone.push_back(traced(sample.lens, rays, options));
        }
        options.wavelengths = {.each = mixed.data()};
        const Answer<T> found = traced(sample.lens, rays, options);
        int coloured = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          if (mixed[i] < wavelengths_nm.size()) {
            ASSERT_TRUE(same_bits(found, i, alone[mixed[i]], i)) << what << " wavelength " << mixed[i];
            coloured += !same_bits(found.rays[i], alone[(mixed[i] + 1u) % wavelengths_nm.size()].rays[i]);
          } else {
            ASSERT_EQ(found.fates[i], RayFate::missed_surface) << what;
            ASSERT_EQ(found.surfaces[i],
                      travel == Travel::to_film ? 0 : static_cast<int>(sample.lens.surface_count()) - 1)
                << what;
            ASSERT_TRUE(same_bits(found.rays[i], rays[i])) << what;
          }
        }
        EXPECT_GT(coloured, 5) << sample.id << " " << text(options) << ": wavelengths make no difference";
      }
    }
  }
}

TYPED_TEST(BatchWavelengths, GivenForEachRayTakeThePlaceOfTheCommonOne) {
  using T = TypeParam;
  const auto sample = colourful(testing_lenses::load("double_gauss_100mm_f2.0"));
  const auto rays = rays_for<T>(sample, Travel::to_film, 70);
  const std::vector<std::uint16_t> second(rays.size(), 1);
  for (BatchOptions options : ways()) {
    options.wavelengths = {1};
    const auto wanted = traced(sample.lens, rays, options);
    options.wavelengths = {static_cast<std::size_t>(-1), second.data()};
    const auto found = traced(sample.lens, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same_bits(found, i, wanted, i)) << text(options);
  }
}

TYPED_TEST(BatchWavelengths, ThatWereNotCompiledLoseTheWholeBatch) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 70);
      for (BatchOptions options : ways(travel)) {
        for (const std::size_t beyond : {std::size_t{1}, std::size_t{1} << 32, static_cast<std::size_t>(-1)}) {
          options.wavelengths = {beyond};
          const auto answer = traced(sample.lens, rays, options);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(answer.fates[i], RayFate::missed_surface) << sample.id << " " << text(options);
            ASSERT_EQ(answer.surfaces[i],
                      travel == Travel::to_film ? 0 : static_cast<int>(sample.lens.surface_count()) - 1);
            ASSERT_TRUE(same_bits(answer.rays[i], rays[i]));
          }
        }
      }
    }
  }
}

}  // namespace
