// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;

class BokehScene : public Programs {
 protected:
  using Arguments = std::vector<std::string>;

  /// A white floor under a sky with a lamp; the camera looks along -z.
  void SetUp() override {
    Programs::SetUp();
    write("scene.json", R"({"sky": [0.5, 0.5, 0.5], "camera": {"position_mm": [0, 50, 0], "look_at_mm": [0, 50, -1000]},
      "objects": [{"quad": {"corner_mm": [-500, 0, 0], "edge_u_mm": [1000, 0, 0], "edge_v_mm": [0, 0, -1500]},
                   "material": {"diffuse": [0.6, 0.5, 0.4]}},
                  {"sphere": {"centre_mm": [40, 60, -1200], "radius_mm": 10}, "emission": [9, 6, 3]},
                  {"sphere": {"centre_mm": [-60, 40, -900], "radius_mm": 40},
                   "material": {"varnish": {"diffuse": [0.1, 0.3, 0.1], "roughness": 0.2}}}]})");
  }
  /// Later values replace earlier values.
  Arguments arguments(const std::string& out, const Arguments& more = {}) const {
    Arguments all{"--scene",
                  path("scene.json"),
                  lens("double_gauss_100mm_f2_28deg"),
                  "--focus",
                  "1000",
                  "--size",
                  "72x48",
                  "--spp",
                  "20",
                  "--out",
                  path(out)};
    for (std::size_t i = 0; i < more.size(); ++i) {
      const auto at = std::find(all.begin(), all.end(), more[i]);
      const bool has_value = i + 1 < more.size() && more[i + 1].rfind("--", 0) != 0;
      if (at != all.end()) {
        *(at + 1) = more[i + 1];
      } else {
        all.push_back(more[i]);
        if (has_value) all.push_back(more[i + 1]);
      }
      i += has_value;
    }
    return all;
  }
  json render(const std::string& out, const Arguments& more = {}) const {
    const Outcome done = run("render", arguments(out, more));
    EXPECT_EQ(done.status, 0) << done.err;
    return read_json(path(out) + "/render.json");
  }
  static double mean(const json& report, int channel) { return report["mean_radiance"][channel]["mean"]; }
  static double error(const json& report, int channel) { return report["mean_radiance"][channel]["standard_error"]; }
};

TEST_F(BokehScene, WritesAPictureWithItsMetadata) {
  const json report = render("a", {"--format", "exr,png,pfm"});
  const auto part = petzval::read_exr_parts(path("a/picture.exr")).front();
  EXPECT_EQ(part.width, 72);
  EXPECT_EQ(part.texts.at("model"), "exact_float");
  EXPECT_NEAR(part.numbers.at("fNumber"), 2, 0.05);
  EXPECT_EQ(part.numbers.at("focusMm"), 1000);
  EXPECT_TRUE(std::filesystem::exists(path("a/picture.png")));
  EXPECT_TRUE(std::filesystem::exists(path("a/picture.pfm")));
  EXPECT_EQ(report["samples"], 20);
  EXPECT_EQ(report["rejected"], 0);
  const json tiles = read_json(path("a/tiles.json"));
  EXPECT_EQ(tiles["rows"], 3);
  EXPECT_EQ(tiles["mean"][0].size(), 5);
  EXPECT_GT(report["lens_seconds_share"], 0);
  EXPECT_GT(report["paths_per_second"], 0);
  // A pixel of the sky of radiance 0.5, in the column of the axis: the lens transmits most of the light.
  const petzval::RgbImage image = petzval::read_exr(path("a/picture.exr"));
  EXPECT_NEAR(static_cast<double>(image.pixel(36, 6)[1]), 0.45, 0.06);
}

