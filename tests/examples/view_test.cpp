// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using petzval::RgbImage;

class ViewProgram : public Programs {
 protected:
  /// A picture of 80 x 60 pixels whose left half is 2 m away and whose right half 5 m; the upper rows are the sky.
  json files() const {
    RgbImage image(80, 60);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i * 7 % 64) / 80;
    petzval::write_pfm(image, path("rgb.pfm"));
    std::vector<float> depths(80 * 60);
    for (std::size_t i = 0; i < depths.size(); ++i) {
      // Rows from the top here, and a hole in the lower left corner.
      depths[i] = i / 80 < 10 ? INFINITY : i / 80 > 55 && i % 80 < 5 ? 0.0f : i % 80 < 40 ? 2000.0f : 5000.0f;
    }
    petzval::write_pfm(80, 60, depths, path("depth.pfm"));
    return {{"image", path("rgb.pfm")},
            {"depth", path("depth.pfm")},
            {"lens", {{"thin_mm", 50}, {"f_number", 2}}},
            {"size", {80, 60}},
            {"fov_deg", 30}};
  }
  static json town(const json& lens) { return {{"scene", "town"}, {"lens", lens}, {"size", {96, 72}}}; }

  std::vector<json> replay(json log, const json& events, const Arguments& more = {}, int status = 0) const {
    log["events"] = events;
    write("log.json", log.dump());
    Arguments arguments{"--replay", path("log.json"), "--json", "--threads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("view", arguments);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    std::vector<json> states;
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) states.push_back(json::parse(line));
    return states;
  }
};

json patch(const char* setup) { return {{"type", "setup"}, {"setup", json::parse(setup)}}; }

double image_of(double distance) { return 50 * distance / (distance - 50); }

TEST_F(ViewProgram, ClicksFocusAThinLensByItsFormula) {
  const std::vector<json> states =
      replay(files(), {{{"type", "add_point"}, {"id", "left"}, {"pixel", {20, 30}}},
                       {{"type", "add_point"}, {"id", 2}, {"pixel", {70, 40}}, {"weight", 3}},
                       {{"type", "serve"}, {"by", "film"}},
                       {{"type", "add_point"}, {"id", "sky"}, {"pixel", {40, 3}}},
                       {{"type", "add_point"}, {"id", "hole"}, {"pixel", {2, 58}}},
                       {{"type", "undo"}}});
  ASSERT_EQ(states.size(), 6u);
  EXPECT_NEAR(states[0]["film"]["z_mm"].get<double>(), image_of(2000), 1e-9);
  EXPECT_NEAR(states[0]["focus_mm"].get<double>(), 2000, 1e-3);
  const double slope = (20 - 40) * std::tan(petzval::radians(15)) / 30;
  EXPECT_NEAR(states[0]["targets"][0]["place_mm"][0].get<double>(), 2000 * slope, 1e-3);
  EXPECT_NEAR(states[0]["targets"][0]["place_mm"][2].get<double>(), -2000, 1e-3);
  EXPECT_NEAR(states[1]["film"]["z_mm"].get<double>(), image_of(5000), 1e-9);
  EXPECT_EQ(states[1]["targets"][1]["id"], 2);
  // Least squares of the blurs: 25 mm (z - z_i) / z_i.
  const double a = std::pow(image_of(2000), -2), b = 3 * std::pow(image_of(5000), -2);
  const double film = (a * image_of(2000) + b * image_of(5000)) / (a + b);
  EXPECT_NEAR(states[2]["film"]["z_mm"].get<double>(), film, 1e-9);
  const double pixel_mm = 2 * std::tan(petzval::radians(15)) * film / 60;
  EXPECT_NEAR(states[2]["targets"][0]["blur_px"].get<double>(), 25 * (film / image_of(2000) - 1) / pixel_mm, 1e-6);
  EXPECT_EQ(states[3]["targets"][2]["at_infinity"], true);
  EXPECT_EQ(states[4]["targets"][3]["status"], "no_depth");
  EXPECT_TRUE(states[4]["targets"][3]["place_mm"].is_null());
  EXPECT_EQ(states[5]["targets"], states[3]["targets"]);
  for (const json& state : states) {
    EXPECT_GT(state["memory_mb"].get<double>(), 0);
    EXPECT_GT(state["frame_ms"].get<double>(), 0);
    EXPECT_EQ(state["rays"], 16);
  }
}

