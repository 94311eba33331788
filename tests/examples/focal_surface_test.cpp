// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

class FocalSurfaceProgram : public Programs {
 protected:
  static constexpr const char* points = R"({"points": [
    {"pixel": [60.5, 100.5], "distance_mm": 900, "extent_stops": 2},
    {"pixel": [220.5, 75.5], "distance_mm": 1150},
    {"pixel": [150.5, 50.5], "distance_mm": null, "extent_stops": -1},
    {"pixel": [150.5, 175.5], "distance_mm": 950, "blur_px": 12}]})";

  std::vector<std::string> arguments(const std::vector<std::string>& more, int width = 300) const {
    std::vector<std::string> all{lens("double_gauss_100mm_f2_28deg"),
                                 "--points",
                                 path("points.json"),
                                 "--size",
                                 std::to_string(width) + 'x' + std::to_string(width * 2 / 3),
                                 "--film",
                                 "36x24",
                                 "--out",
                                 path("out")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Rows of numbers below a header.
  static std::vector<std::vector<double>> rows(const std::string& csv) {
    std::vector<std::vector<double>> result;
    for (const std::string& line : lines(csv)) {
      std::vector<double> row;
      for (std::size_t at = 0; at < line.size();) {
        const std::size_t end = std::min(line.find(',', at), line.size());
        row.push_back(std::strtod(line.substr(at, end - at).c_str(), nullptr));
        at = end + 1;
      }
      result.push_back(row);
    }
    result.erase(result.begin());
    return result;
  }
  /// The values of a grey PFM, rows from the top.
  std::vector<float> pfm(const std::string& name, int width, int height) const {
    const std::string bytes = read(path(name)),
                      head = "Pf\n" + std::to_string(width) + ' ' + std::to_string(height) + "\n-1.0\n";
    EXPECT_TRUE(bytes.starts_with(head)) << bytes.substr(0, 30);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    EXPECT_EQ(bytes.size(), head.size() + 4 * pixels);
    std::vector<float> bottom_up(pixels), result;
    std::memcpy(bottom_up.data(), bytes.data() + head.size(), 4 * pixels);
    for (int y = height; y-- > 0;) {
      const auto row = bottom_up.begin() + static_cast<std::ptrdiff_t>(y) * width;
      result.insert(result.end(), row, row + width);
    }
    return result;
  }
};

TEST_F(FocalSurfaceProgram, QueriesEqualTheValuesOfThePoints) {
  write("points.json", points);
  write("q.csv", "x_px,y_px\n60.5,100.5\n220.5,75.5\n150.5,50.5\n150.5,175.5\n10,190\n");
  const auto outcome = run("surface", arguments({"--table", path("q.csv")}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(lines(outcome.out), (std::vector{path("out/surface.svg"), path("out/side.svg"), path("out/surface.pfm"),
                                             path("out/answers.csv")}));
  EXPECT_TRUE(read(path("out/surface.svg")).starts_with("<svg"));
  EXPECT_NE(read(path("out/side.svg")).find("</svg>"), std::string::npos);
  const std::string csv = read(path("out/answers.csv"));
  EXPECT_EQ(lines(csv)[0], "x_px,y_px,distance_mm,extent_stops,blur_px");
  const auto answers = rows(csv);
  ASSERT_EQ(answers.size(), 5u);
  EXPECT_NEAR(answers[0][2], 900, 1e-9);
  EXPECT_NEAR(answers[0][3], 2, 1e-12);
  EXPECT_NEAR(answers[0][4], 0, 1e-9);
  EXPECT_NEAR(answers[1][2], 1150, 1e-9);
  EXPECT_EQ(answers[2][2], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(answers[2][3], -1, 1e-12);
  EXPECT_LT(answers[3][2], 950);  // points beyond the plane of focus have a positive blur
  EXPECT_NEAR(answers[3][4], 12, 1e-9);
  // The image equals the answers of the queries.
  const auto picture = pfm("out/surface.pfm", 300, 200);
  for (const float value : picture) EXPECT_TRUE(std::isfinite(value));
  for (std::size_t i = 0; i < 4; ++i) {
    const auto column = static_cast<std::size_t>(answers[i][0]), row = static_cast<std::size_t>(answers[i][1]);
    EXPECT_NEAR(picture[row * 300 + column], 1 / answers[i][2], 1e-9);
  }
}

TEST_F(FocalSurfaceProgram, OneFileOfPointsServesAllCommands) {
  write("points.json", R"([{"id": "eye", "position_mm": [100, 50, -1500], "weight": 2},
    {"world_mm": [0, 0, -2], "at_infinity": true, "blur_mm": 0}])");
  write("q.csv", "x_px,y_px\n150,100\n");
  ASSERT_EQ(run("surface", arguments({"--table", path("q.csv")})).status, 0);
  EXPECT_GT(rows(read(path("out/answers.csv")))[0][2], 1e9);
#ifdef PETZVAL_TEST_HAS_tilt
  EXPECT_EQ(
      run("tilt", {lens("double_gauss_100mm_f2_28deg"), "--points", path("points.json"), "--out", path("out")}).err,
      "");
  const Arguments pull{"--thin-lens", "50", "--f-number", "2", "--json", "--out", path("out"), "--keys"};
  const auto film_of = [&](const std::string& file) {
    Arguments line = pull;
    line.push_back(path(file));
    return nlohmann::json::parse(run("pull", line).out)["frames"][0]["film_z_mm"].get<double>();
  };
  write("keys.json", R"({"points": [{"keys": [{"time_s": 0, "position_mm": [100, 50, -1500], "weight": 2}]},
    {"keys": [{"time_s": 0, "position_mm": [0, 0, -2], "at_infinity": true}]}]})");
  EXPECT_EQ(film_of("points.json"), film_of("keys.json"));
#endif
}

// World points lie where the camera sees them; other flags change the answers.
TEST_F(FocalSurfaceProgram, AcceptsWorldPointsAndKinds) {
  write("points.json", R"({"points": [{"world_mm": [0, 0, -2000]}, {"world_mm": [200, 100, -3000]}]})");
  write("q.csv", "x_px,y_px\n150,100\n");
  for (const char* kind : {"affine", "shepard"}) {
    const auto outcome =
        run("surface", arguments({"--table", path("q.csv"), "--kind", kind, "--beta", "2", "--f-number", "4"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NEAR(rows(read(path("out/answers.csv")))[0][2], 2000, 1e-6);
  }
  // The picture does not depend on its resolution.
  const auto small = pfm("out/surface.pfm", 300, 200);
  ASSERT_EQ(run("surface", arguments({"--kind", "shepard", "--beta", "2", "--f-number", "4"}, 900)).status, 0);
  const auto large = pfm("out/surface.pfm", 900, 600);
  for (const std::size_t x : {10u, 100u, 290u}) {
    EXPECT_NEAR(large[(3 * 50 + 1) * 900 + 3 * x + 1], small[50 * 300 + x], 1e-9) << x;
  }
}

}  // namespace
