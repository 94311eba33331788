// SPDX-License-Identifier: Apache-2.0
// Reports with a set-up of a camera, and --setup, which takes it back.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/formats/lens_file.hpp"
#include "petzval/image/image.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;

class Setup : public Programs {
 protected:
  void SetUp() override {
    Programs::SetUp();
    petzval::ExrPart part{.width = 4, .height = 4};
    part.channels = {{"Y", {0, 1, 1, 0, 1, 1, 0.5f, 1, 1, 1, 1, 1, 0, 1, 1, 0}}};
    petzval::write_exr({&part, 1}, path("map.exr"));
    write("points.json", R"({"points": [{"world_mm": [0, 0, -1200]}, {"pixel": [5, 2], "distance_mm": null},
      {"pixel": [20, 12], "distance_mm": 700, "blur_px": 2, "weight": 0.5}]})");
    write("coating.csv", "index,absorption,thickness_nm\n1.38,0,99.6\n");
  }

  /// Runs a command with the inputs that no set-up states; returns its report.
  json report(const std::string& command, Arguments arguments, const std::string& out) const {
    static const std::map<std::string, Arguments> usual{
        {"render", {"--scene", "balls", "--spp", "2", "--integrator", "path"}},
        {"blur", {"--scene", "town", "--rays", "4", "--format", "exr"}},
        {"psf", {"--at", "2m", "--rays", "64", "--format", "exr"}}};
    const Arguments& more = usual.at(command);
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"--out", path(out)});
    const Outcome outcome = run(command, expanded(arguments));
    EXPECT_EQ(outcome.status, 0) << command << ' ' << outcome.err;
    for (const auto& file : std::filesystem::directory_iterator(path(out))) {
      const json found = file.path().extension() == ".json" ? read_json(file) : json();
      if (found.is_object() && found.contains("setup")) {
        std::filesystem::copy_file(file, path(out + ".json"), std::filesystem::copy_options::overwrite_existing);
        return found;
      }
    }
    ADD_FAILURE() << command << ": no report has a set-up";
    return {};
  }
  /// The values of all pictures in a folder.
  std::vector<std::vector<float>> pictures(const std::string& out) const {
    std::vector<std::vector<float>> all;
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(path(out))) {
      if (file.path().extension() == ".exr" && file.path().filename() != "sums.exr") files.push_back(file.path());
    }
    std::ranges::sort(files);
    for (const auto& file : files) {
      for (const petzval::ExrPart& part : petzval::read_exr_parts(file)) {
        for (const auto& [name, values] : part.channels) all.push_back(values);
      }
    }
    EXPECT_FALSE(all.empty());
    return all;
  }
  void expect_round_trip(const std::string& command, const std::vector<Arguments>& lines) const {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string first = command + std::to_string(i), again = first + "_again";
      const json before = report(command, lines[i], first);
      const json after = report(command, {"--setup", "@" + first + ".json"}, again);
      EXPECT_EQ(after["setup"], before["setup"]) << first;
      EXPECT_EQ(pictures(again), pictures(first)) << first;
    }
  }
};

TEST_F(Setup, RenderedPictureIsMadeAgainToTheBit) {
  const auto with = [](Arguments more) {
    more.insert(more.end(), {"LENS", "--size", "24x16", "--focus", "1m"});
    return more;
  };
  expect_round_trip(
      "render",
      {with({}),
       with({"--f-number", "4", "--blades", "6", "--roundness", "0.2", "--iris-rotation", "7.3", "--iris-area", "equal",
             "--coatings", "@coating.csv", "--tilt", "3.1", "--swing", "-1", "--film", "30x20"}),
       with({"--f-number", "1.99", "--wavelengths", "rgb", "--coatings", "none", "--normalisation", "irradiance"}),
       with({"--wavelengths", "hero", "--from", "film", "--criterion", "paraxial"}),
       with({"--wavelengths", "F", "--model", "thin_two_disc", "--weight-map", "@map.exr"}),
       with({"--model", "auto", "--budget", "5", "--iris-image", "@map.exr", "--lens-ratio", "1.2", "--keep-light"}),
       with({"--model", "thick", "--points", "@points.json", "--kind", "shepard", "--beta", "2"}),
       with({"--model", "thick", "--from-lens", "2", "--dispersion", "0.5", "--wavelengths", "rgb"}),
       {"LENS:zoom_70-210mm_f4", "--configuration", "1", "--match-glasses", "--size", "24x16", "--focus", "inf"}});
}

