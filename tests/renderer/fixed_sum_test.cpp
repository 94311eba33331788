// SPDX-License-Identifier: Apache-2.0
#include "renderer/fixed_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using renderer::FixedSum;
__extension__ using Int128 = __int128;

/// Numbers of both signs and of any magnitude of radiance.
std::vector<float> numbers(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> power(-18, 11), sign(-1, 1);
  std::vector<float> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(std::copysign(std::pow(10.0f, power(random)), sign(random)));
  return result;
}

/// The value in multiples of 2^-64, rounded towards zero.
Int128 fixed(float x) {
  int exponent = 0;
  const float mantissa = std::frexp(std::abs(x), &exponent);
  auto value = static_cast<Int128>(mantissa * 0x1p24f);
  const int shift = exponent - 24 + 64;
  value = shift >= 0 ? value << shift : shift > -100 ? value >> -shift : 0;
  return x < 0 ? -value : value;
}

TEST(FixedSum, EqualsTheSumOfIntegers) {
  FixedSum sum;
  Int128 whole = 0;
  for (const float x : numbers(100'000)) {
    sum += FixedSum(static_cast<double>(x));
    whole += fixed(x);
    ASSERT_NEAR(sum.value(), static_cast<double>(static_cast<long double>(whole) * 0x1p-64L),
                std::abs(sum.value()) * 0x1p-52)
        << x;
  }
}

TEST(FixedSum, BitsAreIndependentOfOrderAndPartition) {
  std::vector<float> values = numbers(10'000);
  const auto add = [](auto from, auto to) {
    FixedSum sum;
    for (; from != to; ++from) sum += FixedSum(static_cast<double>(*from));
    return sum;
  };
  const FixedSum all = add(values.begin(), values.end());
  std::mt19937 random(6);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(values.begin(), values.end(), random);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(random() % values.size());
    FixedSum sum = add(values.begin(), middle);
    sum += add(middle, values.end());
    EXPECT_EQ(sum, all);
  }
}

TEST(FixedSum, SingleValuesAreExact) {
  for (const float x : numbers(10'000)) {
    const auto wanted = static_cast<double>(static_cast<long double>(fixed(x)) * 0x1p-64L);
    EXPECT_EQ(FixedSum(static_cast<double>(x)).value(), wanted) << x;
    FixedSum none(static_cast<double>(x));
    none -= FixedSum(static_cast<double>(x));
    EXPECT_EQ(none, FixedSum());
    none += FixedSum(static_cast<double>(-x));
    none += FixedSum(static_cast<double>(x));
    EXPECT_EQ(none, FixedSum()) << x;
  }
  EXPECT_EQ(FixedSum(0x1p-64).value(), 0x1p-64);
  EXPECT_EQ(FixedSum(-0x1p-64).value(), -0x1p-64);
  EXPECT_EQ(FixedSum(0x1p-65), FixedSum());
  EXPECT_EQ(FixedSum(-0x1p-65), FixedSum()) << "as close to zero as the positive one";
  EXPECT_EQ(FixedSum(-1.5).value(), -1.5);
  EXPECT_EQ(FixedSum(-0.0), FixedSum());
}

}  // namespace
