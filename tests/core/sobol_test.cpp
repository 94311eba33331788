// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/sobol.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace petzval {
namespace sobol_test {

TEST(OwenSobol, AlignedBlocksAreNets) {
  // Each box of 2^-i by 2^(i - k) contains exactly one point of 2^k points that start at a multiple of 2^k.
  for (const std::uint32_t seed : {0u, 1u, 77u, 0xffffffffu}) {
    for (int k = 0; k <= 12; ++k) {
      const std::uint32_t count = 1u << k;
      for (const std::uint32_t first : {0u, 5 * count, (0xffffffffu / count) * count}) {
        for (int i = 0; i <= k; ++i) {
          std::vector<bool> taken(count, false);
          for (std::uint32_t n = 0; n < count; ++n) {
            const auto uv = owen_sobol(first + n, seed);
            const double x = uv.x, y = uv.y;
            const auto column = static_cast<std::uint32_t>(std::ldexp(x, i));
            const auto row = static_cast<std::uint32_t>(std::ldexp(y, k - i));
            const std::uint32_t box = (column << (k - i)) | row;
            ASSERT_FALSE(taken[box]) << "seed " << seed << ", 2^" << k << " points from " << first << ", i = " << i;
            taken[box] = true;
          }
        }
      }
    }
  }
}

TEST(OwenSobol, LiesInTheUnitSquare) {
  for (const std::uint32_t seed : {0u, 3u, 0x80000000u}) {
    for (std::uint32_t n = 0; n < 100000; ++n) {
      const auto uv = owen_sobol(n * 42949u, seed);
      const double x = uv.x, y = uv.y;
      ASSERT_TRUE(x >= 0 && x < 1 && y >= 0 && y < 1) << seed << " " << n;
    }
  }
}

TEST(OwenSobol, BlocksEqualSinglePoints) {
  for (const std::uint32_t first : {0u, 5u, 4096u, 0xfffffff0u}) {
    for (const std::size_t count : {0u, 1u, 3u, 64u, 101u}) {
      std::vector<double> u(count, -1), v(count, -1);
      owen_sobol(first, 7, u, v);
      for (std::uint32_t i = 0; i < count; ++i) {
        EXPECT_EQ(Vec2<double>(u[i], v[i]), owen_sobol(first + i, 7)) << first << " + " << i;
      }
    }
  }
}

TEST(OwenSobol, PointsAreFixed) {
  // Points of the first version: seeds must keep their images.
  EXPECT_EQ(owen_sobol(0, 0), Vec2<double>(0x1.cc53569ep-1, 0x1.603b991p-4));
  EXPECT_EQ(owen_sobol(123456789, 42), Vec2<double>(0x1.27296c98p-2, 0x1.34a4f066p-1));
  EXPECT_EQ(owen_sobol(0xffffffff, 0xffffffff), Vec2<double>(0x1.bab421ep-5, 0x1.cb7b1ecp-4));
}

TEST(OwenSobol, IsAFunctionOfIndexAndSeed) {
  std::set<double> xs;
  for (std::uint32_t seed = 0; seed < 1000; ++seed) {
    EXPECT_EQ(owen_sobol(12345, seed), owen_sobol(12345, seed));
    xs.insert(owen_sobol(12345, seed).x);
  }
  EXPECT_EQ(xs.size(), 1000u);
}

TEST(OwenSobol, EverySampleIsUniformOverTheSeeds) {
  // Each scrambled point is uniform in the square. Sums of 4096 uniform numbers: 5 standard deviations are
  // 0.0226; of the products of centred coordinates, independent, 0.0065.
  constexpr int seeds = 4096;
  for (const std::uint32_t index : {0u, 1u, 2u, 3u, 1000u, 65535u, 0xffffffffu}) {
    double mean_x = 0, mean_y = 0, product = 0, between_neighbours = 0;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      const auto uv = owen_sobol(index, seed);
      const double x = uv.x, y = uv.y;
      mean_x += x / seeds;
      mean_y += y / seeds;
      product += (x - 0.5) * (y - 0.5) / seeds;
      between_neighbours += (x - 0.5) * (owen_sobol(index, seed + 1).x - 0.5) / seeds;
    }
    EXPECT_NEAR(mean_x, 0.5, 0.0226) << index;
    EXPECT_NEAR(mean_y, 0.5, 0.0226) << index;
    EXPECT_NEAR(product, 0, 0.0065) << index;
    EXPECT_NEAR(between_neighbours, 0, 0.0065) << index;
  }
}

TEST(OwenSobol, IntegratesSmoothFunctionsFasterThanAnUnscrambledGrid) {
  // The error over scramblings falls as N^-3/2 for a smooth integrand (Owen 1997), for plain Sobol points as N^-1 log
  // N.
  const auto error = [](std::uint32_t count) {
    double squares = 0;
    for (std::uint32_t seed = 0; seed < 64; ++seed) {
      double sum = 0;
      for (std::uint32_t n = 0; n < count; ++n) {
        const auto uv = owen_sobol(n, seed);
        const double x = uv.x, y = uv.y;
        sum += std::exp(x) * std::cos(y);
      }
      const double exact = (std::exp(1.0) - 1) * std::sin(1.0);
      squares += std::pow(sum / count - exact, 2);
    }
    return std::sqrt(squares / 64);
  };
  const double slope = std::log2(error(4096) / error(64)) / 6;
  EXPECT_LT(slope, -1.35);
}

}  // namespace sobol_test
}  // namespace petzval
