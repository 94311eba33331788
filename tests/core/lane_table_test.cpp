// SPDX-License-Identifier: Apache-2.0
#include "core/lane_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace lane_table_test {

using namespace petzval;
using core_detail::Lanes;

template <class R>
class LaneTable : public ::testing::Test {};
using Numbers = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LaneTable, Numbers);

template <int n, class R>
void expect_rows_of_each_lane() {
  using V = Lanes<R>;
  using Table = kernel::Table<V>;
  std::vector<R> table(1000);
  std::iota(table.begin(), table.end(), R(0));
  typename Table::Index at;
  for (int l = 0; l < V::width; ++l) at[l] = (l * 137 + 11) % 900;
  const auto rows = Table::template rows<n>(table.data(), at);
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < V::width; ++l) EXPECT_EQ(rows[static_cast<std::size_t>(k)].v[l], static_cast<R>(at[l] + k));
  }
}

TYPED_TEST(LaneTable, ReadsAdjacentNumbersForEachLane) {
  expect_rows_of_each_lane<1, TypeParam>();
  expect_rows_of_each_lane<2, TypeParam>();
  expect_rows_of_each_lane<4, TypeParam>();
  expect_rows_of_each_lane<24, TypeParam>();
}

TYPED_TEST(LaneTable, TakesTheWholePartsOfNumbers) {
  using V = Lanes<TypeParam>;
  using Table = kernel::Table<V>;
  for (const TypeParam step : {TypeParam(0.3), TypeParam(17.9), TypeParam(99999.5)}) {
    V x;
    for (int l = 0; l < V::width; ++l) x.v[l] = static_cast<TypeParam>(l) * step;
    const auto whole = Table::whole(x);
    const V back = Table::number(whole);
    for (int l = 0; l < V::width; ++l) {
      EXPECT_EQ(whole[l], static_cast<int>(x.v[l]));
      EXPECT_EQ(back.v[l], std::floor(x.v[l]));
    }
  }
}

}  // namespace lane_table_test