TEST_F(BokehScene, ShardsAndResumedRunsEqualOneRunToTheBit) {
  render("whole", {"--threads", "1"});
  const std::string whole = read(path("whole/picture.exr"));
  render("threads", {"--threads", "3"});
  EXPECT_EQ(read(path("threads/picture.exr")), whole);

  const Outcome stopped = run("render", arguments("resumed", {"--time", "0.02"}));
  EXPECT_EQ(stopped.status, 0);
  EXPECT_NE(stopped.err.find("--resume"), std::string::npos) << stopped.err;
  EXPECT_FALSE(read_json(path("resumed/render.json"))["finished"]);
  EXPECT_NE(read(path("resumed/picture.exr")), whole);
  EXPECT_TRUE(render("resumed", {"--resume"})["finished"]);
  EXPECT_EQ(read(path("resumed/picture.exr")), whole);
  // All tiles receive light, in an unfinished image as well.
  const petzval::RgbImage image = petzval::read_exr(path("resumed/picture.exr"));
  EXPECT_GT(image.pixel(36, 45)[1], 0);
  const Outcome anew = run("render", arguments("resumed"));
  EXPECT_NE(anew.err.find("sums.before.exr"), std::string::npos) << anew.err;
  EXPECT_TRUE(std::filesystem::exists(path("resumed/sums.before.exr")));

  for (const char* tile : {"1/2", "2/2"}) {
    EXPECT_EQ(run("render", arguments("tiles", {"--shard", tile})).status, 0);
  }
  EXPECT_EQ(run("render", {"merge", path("tiles"), "--out", path("merged")}).status, 0);
  EXPECT_EQ(read(path("merged/picture.exr")), whole);
  EXPECT_NE(read(path("whole/picture.exr")), [&] {
    render("seed", {"--seed", "1"});
    return read(path("seed/picture.exr"));
  }());
}

// A finished image that gets more samples equals, bit by bit, an image rendered with all samples at once.
TEST_F(BokehScene, AddsSamplesToAFinishedPicture) {
  for (const char* integrator : {"path", "bidirectional"}) {
    const std::string at_once = std::string("once_") + integrator, grown = std::string("grown_") + integrator;
    render(at_once, {"--integrator", integrator, "--spp", "40"});
    for (const char* samples : {"3", "16", "40"}) {
      const json report = render(grown, {"--integrator", integrator, "--spp", samples, "--resume"});
      EXPECT_EQ(report["samples"], std::stoi(samples));
      EXPECT_TRUE(report["finished"]);
    }
    EXPECT_EQ(read(path(grown + "/picture.exr")), read(path(at_once + "/picture.exr"))) << integrator;
    EXPECT_EQ(read_json(path(grown + "/render.json"))["mean_radiance"],
              read_json(path(at_once + "/render.json"))["mean_radiance"]);
  }
  // A smaller --spp keeps the existing samples.
  const Outcome fewer = run("render", arguments("grown_path", {"--integrator", "path", "--spp", "4", "--resume"}));
  EXPECT_EQ(fewer.status, 0);
  EXPECT_NE(fewer.err.find("--spp = 4"), std::string::npos) << fewer.err;
  EXPECT_EQ(read(path("grown_path/picture.exr")), read(path("once_path/picture.exr")));
}

// Samples go to noisy tiles until the noise is reached; an interrupted picture continues to the same bits.
TEST_F(BokehScene, NoiseIsReachedWithUnequalSamples) {
  const Arguments noise{"--noise", "0.12", "--spp", "512"};
  const json report = render("whole", noise);
  EXPECT_TRUE(report["finished"]);
  EXPECT_LE(report["noise"]["largest"], 0.12);
  double least = 1e9, most = 0;
  const json tiles = read_json(path("whole/tiles.json"));
  for (const json& row : tiles["samples"]) {
    for (const json& samples : row) least = std::min<double>(least, samples), most = std::max<double>(most, samples);
  }
  EXPECT_GE(least, 32);
  EXPECT_GT(most, least);
  EXPECT_LT(most, 512);
  Arguments timed = noise;
  timed.insert(timed.end(), {"--time", "0.02"});
  EXPECT_FALSE(render("parts", timed)["finished"]);
  Arguments resumed = noise;
  resumed.push_back("--resume");
  EXPECT_TRUE(render("parts", resumed)["finished"]);
  EXPECT_EQ(read(path("parts/picture.exr")), read(path("whole/picture.exr")));
  // Hero wavelengths of a path reach tiles with other numbers of samples.
  const json hero = render("hero", {"--wavelengths", "hero", "--noise", "0.3", "--spp", "256"}),
             uniform = render("uniform", {"--wavelengths", "hero"});
  EXPECT_NEAR(mean(hero, 1), mean(uniform, 1), 5 * std::hypot(error(hero, 1), error(uniform, 1)));
  expect_failure("render", arguments("shard", {"--noise", "0.12", "--shard", "1/2"}), {"--noise", "1/2"});
}

