// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/pupil/f_number.hpp"
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

// The limit against a picture of the ghosts of points of the lamp.
TEST_F(ChooseCamera, GhostsAreNeededAboveTheContrast) {
  const Arguments scene{"--near", "1000", "--far", "inf", "--budget", "1", "--f-number", "2", "--size", "90x60"};
  const auto plain = choice(scene);
  EXPECT_TRUE(plain["ghosts"]["needed"].is_null());
  const double limit = plain["ghosts"]["contrast_limit"];
  for (const double factor : {0.9, 1.1}) {
    Arguments more{scene};
    more.insert(more.end(), {"--contrast", std::to_string(factor * limit)});
    EXPECT_EQ(choice(more)["ghosts"]["needed"], factor > 1);
  }
  const petzval::Lens lens =
      petzval::with_focus(petzval::with_f_number(petzval::testing::data_lens("double_gauss_52mm_f1.8"), 2), 3000);
  const petzval::Film film{.columns = 90, .rows = 60};
  const petzval::Camera camera(lens, film);
  const petzval::Vec3<double> to =
      camera.sample({.film = film.point(76.5, 9), .pupil_u = 0.5, .pupil_v = 0.5}).ray.direction;
  constexpr std::uint32_t count = 32;
  const double radius = petzval::radians(0.5);
  std::vector<float> picture(90 * 60);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto at = petzval::owen_sobol(i, 0);
    const double r = radius * std::sqrt(at.x), turn = petzval::radians(360 * at.y);
    const petzval::Vec3<double> light{to.x + r * std::cos(turn), to.y + r * std::sin(turn), to.z};
    petzval::add_ghosts(lens, {light, true}, film, std::vector<petzval::Wavelength>(1), picture);
  }
  const double solid_angle = std::numbers::pi * radius * radius;
  const double ghost = double{*std::ranges::max_element(picture)} / count * solid_angle * limit;
  const double surroundings = std::numbers::pi / (4 * 2 * 2);
  EXPECT_GT(ghost, 0.003 * surroundings);  // the limit is a bound
  EXPECT_LT(ghost, 0.0105 * surroundings);
}

}  // namespace
