// SPDX-License-Identifier: Apache-2.0
// Batches with a wavelength for each ray, compiled or in nm.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "batches.hpp"
#include "petzval/glass/glass.hpp"

namespace batch_wavelength_test {

using namespace testing_batches;
using petzval::RayWavelengths;
using petzval::Wavelength;

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

TYPED_TEST(BatchWavelengths, MixedBatchEqualsBatchesOfOneWavelength) {
  using T = TypeParam;
  constexpr std::uint16_t beyond[] = {5, 6, 64, 4096, 65535};
  for (const char* id : {"double_gauss_100mm_f2.0", "modern_58mm_f0.95", "fisheye_6.3mm_f2.8",
                         "catadioptric_mangin_1000mm_f7.5", "zoom_14-30mm_f4:wide"}) {
    const auto sample = colourful(testing_lenses::load(id));
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 333);
      std::vector<std::uint16_t> mixed(rays.size());
      Numbers random(3);
      for (auto& w : mixed) w = static_cast<std::uint16_t>(random() % wavelengths_nm.size());
      for (std::size_t i = 17; i < mixed.size(); i += 19) mixed[i] = beyond[i % 5];

      for (BatchOptions options : every_batch(travel)) {
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

// Constants of 4 to 32 wavelengths are permuted in one or two registers, larger tables are gathered.
TYPED_TEST(BatchWavelengths, MixedBatchEqualsBatchesForAnyNumberOfWavelengths) {
  using T = TypeParam;
  static const auto glasses = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  auto sample = testing_lenses::load("double_gauss_100mm_f2.0");
  for (const std::size_t count : {1, 4, 8, 9, 16, 17, 32, 33}) {
    std::vector<double> nm;
    for (std::size_t w = 0; w < count; ++w) nm.push_back(400 + 9 * static_cast<double>(w));
    sample.lens =
        petzval::compile(sample.prescription, nm, {.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe});
    const auto rays = rays_for<T>(sample, Travel::to_scene, 3 * count);
    std::vector<std::uint16_t> mixed(rays.size());
    for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = static_cast<std::uint16_t>(i % count);
    for (BatchOptions options : every_batch(Travel::to_scene)) {
      options.wavelengths = {.each = mixed.data()};
      const Answer<T> found = traced(sample.lens, rays, options);
      for (std::size_t w = 0; w < count; ++w) {
        options.wavelengths = {w};
        const Answer<T> alone = traced(sample.lens, rays, options);
        for (std::size_t i = w; i < rays.size(); i += count) {
          ASSERT_TRUE(same_bits(found, i, alone, i)) << text(options) << " ray " << i << ", " << w << " of " << count;
        }
      }
    }
  }
}

TYPED_TEST(BatchWavelengths, WavelengthsPerRayReplaceTheCommonWavelength) {
  using T = TypeParam;
  const auto sample = colourful(testing_lenses::load("double_gauss_100mm_f2.0"));
  const auto rays = rays_for<T>(sample, Travel::to_film, 70);
  const std::vector<std::uint16_t> second(rays.size(), 1);
  for (BatchOptions options : every_batch()) {
    options.wavelengths = {1};
    const auto wanted = traced(sample.lens, rays, options);
    options.wavelengths = {static_cast<std::size_t>(-1), second.data()};
    const auto found = traced(sample.lens, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same_bits(found, i, wanted, i)) << text(options);
  }
}

TYPED_TEST(BatchWavelengths, MissingIndicesLoseTheWholeBatch) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 70);
      for (BatchOptions options : every_batch(travel)) {
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

/// Wavelengths in nm: compiled, between compiled ones, and 1 in 19 outside the range of the lens.
std::vector<float> any_nm(std::size_t count) {
  constexpr float bad[] = {std::numeric_limits<float>::quiet_NaN(), 435, 657, 0,
                           std::numeric_limits<float>::infinity()};
  std::vector<float> result(count);
  Numbers random(5);
  for (auto& nm : result) nm = static_cast<float>(random(435.84, 656.27));
  for (std::size_t i = 3; i < count; i += 23) result[i] = static_cast<float>(wavelengths_nm[i % 5]);
  for (std::size_t i = 17; i < count; i += 19) result[i] = bad[i % 5];
  return result;
}

bool covered(float nm) { return nm >= 435.8342f && nm <= 656.2726f; }

/// Difference of two rays; positions are relative to the size of the lens.
template <class T>
double apart(const Ray<T>& a, const Ray<T>& b, double size) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    sum += std::abs(double{a.origin[k]} - double{b.origin[k]}) / size;
    sum += std::abs(double{a.direction[k]} - double{b.direction[k]});
  }
  return sum;
}

TYPED_TEST(BatchWavelengths, InNmEqualALensCompiledForThem) {
  using T = TypeParam;
  for (const char* id : {"double_gauss_100mm_f2.0", "modern_58mm_f0.95", "fisheye_6.3mm_f2.8",
                         "catadioptric_mangin_1000mm_f7.5", "zoom_14-30mm_f4:wide", "anamorphic_60mm_2x"}) {
    const auto sample = colourful(testing_lenses::load(id));
    static const auto glasses = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 250);
      const auto nm = any_nm(rays.size());
      for (BatchOptions options : every_batch(travel)) {
        options.wavelengths = {.each_nm = nm.data()};
        const Answer<T> found = traced(sample.lens, rays, options);
        std::size_t passed = 0, lost = 0;
        double worst = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          if (!covered(nm[i])) {
            ASSERT_EQ(found.fates[i], RayFate::missed_surface) << what;
            ASSERT_TRUE(same_bits(found.rays[i], rays[i])) << what;
            continue;
          }
          const Lens own = petzval::compile(sample.prescription, std::vector{double{nm[i]}},
                                            {.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe});
          const auto wanted = petzval::trace(own, rays[i], {.travel = travel});
          lost += found.fates[i] != wanted.fate;
          if (found.fates[i] != RayFate::transmitted || !wanted.transmitted()) continue;
          worst = std::max(worst, apart(found.rays[i], wanted.ray, sample.size));
          ++passed;
        }
        // Indices are accurate to 2e-8; a lens amplifies this error like the rounding of floats.
        EXPECT_LT(worst, sizeof(T) == 4 ? 2e-4 : 1e-6) << sample.id << " " << text(options);
        EXPECT_GT(passed, 8u) << sample.id << " " << text(options);
        EXPECT_LE(lost, sizeof(T) == 4 ? 2u : 0u) << sample.id << " " << text(options);
      }
    }
  }
}

