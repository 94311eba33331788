// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/version.hpp"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "petzval/core/error.hpp"

namespace {

#define JOINED(a, b) a##b
#define NAMESPACE_OF(major) JOINED(v, major)

TEST(Version, HeadersAndBuildAgree) {
  EXPECT_STREQ(PETZVAL_VERSION, PETZVAL_TEST_VERSION);
  EXPECT_EQ(PETZVAL_VERSION, std::to_string(PETZVAL_VERSION_MAJOR) + '.' + std::to_string(PETZVAL_VERSION_MINOR) + '.' +
                                 std::to_string(PETZVAL_VERSION_PATCH));
}

TEST(Version, TheInlineNamespaceHasTheMajorVersion) {
  EXPECT_TRUE((std::is_same_v<petzval::Error, petzval::NAMESPACE_OF(PETZVAL_VERSION_MAJOR)::Error>));
}

}  // namespace
