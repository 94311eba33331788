// SPDX-License-Identifier: Apache-2.0
#include "petzval/trace/trace.hpp"

#include <cmath>

#include "../data_lenses.hpp"
#include "petzval/io/json.hpp"
#include "program.hpp"

namespace {

class TraceRays : public Programs {
 protected:
  static constexpr const char* header = "x_mm,y_mm,z_mm,dx,dy,dz\n";

  /// Rows of the result without the header, split at commas.
  std::vector<std::vector<std::string>> traced(const std::string& lens_id, const std::string& csv,
                                               std::vector<std::string> more = {}) const {
    write("rays.csv", csv);
    std::vector<std::string> arguments{lens(lens_id), "--table", path("rays.csv"), "--out", path("traced.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("trace", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    auto rows = lines(read(path("traced.csv")));
    EXPECT_EQ(rows.at(0), "x_mm,y_mm,z_mm,dx,dy,dz,fate,surface");
    std::vector<std::vector<std::string>> result;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      std::istringstream row(rows[i]);
      result.emplace_back();
      for (std::string cell; std::getline(row, cell, ',');) result.back().push_back(cell);
      EXPECT_EQ(result.back().size(), 8u) << rows[i];
    }
    return result;
  }

  void expect_refusal(const std::string& csv, const std::vector<petzval::testing::Token>& tokens) const {
    SCOPED_TRACE(csv);
    write("rays.csv", csv);
    expect_failure(
        "trace", {lens("double_gauss_100mm_f1.35"), "--table", path("rays.csv"), "--out", path("traced.csv")}, tokens);
    EXPECT_FALSE(std::filesystem::exists(path("traced.csv")));
  }
};

TEST_F(TraceRays, NumbersEqualTheLibraryToTheBit) {
  const petzval::Lens lens_f135 = petzval::testing::data_lens("double_gauss_100mm_f1.35");
  const petzval::Ray<double> ray{{1.1, 20.3, -40}, {0.03125, -0.0625, std::sqrt(1 - 0.0048828125)}};
  std::string csv = header;
  for (const double v : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z}) {
    std::ostringstream text;
    text.precision(17);
    text << v;
    csv += (csv.back() == '\n' ? "" : ",") + text.str();
  }
  const auto rows = traced("double_gauss_100mm_f1.35", csv + '\n');
  const auto end = petzval::trace(lens_f135, ray);
  ASSERT_EQ(rows.size(), 1u);
  const double expected[] = {end.ray.origin.x,    end.ray.origin.y,    end.ray.origin.z,
                             end.ray.direction.x, end.ray.direction.y, end.ray.direction.z};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(std::stod(rows[0][i]), expected[i], 3e-14) << i;
  EXPECT_EQ(rows[0][6], "transmitted");
  EXPECT_EQ(rows[0][7], "10");
}

TEST_F(TraceRays, NormalisesDirectionsOfAnyLength) {
  const auto rows = traced("double_gauss_100mm_f1.35",
                           std::string(header) + "0,10,-50,0,0,1\n0,10,-50,0,0,1e-300\n0,10,-50,0,0,1e300\n");
  EXPECT_EQ(rows[1], rows[0]);
  EXPECT_EQ(rows[2], rows[0]);
}

TEST_F(TraceRays, NamesFatesAndSurfaces) {
  const auto rows =
      traced("double_gauss_100mm_f1.35", std::string(header) + "0,60,-50,0,0,1\n0,1000,-50,0,0,1\n0,0,-50,0,0,1\n");
  EXPECT_EQ(rows[0][6], "vignetted");
  EXPECT_EQ(rows[0][7], "0");
  EXPECT_EQ(rows[1][6], "missed_surface");
  EXPECT_EQ(rows[1][7], "0");
  EXPECT_EQ(rows[2][6], "transmitted");
}

TEST_F(TraceRays, IgnoresAperturesOnRequest) {
  const std::string csv = std::string(header) + "0,50,-50,0,0,1\n";
  EXPECT_EQ(traced("double_gauss_100mm_f2.0", csv)[0][6], "vignetted");
  EXPECT_NE(traced("double_gauss_100mm_f2.0", csv, {"--ignore-apertures"})[0][6], "vignetted");
}

TEST_F(TraceRays, ReversedRaysReturn) {
  const auto there = traced("double_gauss_100mm_f1.35", std::string(header) + "0,10,-50,0,0.02,1\n")[0];
  std::string csv = header;
  for (std::size_t i = 0; i < 6; ++i) {
    csv += (i == 0 ? "" : ",") + (i < 3 ? there[i] : there[i][0] == '-' ? there[i].substr(1) : '-' + there[i]);
  }
  const auto back = traced("double_gauss_100mm_f1.35", csv + '\n', {"--travel", "to_scene"})[0];
  EXPECT_EQ(back[6], "transmitted");
  EXPECT_EQ(back[7], "0");
  EXPECT_NEAR(std::stod(back[4]) / std::stod(back[5]), 0.02, 1e-13);
}

TEST_F(TraceRays, TracesInFloatToFloatAccuracy) {
  const std::string csv = std::string(header) + "1,10.1,-50,0,0.02,1\n";
  const auto twice = traced("double_gauss_100mm_f1.35", csv)[0];
  const auto single = traced("double_gauss_100mm_f1.35", csv, {"--precision", "float"})[0];
  EXPECT_NE(single[1], twice[1]);
  EXPECT_NEAR(std::stod(single[1]), std::stod(twice[1]), 1e-4);
  const double y = std::stod(single[1]);
  EXPECT_EQ(static_cast<double>(static_cast<float>(y)), y);
}

TEST_F(TraceRays, ReadsFilesOfSpreadsheets) {
  EXPECT_TRUE(traced("double_gauss_100mm_f1.35", header).empty());
  const auto rows = traced("double_gauss_100mm_f1.35", std::string(header) + "0,10,-50,0,0,1");
  EXPECT_EQ(traced("double_gauss_100mm_f1.35", "\xEF\xBB\xBFx_mm,y_mm,z_mm,dx,dy,dz\r\n0, 10.0 ,-50,0,0,1\r\n"), rows);
}

TEST_F(TraceRays, SkipsBlankLinesAtTheEnd) {
  const std::string ray = "0,10,-50,0,0,1\n";
  const auto rows = traced("double_gauss_100mm_f1.35", header + ray);
  ASSERT_EQ(rows.size(), 1u);
  for (const char* end : {"\n", "\r\n\r\n", "\n  \t\n\n", "   "}) {
    EXPECT_EQ(traced("double_gauss_100mm_f1.35", header + ray + end), rows) << end;
    EXPECT_TRUE(traced("double_gauss_100mm_f1.35", std::string(header) + end).empty()) << end;
  }
}

TEST_F(TraceRays, InvalidValuesAreNamedWithLineAndColumn) {
  expect_refusal("", {"rays.csv", "line 1"});
  expect_refusal("x,y,z,dx,dy,dz\n", {"line 1", "\"x,y,z,dx,dy,dz\""});
  expect_refusal(std::string(header) + "0,0,0,0,0,1\n0,0,0,0,1\n", {"line 3", 5, 6});
  expect_refusal(std::string(header) + "0,0,0,0,0,1\n\n0,0,0,0,0,1\n", {"line 3", 0, 6});
  expect_refusal(std::string(header) + "0,0,0,0,0,1\n0,1x,0,0,0,1\n", {"line 3", "y_mm", "\"1x\""});
  expect_refusal(std::string(header) + "0,0,nan,0,0,1\n", {"line 2", "z_mm", "\"nan\""});
  expect_refusal(std::string(header) + "0,0,0,0,0,inf\n", {"line 2", "dz", "\"inf\""});
  expect_refusal(std::string(header) + "0,0,0,0,0,0\n", {"line 2", "direction", "0,0,0"});
  expect_refusal(std::string(header) + "0,0,0,0,0,1e999\n", {"line 2", "dz"});
}

}  // namespace