TEST_F(BokehScene, WavelengthsAreAModeOrOneWavelength) {
  const Arguments small{"--size", "36x24", "--spp", "16"};
  const auto with = [&](const std::string& wavelengths) {
    return Arguments{"--size", "36x24", "--spp", "16", "--wavelengths", wavelengths};
  };
  const json line = render("line", with("F")), number = render("number", with("486.1327"));
  EXPECT_NEAR(mean(line, 1), mean(number, 1), 1e-3 * mean(line, 1));
  EXPECT_NEAR(mean(line, 1), mean(render("d", small), 1), 0.1 * mean(line, 1));
  render("hero", with("hero")), render("visible", with("visible"));
  EXPECT_EQ(read(path("hero/picture.exr")), read(path("visible/picture.exr")));
  for (const char* bad : {"F,d", "blue", "-3"}) {
    expect_failure("render", arguments("bad", with(bad)), {"--wavelengths", bad, "rgb, hero, visible"});
  }
}

// An interrupt writes the sums and the unfinished image; --resume gives the bits of an uninterrupted run.
TEST_F(BokehScene, InterruptedRunKeepsItsSamples) {
  const Arguments many{"--spp", "400", "--threads", "1"};
  std::string command = invocation("render");
  for (const std::string& argument : arguments("cut", many)) command += " '" + argument + "'";
  write("interrupt.sh", command + " > '" + path("said") + "' 2> '" + path("err") + "' & pid=$!\nwhile [ ! -d '" +
                            path("cut") +
                            "' ] && kill -0 $pid; do :; done 2> /dev/null\n"
                            "sleep 0.3\nkill -TERM $pid\nwait $pid\nexit $?\n");
  const int status = std::system(("sh '" + path("interrupt.sh") + "'").c_str());
  EXPECT_TRUE(std::filesystem::exists(path("cut/sums.exr")));
  EXPECT_TRUE(std::filesystem::exists(path("cut/picture.png")));
  if (!read_json(path("cut/render.json"))["finished"]) {
    EXPECT_EQ(WEXITSTATUS(status), 130);
    EXPECT_NE(read(path("err")).find("--resume"), std::string::npos) << read(path("err"));
  }
  render("cut", {"--spp", "400", "--threads", "1", "--resume"});
  render("whole", many);
  EXPECT_EQ(read(path("cut/picture.exr")), read(path("whole/picture.exr")));
}

// Without --film the film has the shape of the picture; without --height the picture has the shape of the film.
TEST_F(BokehScene, PixelsAreSquareByDefault) {
  const auto shape = [&](const std::string& out, const Arguments& more) {
    Arguments all{"--scene", path("scene.json"), lens("double_gauss_100mm_f2_28deg"), "--focus", "1000", "--spp", "1",
                  "--out",   path(out)};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome outcome = run("render", all);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json film = read_json(path(out) + "/render.json")["setup"]["film"];
    return std::tuple(film["width_mm"].get<double>(), film["height_mm"].get<double>(), film["columns"].get<int>(),
                      film["rows"].get<int>(), outcome.err);
  };
  EXPECT_EQ(shape("wide", {"--size", "96x54"}), std::tuple(36, 20.25, 96, 54, ""));
  EXPECT_EQ(shape("tall", {"--size", "48x96"}), std::tuple(18, 36, 48, 96, ""));
  EXPECT_EQ(shape("square", {"--size", "48x48"}), std::tuple(24, 24, 48, 48, ""));
  EXPECT_EQ(shape("usual", {"--size", "90"}), std::tuple(36, 24, 90, 60, ""));
  EXPECT_EQ(shape("film", {"--size", "96", "--film", "24x9"}), std::tuple(24, 9, 96, 36, ""));
  const auto [width, height, columns, rows, note] = shape("egg", {"--size", "96x54", "--film", "36x24"});
  EXPECT_EQ(std::pair(width, height), std::pair(36.0, 24.0));
  for (const char* flag : {"--film", "--size"}) EXPECT_NE(note.find(flag), std::string::npos) << note;
}

