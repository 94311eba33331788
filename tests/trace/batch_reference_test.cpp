// SPDX-License-Identifier: Apache-2.0
// Every lens in both directions, compared with rays in long double: fates, surfaces, positions and directions.
#include <gtest/gtest.h>

#include "limits.hpp"

namespace batch_reference_test {

using namespace testing_limits;
using testing_batches::rays_for;

template <class T>
class BatchReference : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchReference, Plain);

TYPED_TEST(BatchReference, RaysAndFatesOfEveryLensEqualExactRays) {
  using T = TypeParam;
  Judge<T> judge;
  for (const auto& sample : testing_lenses::all()) {
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      judge(sample.lens, rays_for<T>(sample, travel, 400), travel, {.place = sample.size, .turn = 1}, sample.id);
    }
  }
  judge.close("all 75 lenses, both ways", 8);
  EXPECT_LE(judge.beside(), 1e-3);
  this->RecordProperty("fates_beside", std::to_string(judge.beside()));
}

}  // namespace batch_reference_test
