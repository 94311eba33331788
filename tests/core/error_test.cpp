// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/error.hpp"

#include <gtest/gtest.h>

#include <string>

namespace petzval {
namespace error_test {

TEST(Error, HasItsMessage) { EXPECT_STREQ(Error("x.json: surface 4: é").what(), "x.json: surface 4: é"); }

TEST(Error, IsOneLineForAnyFile) { EXPECT_STREQ(Error("key \"a\nb\x1b[31m\x7f\"").what(), "key \"a b [31m \""); }

TEST(Error, KeepsBothEndsOfALongMessage) {
  const std::string what = Error("begin" + std::string(1 << 20, 'x') + "end").what();
  EXPECT_LE(what.size(), 1000u);
  EXPECT_TRUE(what.starts_with("beginxxx") && what.ends_with("xxxend") && what.find("x ... x") != std::string::npos);
}

}  // namespace error_test
}  // namespace petzval
