// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

class ExpressiveLensProgram : public Programs {
 protected:
  nlohmann::json draw(const std::string& id, std::vector<std::string> more, const std::string& out = "out") const {
    std::vector<std::string> arguments{lens(id), "--focus", "1000", "--rays", "2048", "--out", path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("expressive", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines(outcome.out), (std::vector{path(out + "/highlights.svg"), path(out + "/expressive.json")}));
    EXPECT_TRUE(read(path(out + "/highlights.svg")).starts_with("<svg"));
    return read_json(path(out + "/expressive.json"));
  }
};

// Without options, the aberrations and the sizes of highlights equal the real lens.
TEST_F(ExpressiveLensProgram, DefaultsEqualTheRealLens) {
  const auto json = draw("double_gauss_100mm_f1.35", {"--at", "850,1300"});
  EXPECT_EQ(json["power"].size(), 13u);
  EXPECT_GT(json["film_offsets_mm"].size(), 30u);
  EXPECT_EQ(json["dispersion"], 1);
  std::map<std::string, std::vector<double>> rms;
  for (const auto& tile : json["highlights"]) rms[tile["row"]].push_back(tile["rms_mm"]);
  ASSERT_EQ(rms.size(), 3u);
  ASSERT_EQ(rms["real lens"].size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(rms["expressive lens"][i] / rms["real lens"][i], 1, 0.1) << i;
  const auto twice = draw("double_gauss_100mm_f1.35", {"--at", "850", "--from-lens", "2"}, "twice");
  for (std::size_t k = 0; k < 13; ++k) {
    EXPECT_NEAR(twice["power"][k][1].get<double>() - 1, 2 * (json["power"][k][1].get<double>() - 1), 1e-12);
  }
  const auto none = draw("double_gauss_100mm_f1.35", {"--at", "850", "--from-lens", "0"}, "none");
  EXPECT_TRUE(none["power"].empty());
  EXPECT_TRUE(none["film_offsets_mm"].empty());
}

TEST_F(ExpressiveLensProgram, AcceptsSplinePointsAndDispersion) {
  const auto json =
      draw("double_gauss_100mm_f2_28deg", {"--power-spline", "0:1", "0.7:1.02", "1:0.97", "--curvature-points", "0,0:0",
                                           "-18,12:1.5", "--dispersion", "3", "--at", "1200", "--model", "thick"});
  EXPECT_EQ(json["power"], (nlohmann::json{{0, 1}, {0.7, 1.02}, {1, 0.97}}));
  EXPECT_EQ(json["film_offsets_mm"], (nlohmann::json{{0, 0, 0}, {-18, 12, 1.5}}));
  EXPECT_EQ(json["dispersion"], 3);
}

}  // namespace
