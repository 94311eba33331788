// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using petzval::RgbImage;

const Arguments thin{"--thin-lens", "50", "--f-number", "0.5"};
const Arguments small{"--size", "80x60", "--rays", "16", "--threads", "1"};

Arguments joined(std::initializer_list<Arguments> lists) {
  Arguments all;
  for (const Arguments& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

class LensBlurProgram : public Programs {
 protected:
  json blur(const Arguments& arguments, const std::string& out = "out") const {
    const auto outcome = run("blur", joined({arguments, {"--format", "pfm", "--out", path(out)}}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? read_json(path(out + "/blur.json")) : json();
  }
  RgbImage picture(const std::string& name) const { return petzval::read_pfm(path(name)); }

  /// An image of 24 x 16 different pixels, and a depth for each pixel.
  void write_files(double left_mm, double right_mm) const {
    RgbImage image(24, 16);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i * 7 % 64) / 32;
    petzval::write_pfm(image, path("rgb.pfm"));
    std::vector<float> depths(24 * 16);
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = static_cast<float>(i % 24 < 12 ? left_mm : right_mm);
    petzval::write_pfm(24, 16, depths, path("depth.pfm"));
  }
  static Arguments real() { return {lens("double_gauss_52mm_f1.8"), "--scene", "town", "--supersample", "1"}; }
  Arguments files() const { return {"--image", path("rgb.pfm"), "--depth", path("depth.pfm")}; }
};

TEST_F(LensBlurProgram, WritesPicturesAndTheirMeasures) {
  const auto outcome = run("blur", joined({thin,
                                           small,
                                           {"--scene", "town", "--focus", "5000", "--compare", "--supersample", "1",
                                            "--format", "exr,png,pfm", "--out", path("out")}}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name : {"blur", "sharp", "missed", "reference"}) {
    const RgbImage exr = petzval::read_exr(path(std::string("out/") + name + ".exr"));
    EXPECT_EQ(exr.width, 80);
    EXPECT_EQ(exr.height, 60);
    EXPECT_EQ(exr.pixels, picture(std::string("out/") + name + ".pfm").pixels);
    EXPECT_TRUE(read(path(std::string("out/") + name + ".png")).starts_with("\x89PNG"));
  }
  const json result = read_json(path("out/blur.json"));
  for (const char* key : {"peel_ms", "nbuffer_ms", "gather_ms", "total_ms", "reference_ms", "psnr_db", "ssim",
                          "psnr_edges_db", "ssim_edges", "flip_mean", "flip_p99", "miss_rate", "layers", "rays"}) {
    EXPECT_TRUE(result[key].is_number()) << key;
  }
  EXPECT_EQ(result["rays"], 16);
  const double pixels = (80 + 2 * result["overscan_px"].get<double>()) * (60 + 2 * result["overscan_px"].get<double>());
  EXPECT_GT(result["memory_mb"].get<double>(), 12e-6 * pixels * result["layers"].get<double>());
  EXPECT_LT(result["memory_mb"].get<double>(), 60e-6 * pixels + 0.01);
  EXPECT_LE(result["layers"], 4);
  EXPECT_GT(result["psnr_db"], 22);                       // a coarse image is not smooth
  EXPECT_LT(result["psnr_edges_db"], result["psnr_db"]);  // depth edges are the difficult part
  EXPECT_GT(result["ssim"], 0.75);
  EXPECT_LT(result["flip_mean"], 0.2);
  EXPECT_LT(std::abs(result["energy_drift"].get<double>()), 0.01);
  EXPECT_NE(picture("out/sharp.pfm").pixels, picture("out/blur.pfm").pixels);
}

TEST_F(LensBlurProgram, KeepsTheEnergyOfSmallLights) {
  const json result = blur({"--scene", "street", "--thin-lens", "50", "--f-number", "2.8", "--focus", "5000", "--size",
                            "400x300", "--rays", "32", "--highlights-above", "0", "--compare"});
  EXPECT_LT(std::abs(result["energy_drift"].get<double>()), 0.01);
}

TEST_F(LensBlurProgram, PlaneInFocusIsUnchanged) {
  write_files(2000, 2000);
  const json result = blur(joined({files(), thin, {"--focus", "2000", "--highlights-above", "0"}}));
  const RgbImage given = picture("rgb.pfm"), blurred = picture("out/blur.pfm");
  ASSERT_EQ(given.pixels.size(), blurred.pixels.size());
  for (std::size_t i = 0; i < given.pixels.size(); ++i) EXPECT_NEAR(given.pixels[i], blurred.pixels[i], 1e-5);
  EXPECT_EQ(given.pixels, picture("out/sharp.pfm").pixels);
  EXPECT_EQ(result["miss_rate"], 0);
  EXPECT_EQ(result["layers"], 1);
}

TEST_F(LensBlurProgram, LayersAndDeepImagesGiveEqualPictures) {
  // A near half plane in front of a plane of another colour, as parts of an EXR and as lists; the files contain the
  // hidden part of the plane.
  petzval::FragmentLists lists{.columns = 24, .rows = 16, .offsets = {0}, .fragments = {}};
  std::vector<petzval::ExrPart> parts;
  for (const char* name : {"near", "far"}) {
    parts.push_back({.name = name, .width = 24, .height = 16, .channels = {}});
    for (const char* channel : {"B", "G", "R", "Z"}) parts.back().channels[channel].resize(384);
  }
  for (std::size_t i = 0; i < 384; ++i) {
    const auto put = [&](std::size_t part, float depth, float value) {
      for (const char* channel : {"B", "G", "R"}) parts[part].channels[channel][i] = value;
      parts[part].channels["Z"][i] = depth;
      lists.fragments.push_back({depth, value, value, value, 1});
    };
    // A part without a surface at a pixel has the depth 0.
    if (i % 24 < 12) put(0, 1000, 0.75f);
    put(1, 4000, static_cast<float>(i % 5) / 4);
    lists.offsets.push_back(lists.fragments.size());
  }
  petzval::write_exr(parts, path("layers.exr"));
  petzval::write_deep_exr(lists, path("deep.exr"));
  const Arguments lens = joined({thin, {"--focus", "2000", "--rays", "32"}});
  const json from_layers = blur(joined({lens, {"--image", path("layers.exr")}}), "layers");
  const json from_deep = blur(joined({lens, {"--deep", path("deep.exr")}}), "deep");
  EXPECT_EQ(from_layers["layers"], 2);
  EXPECT_EQ(from_deep["layers"], 2);
  EXPECT_EQ(picture("layers/blur.pfm").pixels, picture("deep/blur.pfm").pixels);
  EXPECT_EQ(from_deep["miss_rate"], 0);
}

TEST_F(LensBlurProgram, PictureAndItsHoldoutAddUpToTheWhole) {
  // Fog in front of half a wall, and a pane within the fog.
  petzval::FragmentLists wall{24, 16, {0}, {}}, pane = wall, whole = wall;
  for (std::size_t i = 0; i < 384; ++i) {
    const auto put = [&](petzval::FragmentLists& lists, const petzval::FragmentLists::Fragment& f) {
      lists.fragments.push_back(f), whole.fragments.push_back(f);
    };
    put(wall, {1000, 0.2f, 0.3f, 0.4f, 0.5f, 3000});
    if (i % 24 > 4) put(wall, {4000, static_cast<float>(i % 5) / 4, 0.5f, 0.25f, 1});
    if (i % 24 < 12) put(pane, {1500, 0.1f, 0.2f, 0, 0.75f});
    for (petzval::FragmentLists* lists : {&wall, &pane, &whole}) lists->offsets.push_back(lists->fragments.size());
  }
  write_deep_exr(wall, path("wall")), write_deep_exr(pane, path("pane")), write_deep_exr(whole, path("whole"));
  const Arguments lens = joined({thin, {"--focus", "2000", "--rays", "32", "--highlights-above", "0"}});
  const auto blurred = [&](const Arguments& arguments) {
    EXPECT_EQ(run("blur", joined({lens, {"--format", "exr", "--out", path("out"), "--deep"}, arguments})).status, 0);
    return petzval::read_exr_parts(path("out/blur.exr"))[0].channels;
  };
  const auto held_wall = blurred({path("wall"), "--holdout", path("pane"), "--deep-out", path("held.exr")}),
             held_pane = blurred({path("pane"), "--holdout", path("wall")}), all = blurred({path("whole")});
  for (const char* channel : {"R", "G", "B", "A"}) {
    for (std::size_t i = 0; i < 384; ++i)
      EXPECT_NEAR(held_wall.at(channel)[i] + held_pane.at(channel)[i], all.at(channel)[i], 1e-4);
  }
  EXPECT_EQ(petzval::read_deep_exr(path("held.exr")).lists.offsets, petzval::hold_out(wall, pane).offsets);

  // Nothing is written if the input does not fit, or if a file would be lost.
  petzval::write_deep_exr({1, 1, {0, 1}, {{1000}}}, path("other"));
  petzval::FragmentLists bright = wall;
  bright.fragments[7].alpha = 1.5f;
  petzval::write_deep_exr(bright, path("bright")), petzval::write_deep_exr({2, 1, {0, 0, 0}, {}}, path("empty"));
  struct Wrong {
    Arguments arguments;
    std::vector<std::string> words;
  };
  for (const auto& [wrong, words] : {
           Wrong{{path("wall"), "--holdout", path("other")}, {path("other"), "24 x 16"}},
           Wrong{{path("wall"), "--part", "depth"}, {"depth"}},
           Wrong{{path("wall"), "--holdout", ""}, {"--holdout", "\"\""}},
           Wrong{{path("bright")}, {path("bright"), "column 6, row 0", "alpha"}},
           Wrong{{path("wall"), "--holdout", path("bright"), "--supersample", "2"},
                 {path("bright"), "column 6, row 0"}},
           Wrong{{path("empty")}, {path("empty"), "depth"}},
           Wrong{{path("wall"), "--supersample", "2", "--deep-out", path("fine.exr")}, {"--deep-out", "2"}},
           Wrong{{path("wall"), "--deep-out", path("no/blur.exr")}, {path("no/blur.exr")}},
       }) {
    const auto outcome = run("blur", joined({lens, {"--format", "exr", "--out", path("no"), "--deep"}, wrong}));
    EXPECT_NE(outcome.status, 0) << wrong.back();
    for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path("no/blur.exr")) || std::filesystem::exists(path("fine.exr")));
  }
  std::filesystem::copy_file(path("wall"), path("out/sharp.exr"), std::filesystem::copy_options::overwrite_existing);
  const auto own =
      run("blur", joined({lens, {"--format", "exr", "--deep", path("out/sharp.exr"), "--out", path("out")}}));
  EXPECT_NE(own.err.find("sharp.exr"), std::string::npos) << own.err;
  EXPECT_EQ(petzval::read_deep_exr(path("out/sharp.exr")).lists.offsets, wall.offsets);

  // sharp.exr is what a pinhole sees: the limit of small apertures.
  EXPECT_EQ(run("blur", {"--thin-lens", "50", "--f-number", "1000", "--focus", "2000", "--format", "exr", "--deep",
                         path("whole"), "--out", path("small")})
                .status,
            0);
  const auto blur_of = petzval::read_exr_parts(path("small/blur.exr"))[0].channels,
             sharp = petzval::read_exr_parts(path("small/sharp.exr"))[0].channels;
  for (std::size_t i = 0; i < 384; ++i) EXPECT_NEAR(blur_of.at("R")[i], sharp.at("R")[i], 2e-3) << i;
}

TEST_F(LensBlurProgram, FollowsKeysOverFrames) {
  // The focus goes from the stall, 5 m away, to 2 m.
  write("keys.json", R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -5000]},
    {"time_s": 1, "position_mm": [0, 0, -2000]}]}])");
  const Arguments town = joined({thin, small, {"--scene", "town", "--focus", "5000"}});
  const json result = blur(joined({town, {"--frames", "3", "--fps", "2", "--points", path("keys.json")}}), "frames");
  ASSERT_EQ(result["frames"].size(), 3u);
  EXPECT_EQ(pictures_in(path("frames/frames.svg")), 3u);
  const RgbImage first = picture("frames/blur_0001.pfm"), last = picture("frames/blur_0003.pfm");
  EXPECT_NE(first.pixels, last.pixels);
  // The frames equal frames of fixed lenses.
  const auto difference = [](const RgbImage& a, const RgbImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += static_cast<double>(std::abs(a.pixels[i] - b.pixels[i]));
    return sum / static_cast<double>(a.pixels.size());
  };
  blur(town, "still");
  EXPECT_LT(difference(first, picture("still/blur.pfm")), 1e-3);
  blur(joined({thin, small, {"--scene", "town", "--focus", "2000"}}), "near");
  EXPECT_LT(difference(last, picture("near/blur.pfm")), 1e-3);
  EXPECT_GT(difference(first, last), 1e-2);
}

