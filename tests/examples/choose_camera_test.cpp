// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "petzval/camera/camera.hpp"
#include "program.hpp"

namespace {

class ChooseCamera : public Programs {
 protected:
  nlohmann::json choice(const Arguments& more) const {
    Arguments arguments{lens("double_gauss_52mm_f1.8"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("choose", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
};

nlohmann::json row_of(const nlohmann::json& choice, const std::string& model) {
  return *std::ranges::find_if(choice["table"], [&](const auto& row) { return row["model"] == model; });
}

TEST_F(ChooseCamera, ChosenModelKeepsTheBudgetForFreshSamples) {
  for (const char* budget : {"2", "0.2", "0.01"}) {
    const auto json = choice({"--near", "1000", "--far", "inf", "--budget", budget});
    SCOPED_TRACE(json.dump());
    const std::string model = json["model"];
    const auto row = row_of(json, model);
    EXPECT_LE(json["predicted_max_px"], std::stod(budget));
    EXPECT_LE(json["verified_max_px"], json["predicted_max_px"]);
    EXPECT_GT(json["verified_max_px"], 0.4 * json["predicted_max_px"].get<double>());
    EXPECT_EQ(json["predicted_max_px"], row["max_px"]);
    EXPECT_FALSE(json["reasons"].empty());
    ASSERT_EQ(json["table"].size(), petzval::models().size());
    for (const auto& other : json["table"]) {
      const bool inside =
          other["max_px"] <= std::stod(budget) && other["exposure_error"] <= 0.01 && other["pupil_shape_error"] <= 0.02;
      if (inside) {
        EXPECT_GE(other["cost"], row["cost"]) << other.dump();
      }
    }
  }
}

TEST_F(ChooseCamera, ErrorsDependOnDepthsAndStop) {
  // The error of a pinhole grows far behind the plane of focus.
  const auto all = choice({"--near", "1000", "--far", "inf", "--budget", "1"});
  const auto focus = choice({"--near", "2900", "--far", "3100", "--budget", "1"});
  EXPECT_LT(row_of(focus, "pinhole")["max_px"], row_of(all, "pinhole")["max_px"]);
  const auto stopped = choice({"--near", "1000", "--far", "inf", "--budget", "1", "--f-number", "8"});
  EXPECT_LT(row_of(stopped, "polynomial_5")["max_px"], 0.5 * row_of(all, "polynomial_5")["max_px"].get<double>());
}

}  // namespace