TEST_F(BokehScene, ChoosesAModelWithReasons) {
  const json rough = render("rough", {"--model", "auto", "--spp", "1"});
  const json fine = render("fine", {"--model", "auto", "--budget", "0.01", "--spp", "1"});
  EXPECT_GE(rough["why"].size(), 2);
  const Outcome again = run("render", arguments("rough", {"--model", "auto", "--spp", "1", "--resume"}));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(read_json(path("rough/render.json"))["model"], rough["model"]);
  EXPECT_NE(rough["model"], fine["model"]);
  EXPECT_NE(fine["why"].dump().find("0.01"), std::string::npos);
  // With more samples there is less noise, so that less bias is allowed.
  const json clean = render("clean", {"--model", "auto", "--spp", "16000000", "--time", "0.01"});
  EXPECT_NE(clean["model"], "pinhole");
  EXPECT_NE(clean["model"], "thin");
}

TEST_F(BokehScene, NormalisationScalesTheImageAndKeepsThePng) {
  const json unity = render("unity"), irradiance = render("irradiance", {"--normalisation", "irradiance"});
  EXPECT_NEAR(mean(irradiance, 1) / mean(unity, 1), irradiance["job"]["white"].get<double>(), 1e-3);
  const std::string a = read(path("unity/picture.png")), b = read(path("irradiance/picture.png"));
  EXPECT_NEAR(static_cast<double>(a.size()), static_cast<double>(b.size()), 0.02 * static_cast<double>(a.size()));
}

// An uncoated lens passes the same part of the light in the picture and on the axis, here within the changes over the
// field, in all models.
TEST_F(BokehScene, CoatingsScaleTheIrradiance) {
  for (const char* model : {"exact_float", "thick"}) {
    const auto with = [&](const char* name, const Arguments& more) {
      Arguments all{"--model", model, "--normalisation", "irradiance"};
      all.insert(all.end(), more.begin(), more.end());
      return render(name, all);
    };
    const json whole = with("whole", {}), bare = with("bare", {"--coatings", "none"});
    const double part = bare["job"]["white"].get<double>() / whole["job"]["white"].get<double>();
    EXPECT_GT(part, 0.4) << model;
    EXPECT_LT(part, 0.8) << model;
    EXPECT_NEAR(mean(bare, 1) / mean(whole, 1), part, 0.02) << model;
  }
  expect_failure("render", arguments("file", {"--coatings", "file"}), {"--coatings", "file"});
}

TEST_F(BokehScene, ExposureScalesOnlyThePng) {
  const Arguments small{"--size", "36x24", "--spp", "2"};
  render("usual", small), render("bright", {"--size", "36x24", "--spp", "2", "--exposure", "2"});
  EXPECT_EQ(read(path("usual/picture.exr")), read(path("bright/picture.exr")));
  const petzval::RgbImage usual = petzval::read_png(path("usual/picture.png")),
                          bright = petzval::read_png(path("bright/picture.png"));
  for (std::size_t i = 0; i < usual.pixels.size(); ++i) {
    EXPECT_NEAR(bright.pixels[i], std::min(2 * usual.pixels[i], 1.0f), 0.02f);
  }
}

TEST_F(BokehScene, RefusesOtherAndDamagedCheckpoints) {
  render("a");
  expect_failure("render", arguments("a", {"--resume", "--seed", "4"}), {"seed", 0, 4});
  const std::string whole = read(path("a/sums.exr"));
  write("a/sums.exr", whole.substr(0, whole.size() / 2));
  expect_failure("render", arguments("a", {"--resume"}), {"sums.exr"});
  EXPECT_EQ(read(path("a/sums.exr")).size(), whole.size() / 2);  // nothing is lost
  EXPECT_EQ(run("render", arguments("b", {"--shard", "1/2"})).status, 0);
  expect_failure("render", {"merge", path("b"), "--out", path("c")}, {"2/2"});
}