TEST_F(LensBlurProgram, PointsOfTheWorld_OneFrameAndSeveral_AreTheSame) {
  write("points.json", R"([{"world_mm": [100, -500, -11000]}, {"world_mm": [-500, 1000, -8000]}])");
  const Arguments miniature =
      joined({thin, small, {"--scene", "miniature", "--focus", "9m", "--points", path("points.json")}});
  blur(miniature, "still");
  blur(joined({miniature, {"--frames", "2"}}), "frames");
  EXPECT_EQ(picture("frames/blur_0002.pfm").pixels, picture("still/blur.pfm").pixels);
  write("points.json", R"([{"position_mm": [0, 0, -5000]}, {"position_mm": [-2600, 6000, 9000]}])");
  expect_failure("blur", joined({miniature, {"--frames", "2", "--out", path("out")}}), {"points.json", "point 2"});
}

TEST_F(LensBlurProgram, Frames_StillPixels_DoNotFlicker) {
  write("keys.json", R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -5000]},
    {"time_s": 1, "position_mm": [0, 0, -2000]}]}])");
  const Arguments lens{"--thin-lens", "50", "--f-number", "1", "--size", "80x60", "--rays", "100", "--compare"};
  for (const Arguments& moving : {Arguments{"--focus", "2m:6m"}, Arguments{"--focus", "3m", "--travel", "20"},
                                  Arguments{"--focus", "5m", "--points", path("keys.json")}}) {
    for (const char* scene : {"town", "street"}) {
      const Arguments frames = joined({lens, moving, {"--scene", scene, "--frames", "3"}});
      const json result = blur(joined({frames, {"--threads", "1"}}));
      EXPECT_LT(result["still_change"].get<double>(), 0.002) << scene << moving.back();
      for (const json& frame : result["frames"]) {
        EXPECT_EQ(frame["highlights_above"], result["frames"][0]["highlights_above"]);
      }
    }
  }
  blur(joined({lens, {"--scene", "street", "--focus", "2m:6m", "--frames", "3", "--threads", "2"}}), "two");
  blur(joined({lens, {"--scene", "street", "--focus", "2m:6m", "--frames", "3", "--threads", "1"}}), "one");
  EXPECT_EQ(picture("one/blur_0003.pfm").pixels, picture("two/blur_0003.pfm").pixels);
}