TYPED_TEST(BatchWavelengths, InNmHaveEqualBitsInBatchesAndSingleRays) {
  using T = TypeParam;
  for (const char* id : {"double_gauss_100mm_f2.0", "modern_58mm_f0.95", "catadioptric_mangin_1000mm_f7.5"}) {
    const auto sample = colourful(testing_lenses::load(id));
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 333);
      const auto nm = any_nm(rays.size());
      for (BatchOptions options : every_batch(travel)) {
        options.wavelengths = {.each_nm = nm.data()};
        const Answer<T> found = traced(sample.lens, rays, options);
        std::vector<petzval::TracedRay<T>> records(rays.size());
        petzval::trace<T>(sample.lens, rays, records.data(), options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          BatchOptions own = options;
          own.wavelengths = {Wavelength::nm(double{nm[i]})};
          const Answer<T> alone = traced<T>(sample.lens, {rays[i]}, own);
          ASSERT_TRUE(same_bits(found, i, alone, 0)) << what;
          ASSERT_EQ(records[i].fate, found.fates[i]) << what;
          ASSERT_TRUE(same_bits(records[i].ray, found.rays[i])) << what;
          if (options.arithmetic == Arithmetic::fast) continue;
          const auto one = petzval::trace(sample.lens, rays[i], {travel, Wavelength::nm(double{nm[i]})});
          ASSERT_EQ(one.fate, found.fates[i]) << what;
          ASSERT_EQ(one.surface, found.surfaces[i]) << what;
          if (one.transmitted()) {
            ASSERT_TRUE(same_bits(one.ray, found.rays[i])) << what;
          }
        }
      }
    }
  }
}

TYPED_TEST(BatchWavelengths, InNmHaveDerivatives) {
  using T = TypeParam;
  const auto sample = colourful(testing_lenses::load("modern_58mm_f0.95"));
  const auto rays = rays_for<T>(sample, Travel::to_film, 70);
  std::vector<float> nm(rays.size(), 546.074f);
  const Arrays<T> in(rays);
  std::vector<Ray<T>> moved(rays.size(), Ray<T>{{1, 0, 0}, {0, 0, 0}});
  const Arrays<T> by(moved);
  const auto differentials = [&](const RayWavelengths& wavelengths, BatchOptions options) {
    options.wavelengths = wavelengths;
    std::array<Arrays<T>, 3> out{Arrays<T>(rays.size()), Arrays<T>(rays.size()), Arrays<T>(rays.size())};
    std::vector<RayFate> fates(rays.size());
    std::vector<int> surfaces(rays.size());
    petzval::trace_differentials<T>(sample.lens, rays.size(), in.in(), {by.in(), by.in()}, out[0].out(),
                                    {out[1].out(), out[2].out()}, fates.data(), surfaces.data(), options);
    return std::pair(std::move(out), std::move(fates));
  };
  for (const BatchOptions& options : every_batch()) {
    const auto [wanted, wanted_fates] = differentials({Wavelength(4)}, options);
    const auto [found, fates] = differentials({.each_nm = nm.data()}, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(fates[i], wanted_fates[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(apart(found[k][i], wanted[k][i], k == 0 ? sample.size : 1), sizeof(T) == 4 ? 2e-3 : 1e-6)
            << text(options) << " ray " << i << " " << k;
      }
    }
  }
}

}  // namespace batch_wavelength_test