TEST_F(ViewProgram, StillPictureIsThatOfBlur) {
  const json points{{{"type", "add_point"}, {"pixel", {40, 40}}},
                    {{"type", "add_point"}, {"pixel", {70, 30}}, {"blur_px", 1}},
                    {{"type", "add_point"}, {"pixel", {60, 60}}, {"weight", 2}}};
  struct Case {
    json lens, events;
  };
  const json thin{{"thin_mm", 50}, {"f_number", 1.4}};
  const std::vector<Case> cases{
      {thin,
       {{{"type", "serve"}, {"by", "film"}}, patch(R"({"iris": {"blades": 6, "rotation_rad": 0.3490658503988659}})")}},
      {thin, {{{"type", "serve"}, {"by", "tilt"}}, patch(R"({"camera": {"bokeh": {"weight_distribution": 2}}})")}},
      {thin,
       {{{"type", "serve"}, {"by", "surface"}},
        patch(R"({"focal_surface": {"beta": 4}, "lens": {"wavelengths_nm": [587.5618, 650, 510, 475]}})")}},
      {"double_gauss_52mm_f1.8", {patch(R"({"f_number": 2.8})"), {{"type", "serve"}, {"by", "tilt"}}}},
      {"double_gauss_52mm_f1.8",
       {{{"type", "expressive"}, {"from_lens", 2}},
        patch(R"({"camera": {"expressive": {"dispersion": [3]}}})"),
        {{"type", "serve"}, {"by", "film"}}}}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    json events = points;
    events.insert(events.end(), cases[i].events.begin(), cases[i].events.end());
    events.push_back({{"type", "still"}});
    const std::string out = path("view" + std::to_string(i));
    json log = town(cases[i].lens);
    if (cases[i].lens.is_string()) log["ghosts"] = 4;
    const json still = replay(log, events, {"--out", out}).back();
    // The command of the state, word by word; only its folder changes.
    std::istringstream words(still["command"].get<std::string>());
    Arguments arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    ASSERT_GT(arguments.size(), 4u);
    EXPECT_EQ(arguments[0] + ' ' + arguments[1], "petzval blur");
    EXPECT_EQ(arguments.back(), "out");
    arguments.erase(arguments.begin(), arguments.begin() + 2);
    arguments.back() = path("blur" + std::to_string(i));
    const auto outcome = run("blur", arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err << '\n' << still["command"];
    const std::string file = std::string("event_000") + std::to_string(events.size()) + ".png";
    const RgbImage view = petzval::read_png(std::filesystem::path(out) / file);
    EXPECT_EQ(view.pixels, petzval::read_png(path("blur" + std::to_string(i) + "/blur.png")).pixels)
        << still["command"];
  }
}

TEST_F(ViewProgram, FirstPictureIsLikeTheStillPicture) {
  for (const json& lens : {json{{"thin_mm", 50}, {"f_number", 2}}, json("double_gauss_52mm_f1.8")}) {
    json log = town(lens);
    log["size"] = {320, 240};
    replay(log, {{{"type", "add_point"}, {"pixel", {160, 120}}}, {{"type", "still"}}}, {"--out", path("out")});
    const RgbImage first = petzval::read_png(path("out/event_0001.png")),
                   still = petzval::read_png(path("out/event_0002.png"));
    double squares = 0;
    for (std::size_t i = 0; i < first.pixels.size(); ++i) {
      squares += std::pow(static_cast<double>(first.pixels[i] - still.pixels[i]), 2);
    }
    // The still picture has four times the colour samples and 16 to 32 times the rays.
    EXPECT_LT(squares / static_cast<double>(first.pixels.size()), std::pow(10.0, -2.2)) << lens;
  }
}

TEST_F(ViewProgram, RefusedEventsChangeNothingAndAreReported) {
  const std::vector<json> states = replay(files(),
                                          {{{"type", "add_point"}, {"id", "a"}, {"pixel", {20, 30}}},
                                           patch(R"({"focus_mm": 20})"),
                                           {{"type", "serve"}, {"by", "film"}}},
                                          {}, 1);
  ASSERT_EQ(states.size(), 3u);
  EXPECT_EQ(states[1]["film"], states[0]["film"]);
  EXPECT_NE(states[1]["error"].get<std::string>().find("focus"), std::string::npos);
  EXPECT_EQ(states[2]["serve"], "film");
}

// No layers reach as far as the blur of a lens that is 10 m wide.
TEST_F(ViewProgram, ReplayGoesOnAfterAStateWithoutAPicture) {
  const json point{{"type", "add_point"}, {"id", "a"}, {"pixel", {48, 40}}},
      huge = patch(R"({"f_number": 0.5, "lens": {"thin_mm": 5000}})"),
      lens = patch(R"({"f_number": 4, "lens": {"thin_mm": 50}})");
  const json thin{{"thin_mm", 50}, {"f_number", 2}};
  const std::vector<json> states = replay(town(thin), {point, huge, lens}, {"--out", path("out")}, 1);
  ASSERT_EQ(states.size(), 3u);
  EXPECT_TRUE(states[1].contains("error")) << states[1];
  EXPECT_EQ(states[1]["rays"], 0);
  EXPECT_FALSE(std::filesystem::exists(path("out/event_0002.png")));
  EXPECT_FALSE(states[2].contains("error")) << states[2];
  replay(town(thin), {point, lens}, {"--out", path("direct")});
  EXPECT_EQ(petzval::read_png(path("out/event_0003.png")).pixels,
            petzval::read_png(path("direct/event_0002.png")).pixels);
}

TEST_F(ViewProgram, TextHasNoIdentifiersOfStatuses) {
  json log = files();
  log["events"] = {{{"type", "add_point"}, {"id", "left"}, {"pixel", {20, 30}}},
                   {{"type", "add_point"}, {"id", "hole"}, {"pixel", {2, 58}}},
                   {{"type", "serve"}, {"by", "tilt"}},
                   {{"type", "remove_point"}, {"id", "left"}}};
  write("log.json", log.dump());
  const auto outcome = run("view", {"--replay", path("log.json")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word : {"no_depth", "no_targets", "no_weight", "least_tilt"}) {
    EXPECT_EQ(outcome.out.find(word), std::string::npos) << outcome.out;
  }
}

TEST_F(ViewProgram, CommandOfALensFileNamedLikeAFlagWorks) {
  std::filesystem::copy_file(lens("double_gauss_52mm_f1.8"), path("--help.json"));
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  const json still = replay(town("--help.json"), {{{"type", "still"}}}, {"--out", "view"}).back();
  const std::string command = still["command"].get<std::string>();
  const std::string program = std::string(PETZVAL_TEST_PROGRAMS) + '/';
  const int status = std::system((program + command + " --rays 4 > out.txt 2>&1").c_str());
  std::filesystem::current_path(before);
  EXPECT_EQ(status, 0) << command << '\n' << read(path("out.txt"));
  EXPECT_TRUE(std::filesystem::exists(path("out/blur.png"))) << command;
}

TEST_F(ViewProgram, BadLogsAreRefused) {
  json no_lens = files(), wrong_key = files(), wrong_size = files(), two_scenes = files(), bad_lens = files();
  no_lens.erase("lens");
  wrong_key["fov"] = 30;
  wrong_size["size"] = {81, 60};
  two_scenes["scene"] = "town";
  bad_lens["lens"] = "no_such_lens";
  for (const auto& [log, word] : {std::pair{no_lens, "lens"},
                                  {wrong_key, "fov"},
                                  {wrong_size, "81 x 60"},
                                  {two_scenes, "--scene"},
                                  {bad_lens, "no_such_lens"}}) {
    json with_events = log;
    with_events["events"] = json::array();
    write("log.json", with_events.dump());
    const auto outcome = run("view", {"--replay", path("log.json")});
    EXPECT_EQ(outcome.status, 1) << word;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  }
  write("log.json", files().dump());  // without events
  EXPECT_EQ(run("view", {"--replay", path("log.json")}).status, 1);
  EXPECT_EQ(run("view", {"--replay", path("missing.json")}).status, 1);
  EXPECT_EQ(run("view", {"--replay", path("log.json"), "--scene", "town"}).status, 1);
}

TEST_F(ViewProgram, SavesTheEventsWithoutADisplay) {
  const char* const display = std::getenv("DISPLAY");
  const std::string before = display ? display : "";
  for (const char* const name : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  const auto outcome = run("view", {"--scene", "town", "--thin-lens", "50", "--f-number", "2", "--size", "80x60",
                                    "--log", path("saved.json")});
  for (const Arguments& lens : {Arguments{}, {"double_gauss_52mm_f1.8"}}) {  // a log is a file with a set-up
    Arguments line{"--setup", path("saved.json"), "--f-number", "4", "--size", "80x60", "--log", path("again.json")};
    line.insert(line.end(), lens.begin(), lens.end());
    run("view", line);
    std::filesystem::rename(path("again.json"), path(lens.empty() ? "thin.json" : "real.json"));
  }
  if (display) setenv("DISPLAY", before.c_str(), 1);
  EXPECT_EQ(outcome.status, 1);
  if (outcome.err.find("without SDL2") != std::string::npos) GTEST_SKIP() << "built without a window";
  EXPECT_NE(outcome.err.find("display"), std::string::npos) << outcome.err;
  const json saved = read_json(path("saved.json"));
  EXPECT_EQ(saved["scene"], "town");
  for (json wanted = saved["setup"]; const char* const name : {"thin.json", "real.json"}) {
    wanted["f_number"] = 4;
    if (name[0] == 'r') wanted["lens"]["thin_mm"] = 0, wanted["lens"]["file"] = "double_gauss_52mm_f1.8";
    EXPECT_EQ(read_json(path(name))["setup"], wanted);
  }
  EXPECT_EQ(run("view", {"--replay", path("saved.json")}).status, 0);
}

// Clicks of xdotool in a window on Xvfb.
TEST_F(ViewProgram, WindowFocusesWhereTheUserClicks) {
  if (std::system("command -v xvfb-run xdotool >/dev/null 2>&1") != 0) GTEST_SKIP() << "xvfb or xdotool is missing";
  const std::string program = std::string(PETZVAL_TEST_PROGRAMS) + "/petzval view";
  const std::string screen = "timeout -k 5 120 xvfb-run -a -s '-screen 0 1280x1024x24' sh '" + path("script.sh") +
                             "' >'" + path("out.txt") + "' 2>&1";
  // The picture begins 8 pixels from the corner of the window.
  write("script.sh", program + " --scene town --thin-lens 50 --f-number 1.4 --size 320x240 --log '" +
                         path("events.json") + R"(' & child=$!
window=$(xdotool search --sync --name 'petzval view' | tail -1)
sleep 2
click() { xdotool mousemove --window "$window" $(($1 + 8)) $(($2 + 8)); sleep 0.5; xdotool click 1; sleep 1; }
click 100 150
xdotool keydown shift; click 290 120; xdotool keyup shift
xdotool mousemove_relative -- -190 30; sleep 1; xdotool key --window "$window" 2; sleep 1
click 60 50
xdotool key --window "$window" 0; sleep 0.5
xdotool key --window "$window" ctrl+q
wait $child
)" + program + " --replay '" +
                         path("events.json") + "' --screenshot '" + path("window.png") + "'\n");
  if (std::system(screen.c_str()) != 0) {
    const std::string output = read(path("out.txt"));
    if (output.find("without SDL2") != std::string::npos) GTEST_SKIP() << "built without a window";
    FAIL() << output;
  }
  const json log = read_json(path("events.json"));
  const json& events = log["events"];
  ASSERT_EQ(events.size(), 4u) << events;
  EXPECT_EQ(events[0]["type"], "add_point");  // in the middle, by the program
  EXPECT_EQ(events[1], (json{{"type", "move_point"}, {"id", "1"}, {"pixel", {100.0, 150.0}}}));
  EXPECT_EQ(events[2], (json{{"type", "add_point"}, {"id", "2"}, {"pixel", {290.0, 120.0}}}));
  // At 2:1 around (100, 150), the picture of 320 x 240 begins at (20, 90).
  EXPECT_EQ(events[3]["pixel"], (json{50.0, 115.0}));

  json again = log;
  again.erase("events");
  json more = events;
  more.push_back({{"type", "still"}});
  replay(again, more, {"--out", path("replayed")});
  const RgbImage window = petzval::read_png(path("window.png")),
                 still = petzval::read_png(path("replayed/event_0005.png"));
  ASSERT_EQ(still.width, 320);
  int differ = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      for (int c = 0; c < 3; ++c) differ += std::abs(window.pixel(x + 8, y + 8)[c] - still.pixel(x, y)[c]) > 0.02f;
    }
  }
  EXPECT_LT(differ, 3 * 5000);  // the handles and their texts
  EXPECT_GT(differ, 100);
}

}  // namespace
