// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/io/lens_json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

constexpr const char* rack = R"([{"from_s": 0, "until_s": 4, "keys": [
  {"time_s": 1, "position_mm": [0, 0, -1000]}, {"time_s": 3, "position_mm": [100, 0, -4000]}]}])";
const Arguments thin_50{"--model", "thin", "--thin-focal-length-mm", "50", "--f-number", "2"};

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
    const auto outcome = run("focus_pull", command(lens, keys, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["frames"];
  }
  void refuses(const std::string& keys, const std::string& reason, const Arguments& more = {}) const {
    expect_failure("focus_pull", command(thin_50, keys, more), reason);
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << keys;
  }
};

/// The image distance of the 50 mm thin lens at the origin.
double film_of(double distance) { return 50 * distance / (distance - 50); }

TEST_F(FocusPull, PassesItsKeysAndStaysBetweenThem) {
  const json all = frames(thin_50, rack);
  ASSERT_EQ(all.size(), 97u);  // 4 s at 24 frames per s, with both ends
  EXPECT_EQ(all[0]["time_s"], 0);
  EXPECT_EQ(all[96]["time_s"], 4);
  for (const std::size_t i : {0u, 12u, 24u}) {
    EXPECT_NEAR(all[i]["film_z_mm"], film_of(1000), 1e-9);
    EXPECT_NEAR(all[i]["subject_distance_mm"], 1000, 1e-6);
    EXPECT_NEAR(all[i]["breathing"], film_of(1000) / 50 - 1, 1e-12);
  }
  for (const std::size_t i : {72u, 96u}) EXPECT_NEAR(all[i]["film_z_mm"], film_of(4000), 1e-9);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LE(all[i]["film_z_mm"].get<double>(), all[i - 1]["film_z_mm"].get<double>() + 1e-12) << i;
    EXPECT_EQ(all[i]["status"], "solved");
    EXPECT_EQ(all[i]["targets"], 1);
    EXPECT_NEAR(all[i]["rms_blur_um"], 0, 1e-9);
  }
}

TEST_F(FocusPull, CountsDistancesFromTheirOrigin) {
  for (const auto& [origin, z] :
       {std::pair{"film", film_of(1000)}, {"entrance_pupil", 0.0}, {"front_principal", 0.0}}) {
    const json all = frames(thin_50, rack, {"--distance-from", origin});
    EXPECT_NEAR(all[0]["subject_distance_mm"], 1000 + z, 1e-6) << origin;
  }
}

TEST_F(FocusPull, SaysWhatTheLibraryFinds) {
  const std::string id = "double_gauss_100mm_f2.0";
  const petzval::Lens lens =
      petzval::with_f_number(petzval::compile(petzval::read_prescription(Programs::lens(id))), 4);
  petzval::FocusPoint point;
  point.keys.push_back({1, petzval::ScenePoint{{0, 0, -1000}, false}});
  point.keys.push_back({3, petzval::ScenePoint{{100, 0, -4000}, false}});
  const petzval::ImageRays rays(lens, 1.3 * std::hypot(18, 12));
  for (const std::string criterion : {"min_rms", "min_max"}) {
    const json all =
        frames({Programs::lens(id)}, rack, {"--f-number", "4", "--criterion", criterion, "--frames-per-s", "2"});
    ASSERT_EQ(all.size(), 9u);
    for (const json& frame : all) {
      SCOPED_TRACE(frame.dump());
      petzval::FocusMoment moment;
      moment.time = frame["time_s"];
      const auto targets = petzval::focus_targets(petzval::thick_lens(lens), {&point, 1}, moment);
      const auto measure = criterion == "min_rms" ? petzval::FocusCriterion::min_rms : petzval::FocusCriterion::min_max;
      const auto found = petzval::autofocus(rays, targets, {}, measure);
      EXPECT_NEAR(frame["film_z_mm"], found.film.z(), 1e-3);
      EXPECT_NEAR(frame["rms_blur_um"], 1e3 * found.rms_mm, 1e-2 * 1e3 * found.rms_mm);
      EXPECT_NEAR(frame["breathing"], petzval::breathing(lens, frame["film_z_mm"], {.criterion = measure}).value(),
                  1e-9);
    }
  }
}

TEST_F(FocusPull, KeepsTheFilmWhereNothingIsToBeServed) {
  const json all =
      frames(thin_50, R"([{"from_s": 1, "until_s": 2, "keys": [{"time_s": 1, "position_mm": [0, 0, -800]}]},
    {"from_s": 3, "until_s": 4, "keys": [{"time_s": 0, "position_mm": [0, 0, -1600]}]}])",
             {"--frames-per-s", "4"});
  ASSERT_EQ(all.size(), 13u);
  for (const json& frame : all) {
    const double time = frame["time_s"];
    const bool between = time > 2 && time < 3;
    EXPECT_EQ(frame["status"], between ? "no_targets" : "solved") << time;
    EXPECT_EQ(frame["rms_blur_um"].is_null(), between) << time;
    EXPECT_NEAR(frame["film_z_mm"], film_of(time < 3 ? 800 : 1600), 1e-9) << time;
  }
}

TEST_F(FocusPull, LastsAsLongAsItsPointsDo) {
  // Keys may lie outside the interval of their point.
  const json late = frames(thin_50, R"([{"from_s": 9, "keys": [{"time_s": 0, "position_mm": [0, 0, -1000]}]}])");
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0]["time_s"], 9);
  EXPECT_NEAR(late[0]["film_z_mm"], film_of(1000), 1e-9);
  const json early = frames(thin_50, R"([{"until_s": -1, "keys": [{"time_s": 0, "position_mm": [0, 0, -1000]}]}])");
  ASSERT_EQ(early.size(), 1u);
  EXPECT_EQ(early[0]["time_s"], -1);
}

