// SPDX-License-Identifier: Apache-2.0
// Agreement with numbers that other programs and books have published.
#include <gtest/gtest.h>

#include <fstream>
#include <ostream>
#include <sstream>
#include <string>

#include "comparisons.hpp"

namespace petzval::testing {

void PrintTo(const NamedTable& table, std::ostream* out) { *out << table.name; }

namespace {

class Published : public ::testing::TestWithParam<NamedTable> {};

TEST_P(Published, NumbersAgree) {
  const ComparisonTable table = GetParam().compute();
  ASSERT_FALSE(table.rows.empty());
  for (const Comparison& row : table.rows) {
    EXPECT_LE(largest_units(row), row.tolerance) << row.quantity << "\npublished " << row.published << "\npetzval   "
                                                 << rounded(row) << "\nsource: " << table.source;
    EXPECT_EQ(row.tolerance > 1, !row.reason.empty()) << row.quantity << ": a tolerance above one unit needs a reason";
  }
}

TEST_P(Published, PageShowsTheTable) {
  const std::string path = PETZVAL_TEST_DATA "/../lib/docs/other_programs.md";
  std::ifstream file(path);
  ASSERT_TRUE(file) << path;
  std::ostringstream page;
  page << file.rdbuf();
  const std::string table = markdown(GetParam().compute());
  EXPECT_NE(page.str().find(table), std::string::npos) << path << ": must contain this output of published_table:\n"
                                                       << table;
}

INSTANTIATE_TEST_SUITE_P(Tables, Published, ::testing::ValuesIn(comparison_tables().begin(), comparison_tables().end()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace petzval::testing