TEST_F(LensBlurProgram, FocusPull_FileOfKeys_FollowsItsTimes) {
  write("keys.json", R"({"keys": [{"time_s": 3, "distance_mm": 2000}, {"time_s": 5, "distance_mm": null}]})");
  const Arguments town = joined({thin, small, {"--scene", "town", "--focus", path("keys.json")}});
  const auto distances = [](const json& result) {
    std::vector<double> list;
    for (const json& frame : result["frames"])
      list.push_back(frame["focus_mm"].is_null() ? 0 : frame["focus_mm"].get<double>());
    return list;
  };
  EXPECT_EQ(distances(blur(joined({town, {"--fps", "1"}}))), (std::vector<double>{2000, 4000, 0}));
  EXPECT_EQ(distances(blur(joined({town, {"--fps", "1", "--frames", "2"}}))), (std::vector<double>{2000, 4000}));
}

TEST_F(LensBlurProgram, FocusPull_WithoutFramesOrWithPoints_IsRefused) {
  write("points.json", R"([{"pixel": [40, 30], "distance_mm": 2000}])");
  write("keys.json", R"({"distance_from": "film", "keys": [{"time_s": 0, "distance_mm": 2000}]})");
  const auto refused = [&](const Arguments& arguments, const std::vector<petzval::testing::Token>& tokens) {
    expect_failure("blur", joined({thin, small, {"--scene", "town", "--out", path("out")}, arguments}), tokens);
  };
  refused({"--focus", "2m:4m"}, {"--focus", "2m:4m", "--frames"});
  refused({"--focus", "2m:-4m", "--frames", "2"}, {"--focus", "-4m"});
  refused({"--focus", "2m:4m", "--frames", "2", "--points", path("points.json")}, {"--focus", "--points"});
  blur(joined({thin, small, {"--scene", "town", "--focus", "2m", "--points", path("points.json")}}), "still");
  expect_failure("blur",
                 {"--setup", path("still/blur.json"), "--scene", "town", "--focus", "2m:4m", "--frames", "2", "--out",
                  path("out")},
                 {"--focus", "blur.json"});
  refused({"--focus", path("keys.json")}, {"keys.json", "film", "--from", "front_vertex"});
  refused({"--focus", "2m", "--points", path("keys.json")}, {"keys.json", "--focus"});
  write("keys.json", R"({"keys": [{"time_s": 1, "distance_mm": 2000}, {"time_s": 1, "distance_mm": 3000}]})");
  refused({"--focus", path("keys.json")}, {"keys.json", "key", 2, "time_s"});
  write("keys.json", R"({"keys": [{"time_s": 1, "distance_mm": -2000}]})");
  refused({"--focus", path("keys.json")}, {"keys.json", "key", 1, "distance_mm", -2000});
}