TEST_F(FocusPull, PullsToInfinity) {
  const json all = frames(thin_50, R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -900]},
    {"time_s": 1, "position_mm": [0, 0, -1], "at_infinity": true}]}])");
  EXPECT_NEAR(all.back()["film_z_mm"], 50, 1e-9);
  EXPECT_TRUE(all.back()["subject_distance_mm"].is_null() || all.back()["subject_distance_mm"].get<double>() > 1e9);
  EXPECT_NEAR(all.back()["breathing"], 0, 1e-12);
}

TEST_F(FocusPull, TiltsWhereAskedTo) {
  const std::string moving =
      R"([{"keys": [{"time_s": 0, "position_mm": [0, -100, -800]}, {"time_s": 1, "position_mm": [0, -50, -800]}]},
    {"keys": [{"time_s": 0, "position_mm": [0, 100, -1500]}]}, {"keys": [{"time_s": 0, "position_mm": [200, 100, -1500]}]}])";
  const json tilted = frames(thin_50, moving, {"--tilt"}), upright = frames(thin_50, moving);
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

TEST_F(FocusPull, LeavesOutWhatIsOutsideTheFilmThatIsGiven) {
  const std::string keys = R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -1000]}]},
    {"keys": [{"time_s": 0, "position_mm": [0, 900, -2000]}]}])";
  EXPECT_EQ(frames(thin_50, keys)[0]["targets"], 2);
  EXPECT_EQ(frames(thin_50, keys, {"--film-mm", "36x24"})[0]["targets"], 1);
}

TEST_F(FocusPull, WritesATableAndAPlot) {
  const auto outcome = run("focus_pull", command(thin_50, rack, {}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(path("out"))) names.insert(file.path().filename());
  EXPECT_EQ(names, (std::set<std::string>{"thin_lens_focus_pull.csv", "thin_lens_focus_pull.svg"}));
  const auto rows = lines(read(path("out/thin_lens_focus_pull.csv")));
  ASSERT_EQ(rows.size(), 98u);
  EXPECT_EQ(rows[0], "time_s,film_z_mm,subject_distance_mm,tilt_deg,swing_deg,rms_blur_um,breathing,targets,status");
  EXPECT_TRUE(rows[1].starts_with("0,52.63157894736842,1000")) << rows[1];
  EXPECT_TRUE(rows[1].ends_with(",1,solved")) << rows[1];
  EXPECT_TRUE(read(path("out/thin_lens_focus_pull.svg")).ends_with("</svg>\n"));
  for (const std::string& name : names) EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
  EXPECT_NE(outcome.out.find("52.63158"), std::string::npos) << outcome.out;
}

TEST_F(FocusPull, RefusesKeysThatAreNone) {
  refuses("[", "keys.json: not JSON: ");
  refuses("[]", "keys.json: found [], wanted a list of one point or more");
  refuses(R"([{}])", "keys.json: point 1: keys: found none");
  refuses(R"([{"keys": []}])", "point 1: keys: found [], wanted a list of one key or more");
  refuses(R"([{"keys": [{"position_mm": [0, 0, -1]}]}])", "point 1: keys: key 1: time_s: found none");
  refuses(R"([{"keys": [{"time_s": 0, "position_mm": [0, -1]}]}])", "key 1: position_mm: found [0,-1]");
  refuses(R"([{"keys": [{"time_s": "0", "position_mm": [0, 0, -1]}]}])", "time_s: found \"0\"");
  refuses(R"([{"until": 3, "keys": [{"time_s": 0, "position_mm": [0, 0, -1]}]}])", "found the key \"until\"");
  refuses(R"([{"keys": [{"time_s": 1, "position_mm": [0, 0, -900]}, {"time_s": 1, "position_mm": [0, 0, -800]}]}])",
          "key 2: time_s: found 1, wanted a time after");
  refuses(R"([{"keys": [{"time_s": 1, "position_mm": [0, 0, -9], "extent_stops": 1},)"
          R"({"time_s": 2, "position_mm": [0, 0, -8]}]}])",
          "key 2: extent_stops: found in some keys only");
  refuses(R"([{"from_s": 2, "until_s": 1, "keys": [{"time_s": 1, "position_mm": [0, 0, -900]}]}])",
          "until_s: found 1, wanted");
  refuses(R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, 900]}]}])", "found no point to focus on in any frame");
  refuses(R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -900]}, {"time_s": 1e9, "position_mm": [0, 0, -900]}]}])",
          "wanted at most 100000");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += R"([{"keys":)";
  refuses(deep, "keys.json: found lists or objects nested more than 8 deep");
}

TEST_F(FocusPull, ExplainsItselfAndRefusesABadCommandLine) {
  const auto help = run("focus_pull", {"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("Usage: focus_pull"), std::string::npos);
  const auto fails = [&](const Arguments& arguments, const std::string& reason) {
    expect_failure("focus_pull", command(arguments, rack, {}), reason);
  };
  fails({}, "LENS is required");
  fails({lens("double_gauss_100mm_f2.0"), "--criterion", "sharp"}, "--criterion");
  for (const std::string model : {"thin", "thick"}) {
    fails({lens("double_gauss_100mm_f2.0"), "--model", model, "--criterion", "min_max"},
          "--criterion: found it with --model " + model + ", wanted --model real");
  }
  fails({"--model", "thin", "--thin-focal-length-mm", "50", "--f-number", "2", "--configuration", "1"},
        "--configuration requires LENS");
  fails({lens("double_gauss_100mm_f2.0"), "--frames-per-s", "0"}, "--frames-per-s: found \"0\"");
  expect_failure("focus_pull", {lens("double_gauss_100mm_f2.0"), "--out", path("out")}, "--keys is required");
}

}  // namespace
