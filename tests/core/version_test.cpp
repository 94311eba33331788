// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/config.hpp"

#include <gtest/gtest.h>

#include <string>

namespace version_test {

TEST(Version, HeadersAndBuildAgree) {
  EXPECT_STREQ(PETZVAL_VERSION, PETZVAL_TEST_VERSION);
  EXPECT_EQ(PETZVAL_VERSION, std::to_string(PETZVAL_VERSION_MAJOR) + '.' + std::to_string(PETZVAL_VERSION_MINOR) + '.' +
                                 std::to_string(PETZVAL_VERSION_PATCH));
}

}  // namespace version_test