TEST_F(LensBlurProgram, FocalSurface_RealLens_NamesItsModel) {
  write("points.json", R"([{"pixel": [40, 30], "distance_mm": 2000}])");
  const auto outcome = run(
      "blur", joined({small,
                      real(),
                      {"--focus", "2m", "--points", path("points.json"), "--format", "png", "--out", path("out")}}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_json(path("out/blur.json"))["model"], "thick");
  petzval::testing::expect_tokens(outcome.err, {"note", "focal surface", "thick"});
}

TEST_F(LensBlurProgram, DepthsInMetres_WithTheirUnit_EqualMillimetres) {
  const Arguments lens = joined({thin, {"--focus", "2000", "--rays", "16"}});
  write_files(1000, 2000);
  blur(joined({lens, files()}), "mm");
  write_files(1, 2);
  blur(joined({lens, files(), {"--depth-unit", "m"}}), "m");
  EXPECT_EQ(picture("mm/blur.pfm").pixels, picture("m/blur.pfm").pixels);
  write_files(1, 0.5);
  blur(joined({lens, files(), {"--depth-kind", "inverse", "--depth-unit", "m"}}), "inverse");
  EXPECT_EQ(picture("mm/blur.pfm").pixels, picture("inverse/blur.pfm").pixels);
}

TEST_F(LensBlurProgram, DepthsBelowTheFocalLength_AreAskedFor) {
  write_files(0.01, 20);
  for (const Arguments& unit : {Arguments{}, Arguments{"--depth-unit", "mm"}}) {
    const auto outcome = run("blur", joined({thin, files(), unit, {"--focus", "2m", "--out", path("out")}}));
    EXPECT_EQ(outcome.status, 1);
    petzval::testing::expect_tokens(outcome.err, {"depth.pfm", 0.01, "focal", 50});
    for (const char* inside : {"gather", "layers", "PeelPlan", "rays"}) {
      EXPECT_FALSE(petzval::testing::has_token(outcome.err, inside)) << outcome.err;
    }
    if (unit.empty()) petzval::testing::expect_tokens(outcome.err, {"--depth-unit", "metres"});
  }
}

// The blur of a black and white edge, 0.26 px in radius, is an integral over the pixels beside the edge.
TEST_F(LensBlurProgram, BlurBelowAPixel_IsAMeanOverThePixel) {
  RgbImage image(24, 16);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i / 3 % 24 < 12 ? 0.0f : 1.0f;
  petzval::write_pfm(image, path("rgb.pfm"));
  petzval::write_pfm(24, 16, std::vector<float>(384, 1900), path("depth.pfm"));
  constexpr double radius_px = 0.26, focal_px = radius_px / (50 / 1.4 / 2 * (1 / 1900.0 - 1 / 2000.0));
  const double fov_deg = 2 * std::atan(8 / focal_px) * 180 / 3.14159265358979;
  const double passes = 2 * radius_px / (3 * 3.14159265358979);  // mean of max(x, 0) over the disc
  for (const char* side : {"1", "2"}) {
    blur(joined({files(),
                 {"--thin-lens", "50", "--f-number", "1.4", "--focus", "2000", "--fov", std::to_string(fov_deg),
                  "--highlights-above", "0", "--rays", "1024", "--supersample", side}}));
    const RgbImage blurred = picture("out/blur.pfm");
    ASSERT_EQ(blurred.width, 24);
    EXPECT_NEAR(blurred.pixel(11, 8)[0], passes, 0.005) << side;
    EXPECT_NEAR(blurred.pixel(12, 8)[0], 1 - passes, 0.005) << side;
    EXPECT_EQ(blurred.pixel(10, 8)[0], 0) << side;
    EXPECT_NEAR(blurred.pixel(13, 8)[0], 1, 1e-5) << side;
  }
}

TEST_F(LensBlurProgram, ComparesNumbersOfRays) {
  const json result = blur(joined({thin,
                                   {"--scene", "town", "--focus", "5000", "--size", "80x60", "--supersample", "1",
                                    "--threads", "1", "--rays", "4,64", "--compare-rays", "512"}}));
  ASSERT_EQ(result["quality"].size(), 2u);
  EXPECT_EQ(result["rays"], 64);
  EXPECT_EQ(result["compare_rays"], 512);
  EXPECT_EQ(result["quality"][0]["rays"], 4);
  EXPECT_GT(result["quality"][0]["psnr_db"], 20);
  // Errors of regular points fall faster than those of random points: 16 times the rays give more than 12 dB.
  EXPECT_GT(result["quality"][1]["psnr_db"].get<double>(), result["quality"][0]["psnr_db"].get<double>() + 12);
  EXPECT_GT(result["quality"][1]["ssim"], result["quality"][0]["ssim"]);
  EXPECT_EQ(pictures_in(path("out/ray_counts.svg")), 3u);
  const std::string plot = read(path("out/rays.svg"));
  EXPECT_TRUE(petzval::testing::has_token(plot, "512"));
  EXPECT_EQ(picture("out/many_rays.pfm").width, 80);
}

TEST_F(LensBlurProgram, RefusesInvalidInput) {
  write_files(1000, 2000);
  const auto refused = [&](const Arguments& arguments, const std::vector<petzval::testing::Token>& tokens) {
    expect_failure("blur", joined({thin, arguments, {"--out", path("out")}}), tokens);
  };
  const Arguments focus{"--focus", "3000"};
  refused(joined({focus, files(), {"--scene", "town"}}), {2, "--scene", "--image"});
  refused(joined({focus, files(), {"--compare"}}), {"--compare"});
  refused(joined({focus, files(), {"--rays", "16,32"}}), {"--rays", 2, "--compare-rays"});
  refused(joined({focus, files(), {"--rays", "16,2.5", "--compare-rays", "64"}}), {"--rays", 2.5});
  refused(joined({focus, files(), {"--frames", "2", "--compare-rays", "64"}}), {"--compare-rays", "--frames", 2});
  refused(joined({focus, files(), {"--near", "1m", "--far", "2m", "--depth-unit", "m"}}), {"--depth-unit", "--near"});
  refused(joined({focus, files(), {"--size", "80"}}), {"--size"});
  refused(joined({files(), {"--focus", "40"}}), {"--focus", 40});
  petzval::write_exr(picture("rgb.pfm"), path("flat.exr"));
  refused(joined({focus, {"--image", path("flat.exr")}}), {"flat.exr", "Z"});
  petzval::write_pfm(16, 24, std::vector<float>(384, 1000), path("turned.pfm"));
  refused(joined({focus, {"--image", path("rgb.pfm"), "--depth", path("turned.pfm")}}), {"turned.pfm", 16, 24});
}

// The default film of 24 mm height suits lenses with this image size; --fov makes it smaller.
TEST_F(LensBlurProgram, ReportsFilmsLargerThanTheImageCircle) {
  const Arguments phone = joined({small, {"--scene", "town", "--focus", "1000", lens("phone_5.6mm_f3.5")}});
  const auto notes = [&](const Arguments& more) {
    const auto outcome = run("blur", joined({phone, more, {"--format", "png", "--out", path("out")}}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    int count = 0;
    for (const std::string& line : lines(outcome.err)) {
      count += petzval::testing::has_token(line, "film") && petzval::testing::has_token(line, "40");
    }
    return count;
  };
  EXPECT_EQ(notes({"--frames", "2"}), 1);
  EXPECT_EQ(notes({"--fov", "20"}), 0);
}

// The pupil of a fisheye moves with the field: rays between the nodes of a table have errors.
TEST_F(LensBlurProgram, ReportsTheErrorOfInterpolatedRays) {
  const auto outcome =
      run("blur", {"--scene", "town", lens("fisheye_10mm_f4"), "--fov", "60", "--focus", "3000", "--size", "320x240",
                   "--supersample", "1", "--rays", "16", "--format", "png", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(read_json(path("out/blur.json"))["rays_error_px"], 1);
  petzval::testing::expect_tokens(outcome.err, {"note", "rays"});
}

}  // namespace