TEST_F(Setup, CameraOfTheLibraryEqualsTheCameraOfTheReport) {
  const std::vector<Arguments> lines{
      {"LENS", "--f-number", "4", "--blades", "6", "--iris-area", "equal", "--coatings", "mgf2"},
      {"LENS:double_gauss_52mm_f1.8", "--f-number", "1.8", "--wavelengths", "hero", "--from", "film"},
      {"LENS:zoom_70-210mm_f4", "--configuration", "1", "--match-glasses"}};
  for (Arguments line : lines) {
    line.insert(line.end(), {"--focus", "2m", "--size", "8x8"});
    const json found = report("render", line, "first");
    const petzval::Camera camera = petzval::camera(petzval::camera_setup(read(path("first.json")), "first.json"));
    EXPECT_EQ(petzval::real_f_number(camera.lens()), found["job"]["real_f_number"].get<double>()) << line[0];
    EXPECT_EQ(camera.lens().name(), found["job"]["lens"]) << line[0];
    EXPECT_EQ(petzval::name(camera.model()), found["model"]) << line[0];
  }
}

TEST_F(Setup, ShardsOfFilesInOtherFoldersAreMergedAndResumed) {
  std::filesystem::create_directory(folder / "other");
  for (const char* file : {"map.exr", "coating.csv", "points.json"}) {
    std::filesystem::copy_file(path(file), folder / "other" / file);
  }
  std::filesystem::copy_file(lens("double_gauss_52mm_f1.8"), folder / "other/copy.json");
  const auto render = [&](const std::string& text) {
    std::istringstream words(text + " --scene balls --integrator path");
    return run("render", {std::istream_iterator<std::string>(words), {}});
  };
  const auto shard = [&](const std::string& lens_file, const std::string& from, const std::string& which) {
    const Outcome outcome = render(
        lens_file + " --iris-image " + from + "map.exr --coatings " + from + "coating.csv --points " + from +
        "points.json --model thick --f-number 4 --blades 5 --iris-area equal --wavelengths F --focus 1m --size 40x24 "
        "--spp 2 --shard " +
        which + " --out " + path("shards"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  shard("double_gauss_52mm_f1.8", path(""), "1/2");
  shard(path("other/copy.json"), path("other/"), "2/2");
  EXPECT_EQ(run("render", {"merge", path("shards"), "--out", path("merged")}).status, 0);
  // The set-up has the values of the flags: it continues the first shard; another picture is refused.
  const std::string again =
      "--setup " + path("merged/render.json") + " --spp 4 --shard 1/2 --resume --out " + path("shards");
  EXPECT_EQ(render(again).status, 0);
  for (const char* change : {" --coatings mgf2", " --wavelengths d", " --f-number 5", " --dispersion 2"}) {
    EXPECT_EQ(render(again + change).status, 1) << change;
  }
}

TEST_F(Setup, PsfUsesASetupAndStatesWhatItUsed) {
  const auto with = [](const Arguments& more) {
    Arguments all{"LENS", "--focus", "1m", "--size", "24x16", "--model", "thick", "--film", "24x16"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  report("render", with({}), "plain");
  report("render", with({"--power-spline", "0:1", "0.7:1.01", "1:0.98"}), "expressive");
  report("render", with({"--tilt", "3", "--coatings", "mgf2", "--points", "@points.json"}), "more");
  const json plain = report("psf", {"--setup", "@plain.json"}, "plain_psf");
  const json expressive = report("psf", {"--setup", "@expressive.json"}, "expressive_psf");
  const json more = report("psf", {"--setup", "@more.json"}, "more_psf");
  EXPECT_EQ(plain["setup"]["film"], read_json(path("plain.json"))["setup"]["film"]);
  EXPECT_EQ(expressive["setup"], read_json(path("expressive.json"))["setup"]);
  EXPECT_NE(pictures("expressive_psf"), pictures("plain_psf"));
  EXPECT_EQ(more["setup"], plain["setup"]);
  EXPECT_EQ(pictures("more_psf"), pictures("plain_psf"));
  EXPECT_NE(run("psf", {"--setup", path("more.json"), "--at", "2m", "--rays", "64", "--out", path("o")}).err, "");
  // Rates refer to half of the longer side of the film; psf without a set-up has a film of 36 x 24 mm.
  report("render", with({"--rate-of-change", "1"}), "cat");
  report("psf", {"--setup", "@cat.json", "--fields", "5"}, "cat_psf");
  report("psf", {"LENS", "--focus", "1m", "--model", "thick", "--rate-of-change", "1.5", "--fields", "5"}, "wide_psf");
  EXPECT_EQ(pictures("cat_psf"), pictures("wide_psf"));
}

TEST_F(Setup, ReportOfSeveralLensesNeedsOneOfThem) {
  const Arguments lenses = expanded({"LENS", "LENS:double_gauss_52mm_f1.8"});
  Arguments line{lenses[0], lenses[1], "--focus", "1m", "--f-number", "4", "--at", "2m", "--rays", "64"};
  line.push_back("--match-glasses");
  line.insert(line.end(), {"--format", "exr", "--out", path("two")});
  ASSERT_EQ(run("psf", line).status, 0);
  const Arguments setup{"--setup", path("two/bokeh.json"), "--size", "8x8"};
  const json found = report("render", {setup[0], setup[1], setup[2], setup[3], lenses[1]}, "one")["setup"];
  EXPECT_EQ(found["lens"]["file"], lenses[1]);
  EXPECT_EQ(found["lens"]["match_glasses"], true);
  EXPECT_EQ(found["f_number"], 4);
  for (const json& lenses_of_file : {json(3), json::array(), json{3}, json{{{"setup", json::object()}}}}) {
    write("lenses.json", json{{"lenses", lenses_of_file}}.dump());
    expect_failure("render", {"--scene", "balls", "--setup", path("lenses.json"), "--out", path("out")},
                   {"lenses.json", "lenses"});
  }
  Arguments without{"--scene", "balls", "--out", path("out")};
  without.insert(without.end(), setup.begin(), setup.end());
  expect_failure("render", without, {"bokeh.json", "LENS", lenses[0], lenses[1]});
}

TEST_F(Setup, PsfTakesExactRaysAndWavelengthsOfAnyPicture) {
  report("render", {"LENS", "--focus", "1m", "--size", "8x8", "--f-number", "8", "--wavelengths", "hero"}, "hero");
  const json waves = report("psf", {"--setup", "@hero.json", "--diffraction"}, "waves");
  EXPECT_EQ(waves["model"], "exact_double");
  EXPECT_EQ(waves["wavelengths_nm"].size(), 1);
}

TEST_F(Setup, FlagsChangeSingleValues) {
  const Arguments lens{"LENS", "--size", "24x16"};
  const auto with = [&](Arguments more) {
    more.insert(more.end(), lens.begin(), lens.end());
    return more;
  };
  report("render", with({"--focus", "1m", "--blades", "5", "--model", "thin"}), "first");
  const json changed = report(
      "render",
      {"--setup", "@first.json", "--focus", "2m", "--f-number", "4", "--size", "12", "LENS:double_gauss_52mm_f1.8"},
      "changed");
  const json direct = report("render",
                             {"LENS:double_gauss_52mm_f1.8", "--focus", "2m", "--f-number", "4", "--blades", "5",
                              "--model", "thin", "--film", "36x24", "--size", "12"},
                             "direct");
  EXPECT_EQ(changed["setup"], direct["setup"]);
  EXPECT_EQ(pictures("changed"), pictures("direct"));
}

TEST_F(Setup, RefusesFaultsWithFileKeyAndValue) {
  report("render", {"LENS", "--focus", "1m", "--size", "8x8"}, "first");
  const json setup = read_json(path("first.json"))["setup"];
  const auto refused = [&](const char* pointer, const json& value, std::vector<petzval::testing::Token> tokens) {
    json bad = setup;
    bad[json::json_pointer(pointer)] = value;
    write("bad.json", bad.dump(1));
    tokens.push_back("bad.json:");
    expect_failure("render", {"--scene", "balls", "--setup", path("bad.json"), "--out", path("bad")}, tokens);
  };
  refused("/colour", 1, {"colour"});
  refused("/lens/thin_mm", 50, {"lens", 2});
  refused("/lens/file", "gone.zmx", {"file", "gone.zmx"});
  refused("/film/tilt_rad", 4, {"tilt_rad", 4});
  refused("/iris/blades", 2, {"iris.blades", 2});
  refused("/lens/wavelengths_nm", {5}, {"wavelengths_nm", 5});
  refused("/lens/wavelengths_nm", {1e6}, {"wavelengths_nm", 1e6});
  refused("/camera/model", "thinnest", {"model", "thinnest"});
  json unfocused = setup;
  unfocused.erase("focus_mm");
  write("unfocused.json", unfocused.dump());
  const Arguments line{"--scene", "balls", "--setup", path("unfocused.json"), "--spp", "1", "--out", path("out")};
  expect_failure("render", line, {"--setup", "unfocused.json", "focus_mm", "--focus"});
  expect_failure("render", {"--scene", "balls", "--setup", path("none.json"), "--out", path("out")}, {"none.json"});
  json stopped = setup;
  stopped["f_number"] = 4;
  write("stopped.json", stopped.dump());
  const auto given = [&](Arguments more, const std::vector<petzval::testing::Token>& tokens) {
    more.insert(more.end(), {"--scene", "balls", "--setup", path("stopped.json"), "--spp", "1", "--out", path("out")});
    expect_failure("render", more, tokens);
  };
  given({"--blades", "5", "--iris-area", "equal"}, {"--iris-area", "equal", "--f-number"});
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Setup, FlagsReplaceValuesThatFollowFromThem) {
  json setup =
      report("render", {"LENS", "--focus", "1m", "--size", "8x8", "--model", "thick", "--points", "@points.json"},
             "first")["setup"];
  setup["film"]["z_mm"] = 90;
  setup["lens"]["primary_nm"] = 600;
  write("at.json", setup.dump());
  const json far = report("render", {"--setup", "@at.json", "--focus", "inf", "--kind", "shepard"}, "far")["setup"];
  EXPECT_EQ(far["focal_surface"]["kind"], "shepard");
  EXPECT_NE(far["film"].value("z_mm", json()), 90);
  EXPECT_NE(far["lens"].value("primary_nm", json()), 600);
  EXPECT_NE(far["focal_surface"].value("default_inverse_distance", json()),
            setup["focal_surface"]["default_inverse_distance"]);
  for (const Arguments& change : {Arguments{"--criterion", "paraxial"}, Arguments{"--from", "film"}}) {
    const json moved = report("render", {"--setup", "@at.json", change[0], change[1]}, "moved")["setup"];
    EXPECT_FALSE(moved["film"].contains("z_mm")) << change[0];
  }
  const json wide = report("render", {"--setup", "@first.json", "--film", "36x18"}, "wide")["setup"]["film"];
  EXPECT_EQ(wide["rows"], 4);
}

TEST_F(Setup, MissingPartsHaveTheValuesOfTheCommand) {
  json setup = report("render", {"LENS", "--focus", "1m", "--size", "8x8"}, "first")["setup"];
  setup.erase("film"), setup.erase("camera");
  write("short.json", setup.dump());
  const json again = report("render", {"--setup", "@short.json", "--size", "8x4"}, "again")["setup"];
  const json usual = report("render", {"LENS", "--focus", "1m", "--size", "8x4"}, "usual")["setup"];
  EXPECT_EQ(again["camera"], usual["camera"]);
  EXPECT_EQ(again["film"], usual["film"]);
  setup["lens"]["file"] = "gone.json";
  write("gone.json.setup", setup.dump());
  report("render", {"--setup", "@gone.json.setup", "LENS", "--size", "8x8"}, "replaced");
}

#ifdef PETZVAL_TEST_HAS_blur
TEST_F(Setup, BlurredPictureIsMadeAgainToTheBit) {
  const auto thin = [](Arguments more) {
    more.insert(more.end(), {"--thin-lens", "50", "--f-number", "2", "--size", "24x16", "--focus", "3m"});
    return more;
  };
  expect_round_trip("blur",
                    {thin({}),
                     thin({"--fov", "37.7", "--tilt", "3", "--wavelengths", "rgb", "--weight-map", "@map.exr"}),
                     thin({"--points", "@points.json", "--dispersion", "2"}),
                     {"LENS", "--size", "24x16", "--focus", "3m", "--fov", "20", "--swing", "2"},
                     {"LENS", "--size", "24x16", "--focus", "3m", "--points", "@points.json", "--kind", "shepard"},
                     {"--singlet", "50,-50,5,N-BK7", "--size", "24x16", "--focus", "3m"}});
}

TEST_F(Setup, ThinLensOfBlurIsSharpInItsParaxialFocus) {
  report("blur", {"--thin-lens", "50", "--f-number", "2", "--size", "24x16", "--focus", "1m"}, "thin");
  const petzval::Camera camera = petzval::camera(petzval::camera_setup(read(path("thin.json")), "thin.json"));
  // Two rays of the middle of the film cross at the distance in focus.
  const auto ray = [&](double x) { return camera.sample({.film = {0, 0}, .pupil_u = x, .pupil_v = 0.5}).ray; };
  const auto one = ray(0.1), other = ray(0.9);
  const auto x_at = [](const auto& r, double z) {
    return r.origin.x + (z - r.origin.z) * r.direction.x / r.direction.z;
  };
  const double shift = x_at(one, -1000) - x_at(other, -1000), wide = x_at(one, 0) - x_at(other, 0);
  EXPECT_GT(std::abs(wide), 1);
  EXPECT_NEAR(shift / wide, 0, 1e-6);
  expect_failure("blur",
                 {"--thin-lens", "50", "--f-number", "2", "--blades", "5", "--iris-area", "equal", "--scene", "town",
                  "--focus", "1m", "--out", path("out")},
                 {"--iris-area", "--thin-lens"});
  for (const Arguments& lens : std::vector<Arguments>{{"LENS"}, {"--thin-lens", "50"}}) {
    Arguments both{"--setup", path("thin.json"), "--singlet", "50,-50,5,N-BK7", "--scene",
                   "town",    "--out",           path("out")};
    both.insert(both.end(), lens.begin(), lens.end());
    expect_failure("blur", expanded(both), {"--singlet", "LENS"});
  }
}

TEST_F(Setup, SetupOfOneCommandIsTakenByOthers) {
  const json rendered =
      report("render", {"LENS", "--size", "24x16", "--focus", "1500", "--f-number", "4", "--blades", "7"}, "rendered");
  const json blurred = report("blur", {"--setup", "@rendered.json"}, "blurred");
  const json point = report("psf", {"--setup", "@blurred.json"}, "point");
  const json again = report("render", {"--setup", "@point.json"}, "again");
  EXPECT_EQ(blurred["focus_mm"], 1500);
  EXPECT_EQ(blurred["columns"], 24);
  EXPECT_EQ(point["results"][0]["focus_mm"], 1500);
  EXPECT_EQ(again["setup"], rendered["setup"]);
  EXPECT_EQ(pictures("again"), pictures("rendered"));
}
#endif

TEST_F(Setup, PointSpreadFunctionIsMadeAgainToTheBit) {
  expect_round_trip(
      "psf", {{"LENS", "--focus", "1m"},
              {"LENS", "--focus", "2m", "--f-number", "4", "--blades", "5", "--wavelengths", "475,510,650", "--model",
               "thin_two_disc", "--iris-image", "@map.exr", "--criterion", "paraxial"}});
}

}  // namespace