// A focal surface and aberrations change the image but not the exposure; a sphere that contains a key point is sharper
// with the focal surface.
TEST_F(BokehScene, AcceptsFocalSurfacesAndAberrations) {
  write("points.json", R"({"points": [{"world_mm": [40, 60, -1200]}, {"world_mm": [-60, 40, -900], "extent_stops": 1},
    {"pixel": [36, 2], "distance_mm": null}, {"pixel": [36, 46], "distance_mm": 700, "blur_px": 2, "weight": 0.5}]})");
  const Arguments thick{"--model", "thick", "--integrator", "path", "--focus", "3000"};
  const auto with = [&](Arguments more) {
    more.insert(more.begin(), thick.begin(), thick.end());
    return more;
  };
  const json plain = render("plain", thick), surface = render("surface", with({"--points", path("points.json")})),
             lens = render("lens", with({"--power-spline", "0:1", "1:1.05", "--dispersion", "1"}));
  // Pixels that the small lamp lights.
  const auto lit = [&](const std::string& out) {
    std::ptrdiff_t count = 0;
    for (const auto& part : petzval::read_exr_parts(path(out + "/picture.exr"))) {
      for (const auto& [channel, values] : part.channels) {
        if (channel == "R") count += std::count_if(values.begin(), values.end(), [](float v) { return v > 1.5f; });
      }
    }
    return count;
  };
  EXPECT_GT(lit("surface"), 5);
  EXPECT_LT(lit("surface"), 0.6 * static_cast<double>(lit("plain")));
  for (const json& report : {surface, lens}) {
    EXPECT_NEAR(mean(report, 0), mean(plain, 0), 5 * std::hypot(error(report, 0), error(plain, 0)));
  }
  // Light tracing gives the same image.
  const json light = render("light", with({"--points", path("points.json"), "--integrator", "bidirectional"}));
  EXPECT_NEAR(mean(light, 0), mean(surface, 0), 5 * std::hypot(error(light, 0), error(surface, 0)));
}

TEST_F(BokehScene, FocusPull_FramesEqualStills) {
  const Arguments few{"--size", "36x24", "--spp", "2"};
  const auto with = [&](Arguments more) {
    more.insert(more.end(), few.begin(), few.end());
    return more;
  };
  expect_failure("render", arguments("pull", {"--focus", "1m:inf"}), {"--focus", "--frames"});
  expect_failure("render", arguments("pull", {"--frames", "2"}), {"--frames", "--focus"});
  const Outcome done = run("render", arguments("pull", with({"--focus", "1m:inf", "--frames", "3"})));
  ASSERT_EQ(done.status, 0) << done.err;
  for (const auto& [frame, distance] : {std::pair{"1", "1m"}, {"2", "2m"}, {"3", "inf"}}) {
    const json still = render("still", with({"--focus", distance}));
    const std::string of_frame = path(std::string("pull/frame_000") + frame);
    for (const char* key : {"setup", "job"}) EXPECT_EQ(read_json(of_frame + "/render.json")[key], still[key]);
    EXPECT_EQ(petzval::read_exr_parts(of_frame + "/picture.exr").front().channels,
              petzval::read_exr_parts(path("still/picture.exr")).front().channels);
    std::filesystem::remove_all(path("still"));
  }
}

