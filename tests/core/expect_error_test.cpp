// SPDX-License-Identifier: Apache-2.0
#include "../expect_error.hpp"

#include <gtest/gtest-spi.h>

#include <stdexcept>

namespace petzval::testing {
namespace expect_error_test {

TEST(ExpectError, Tokens_AreWholeWords) {
  for (const char* token : {"film z", "film_z", "film", "-1.5", "4", "lens.txt:4", "mm"}) {
    EXPECT_TRUE(has_token("lens.txt:4: film_z = -1.5 mm", token)) << token;
  }
  for (const char* token : {"ilm z", "1.5", "-1", "5", "1", "lens.txt:3", "m", "film x", ""}) {
    EXPECT_FALSE(has_token("lens.txt:4: film_z = -1.5 mm", token)) << token;
  }
  EXPECT_TRUE(has_token("threads = 1e-06.", Token(1e-6).text()));
  EXPECT_FALSE(has_token("threads = 1e-06.", Token(1).text()));
  EXPECT_FALSE(has_token("threads = 15", Token(1.5).text()));
  EXPECT_TRUE(has_token("0 to 5", Token(5u).text()));
}

TEST(ExpectError, WrongTokenTypeOrNoException_Fails) {
  const auto work = [] { throw Error("threads = 0; must be 1 or more"); };
  expect_error(work, {"threads", 0});
  EXPECT_NONFATAL_FAILURE(expect_error(work, {"thread", 0}), "no \"thread\" in: threads = 0");
  EXPECT_NONFATAL_FAILURE(expect_error(work, {"threads", 2}), "no \"2\" in");
  EXPECT_NONFATAL_FAILURE(expect_error([] {}, {}), "no exception");
  EXPECT_NONFATAL_FAILURE(expect_error([] { throw std::invalid_argument("threads"); }, {"threads"}),
                          "no petzval::Error");
}

TEST(ExpectError, Failure_NamesTheLineOfTheCaller) {
  ::testing::TestPartResultArray failures;
  const int line = __LINE__ + 3;
  {
    const ::testing::ScopedFakeTestPartResultReporter reporter(&failures);
    expect_error([] {}, {});
  }
  ASSERT_EQ(failures.size(), 1);
  EXPECT_EQ(failures.GetTestPartResult(0).line_number(), line);
  EXPECT_NE(std::string(failures.GetTestPartResult(0).file_name()).find("expect_error_test.cpp"), std::string::npos);
}

}  // namespace expect_error_test
}  // namespace petzval::testing
