// SPDX-License-Identifier: Apache-2.0
#include "core/text.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <string_view>

namespace text_test {

using petzval::to_text;

TEST(Number, ReadsBackToTheSameDouble) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    const std::string text = to_text(value);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    EXPECT_EQ(back, value) << text;
  }
}

TEST(Number, IsShortest) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(50), "50");
  EXPECT_EQ(to_text(-0.0), "-0");
  EXPECT_EQ(to_text(1e30), "1e+30");
  EXPECT_EQ(to_text(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(to_text(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(Number, RoundsToSignificantDigits) {
  EXPECT_EQ(to_text(3.14159265, 3), "3.14");
  EXPECT_EQ(to_text(2.0 / 3.0, 4), "0.6667");
  EXPECT_EQ(to_text(123456, 2), "1.2e+05");
}

TEST(Number, IndependentOfTheLocale) {
  const char* before = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // if the locale is installed
  EXPECT_EQ(to_text(0.5), "0.5");
  if (before != nullptr) std::setlocale(LC_NUMERIC, "C");
}

TEST(Utf8, OnlyCompleteCharactersHaveALength) {
  using petzval::utf8_length;
  for (const std::string_view whole : {"a", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEF\xBF\xBF",
                                       "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(utf8_length(std::string(whole) + "a", 0), whole.size());
    for (std::size_t cut = 1; cut < whole.size(); ++cut) {
      EXPECT_EQ(utf8_length(whole.substr(0, cut), 0), 0u);
      EXPECT_EQ(utf8_length(std::string(whole.substr(0, cut)) + "aaa", 0), 0u);
      EXPECT_EQ(utf8_length(whole, cut), 0u);
    }
  }
  // Overlong encodings, surrogates, code points above U+10FFFF, and invalid first bytes.
  for (const char* none : {"\xC0\x80", "\xC1\xBF", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF",
                           "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\x80", "\xFF", ""}) {
    EXPECT_EQ(utf8_length(none, 0), 0u);
  }
}

}  // namespace text_test