// An oblique plane covers the left half of the picture and crosses the axis 1000 mm in front of the entrance pupil.
TEST_F(BokehScene, GuidesOfAPlaneAreItsAlbedoNormalAndDepth) {
  write("plane.json", R"({"sky": [0.5, 0.5, 0.5], "objects": [{"quad": {"corner_mm": [-400, -240, -1320],
    "edge_u_mm": [400, 0, 0], "edge_v_mm": [0, 480, 640]}, "material": {"varnish": {"diffuse": [0.1, 0.3, 0.6]}}}]})");
  render("plane", {"--scene", path("plane.json"), "--model", "thin", "--f-number", "8", "--spp", "1"});
  const petzval::ExrPart part = petzval::read_exr_parts(path("plane/picture.exr")).front();
  const auto value = [&](const std::string& name, std::size_t x, std::size_t y) {
    for (const auto& [channel, values] : part.channels) {
      if (channel == name) return static_cast<double>(values[y * 72 + x]);
    }
    return std::nan("");
  };
  const double pupil = 1000 - (value("depth.Z", 20, 23) + value("depth.Z", 20, 24)) / 2;  // behind the front vertex
  EXPECT_GT(pupil, 20);
  EXPECT_LT(pupil, 80);
  for (std::size_t y = 2; y < 46; ++y) {
    for (const std::size_t x : {3u, 20u, 30u}) {
      EXPECT_NEAR(value("albedo.R", x, y), 0.1, 1e-6);
      EXPECT_NEAR(value("albedo.B", x, y), 0.6, 1e-6);
      EXPECT_NEAR(value("normal.X", x, y), 0, 1e-6);
      EXPECT_NEAR(std::abs(value("normal.Y", x, y)), 0.8, 1e-5);
      EXPECT_NEAR(value("normal.Z", x, y), 0.6, 1e-5);
      // A ray through the pupil with a tangent meets the plane, whose slope is 4 / 3.
      const double tangent = (23.5 - static_cast<double>(y)) * 0.5 / 111;
      EXPECT_NEAR(value("depth.Z", x, y) + pupil, 1000 / (1 + tangent * 4 / 3), 6) << y;
    }
    for (const char* channel : {"albedo.R", "albedo.G", "normal.Y", "normal.Z"}) EXPECT_EQ(value(channel, 60, y), 0);
    EXPECT_TRUE(std::isinf(value("depth.Z", 60, y)));
  }
}

TEST_F(BokehScene, PicturesAreLaidOutOnSheets) {
  render("a"), render("b", {"--focus", "1500"});
  const Outcome done =
      run("sheet", {path("a"), path("b"), "--columns", "2", "--out", path("sheet.svg"), "--balls", path("balls.csv")});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_GE(pictures_in(path("sheet.svg")), 2u);
  EXPECT_NE(read(path("sheet.svg")).find(">focus 1500 mm"), std::string::npos);
  EXPECT_TRUE(read(path("balls.csv")).starts_with("lens,focus_mm,x_mm,"));
  for (const char* wrong : {"c.jpg", "c.png"}) {
    expect_failure("sheet", {path("a"), "--out", path(wrong)}, {wrong, ".svg"});
  }
  expect_failure("sheet", {path("nothing"), "--out", path("c.svg")}, {"nothing"});
  write("a/render.json", "{}");
  expect_failure("sheet", {path("a"), "--out", path("c.svg")}, {"render.json"});
}

TEST_F(BokehScene, SheetsTakePictureFilesOfAnySize) {
  render("a"), render("small", {"--size", "36x24"});
  write("a & b \xff.exr", read(path("a/picture.exr")));
  const Outcome done = run("sheet", {path("a"), path("small"), path("a/picture.png"), path("a & b \xff.exr"),
                                     "--columns", "3", "--out", path("sheet.svg")});
  EXPECT_EQ(done.status, 0) << done.err;
  const std::string svg = read(path("sheet.svg"));
  EXPECT_EQ(pictures_in(path("sheet.svg")), 4u);
  for (const char* name : {">picture.png<", ">a &amp; b \xEF\xBF\xBD.exr<"}) {
    EXPECT_NE(svg.find(name), std::string::npos) << name;
  }
  expect_failure("sheet", {path("a/picture.png"), "--out", path("c.svg"), "--balls", path("balls.csv")},
                 {"--balls", "picture.png", "folder"});
  expect_failure("sheet", {path("a/render.json"), "--out", path("c.svg")}, {"render.json", ".png", ".exr"});
}

}  // namespace
