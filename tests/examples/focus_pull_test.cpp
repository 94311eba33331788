// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include "../data_lenses.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;

constexpr const char* rack = R"([{"from_s": 0, "until_s": 4, "keys": [
  {"time_s": 1, "position_mm": [0, 0, -1000]}, {"time_s": 3, "position_mm": [100, 0, -4000]}]}])";
const Arguments thin_50{"--thin-lens", "50", "--f-number", "2"};

class FocusPull : public Programs {
 protected:
  Arguments command(Arguments arguments, const std::string& keys, const Arguments& more) const {
    write("keys.json", keys);
    for (const std::string& a : {std::string("--keys"), path("keys.json"), std::string("--out"), path("out")}) {
      arguments.push_back(a);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  json frames(const Arguments& lens, const std::string& keys, Arguments more = {}) const {
    more.push_back("--json");
    const auto outcome = run("pull", command(lens, keys, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["frames"];
  }
};

/// The image distance of the 50 mm thin lens at the origin.
double film_of(double distance) { return 50 * distance / (distance - 50); }

TEST_F(FocusPull, WritesDistancesThatBlurReads) {
  const json all = frames(thin_50, rack, {"--fps", "1", "--from", "film"});
  Arguments blur = thin_50;
  for (const std::string& a :
       {std::string("--focus"), path("out/thin_lens_focus_pull.json"), std::string("--from"), std::string("film"),
        std::string("--fps"), std::string("1"), std::string("--scene"), std::string("town"), std::string("--size"),
        std::string("40x30"), std::string("--rays"), std::string("4"), std::string("--out"), path("blur")}) {
    blur.push_back(a);
  }
  const auto outcome = run("blur", blur);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = read_json(path("blur/blur.json"));
  ASSERT_EQ(report["frames"].size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double distance = all[i]["subject_distance_mm"];
    EXPECT_NEAR(report["frames"][i]["focus_mm"], distance, 1e-9 * distance) << i;
  }
}

TEST_F(FocusPull, CountsDistancesFromTheirOrigin) {
  for (const auto& [origin, z] :
       {std::pair{"film", film_of(1000)}, {"entrance_pupil", 0.0}, {"front_principal", 0.0}}) {
    const json all = frames(thin_50, rack, {"--from", origin});
    EXPECT_NEAR(all[0]["subject_distance_mm"], 1000 + z, 1e-6) << origin;
  }
}

TEST_F(FocusPull, NumbersEqualTheLibrary) {
  const std::string id = "double_gauss_100mm_f2.0";
  const petzval::Lens lens = petzval::with_f_number(petzval::testing::data_lens(id), 4);
  petzval::FocusPoint point;
  point.keys.push_back({1, petzval::ScenePoint{{0, 0, -1000}, false}});
  point.keys.push_back({3, petzval::ScenePoint{{100, 0, -4000}, false}});
  for (const std::string criterion : {"min_rms", "min_max"}) {
    const json all = frames({Programs::lens(id)}, rack, {"--f-number", "4", "--criterion", criterion, "--fps", "2"});
    ASSERT_EQ(all.size(), 9u);
    for (const json& frame : all) {
      SCOPED_TRACE(frame.dump());
      petzval::FocusTime moment;
      moment.time = frame["time_s"];
      const auto targets = petzval::focus_targets(petzval::thick_lens(lens), {&point, 1}, moment);
      const auto measure = criterion == "min_rms" ? petzval::FocusCriterion::min_rms : petzval::FocusCriterion::min_max;
      constexpr std::size_t rays = 4096;  // as the command
      const auto found = petzval::autofocus(lens, targets, {}, measure, rays);
      EXPECT_NEAR(frame["film_z_mm"], found.film.z(), 1e-6);
      EXPECT_NEAR(frame["rms_blur_um"], 1e3 * found.rms_mm, 1e-6 * 1e3 * found.rms_mm);
      EXPECT_NEAR(frame["breathing"], petzval::breathing(lens, frame["film_z_mm"], {.criterion = measure}).value(),
                  1e-9);
    }
  }
}

TEST_F(FocusPull, FilmStaysBetweenThePointsInTime) {
  const json all =
      frames(thin_50, R"([{"from_s": 1, "until_s": 2, "keys": [{"time_s": 1, "position_mm": [0, 0, -800]}]},
    {"from_s": 3, "until_s": 4, "keys": [{"time_s": 0, "position_mm": [0, 0, -1600]}]}])",
             {"--fps", "4"});
  ASSERT_EQ(all.size(), 13u);
  for (const json& frame : all) {
    const double time = frame["time_s"];
    const bool between = time > 2 && time < 3;
    EXPECT_EQ(frame["status"], between ? "no_targets" : "solved") << time;
    EXPECT_EQ(frame["rms_blur_um"].is_null(), between) << time;
    EXPECT_NEAR(frame["film_z_mm"], film_of(time < 3 ? 800 : 1600), 1e-9) << time;
  }
}

TEST_F(FocusPull, TiltOptionTiltsTheFilm) {
  const std::string moving =
      R"([{"keys": [{"time_s": 0, "position_mm": [0, -100, -800]}, {"time_s": 1, "position_mm": [0, -50, -800]}]},
    {"keys": [{"time_s": 0, "position_mm": [0, 100, -1500]}]}, {"keys": [{"time_s": 0, "position_mm": [200, 100, -1500]}]}])";
  const json tilted = frames(thin_50, moving, {"--fit-tilt"}), upright = frames(thin_50, moving);
  ASSERT_EQ(tilted.size(), upright.size());
  for (std::size_t i = 0; i < tilted.size(); ++i) {
    EXPECT_EQ(tilted[i]["status"], "solved");
    EXPECT_LT(tilted[i]["rms_blur_um"], 1e-6);
    EXPECT_GT(upright[i]["rms_blur_um"], 10);
    EXPECT_EQ(upright[i]["tilt_deg"], 0);
  }
  EXPECT_GT(std::abs(tilted[0]["tilt_deg"].get<double>()), 1);
  EXPECT_NE(tilted.front()["tilt_deg"], tilted.back()["tilt_deg"]);
}

TEST_F(FocusPull, WritesATableAndAPlot) {
  const auto outcome = run("pull", command(thin_50, rack, {}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(path("out"))) names.insert(file.path().filename());
  EXPECT_EQ(names, (std::set<std::string>{"thin_lens_focus_pull.csv", "thin_lens_focus_pull.json",
                                          "thin_lens_focus_pull.svg"}));
  const auto rows = lines(read(path("out/thin_lens_focus_pull.csv")));
  ASSERT_EQ(rows.size(), 98u);
  EXPECT_EQ(rows[0], "time_s,film_z_mm,subject_distance_mm,tilt_deg,swing_deg,rms_blur_um,breathing,targets,status");
  EXPECT_TRUE(rows[1].starts_with("0,52.63157894736842,1000")) << rows[1];
  EXPECT_TRUE(rows[1].ends_with(",1,solved")) << rows[1];
  EXPECT_TRUE(read(path("out/thin_lens_focus_pull.svg")).ends_with("</svg>\n"));
  for (const std::string& name : names) EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
}

}  // namespace
