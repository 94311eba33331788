// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/image/deep_exr.hpp"
#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using petzval::RgbImage;
using Arguments = std::vector<std::string>;

const Arguments thin{"--thin-lens-mm", "50", "--lens-diameter-mm", "100"};
const Arguments small{"--width", "80", "--height", "60", "--rays", "16", "--threads", "1"};

Arguments joined(std::initializer_list<Arguments> lists) {
  Arguments all;
  for (const Arguments& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

class LensBlurProgram : public Programs {
 protected:
  json blur(const Arguments& arguments, const std::string& out = "out") const {
    const auto outcome = run("lens_blur", joined({arguments, {"--format", "pfm", "--out", path(out)}}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? read_json(path(out + "/blur.json")) : json();
  }
  RgbImage picture(const std::string& name) const { return petzval::read_pfm(path(name)); }

  /// A picture of 24 x 16 pixels that is all different, and one depth for each pixel.
  void write_files(double left_mm, double right_mm) const {
    RgbImage image(24, 16);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i * 7 % 64) / 32;
    petzval::write_pfm(image, path("rgb.pfm"));
    std::vector<float> depths(24 * 16);
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = static_cast<float>(i % 24 < 12 ? left_mm : right_mm);
    petzval::write_pfm(24, 16, depths, path("depth.pfm"));
  }
  Arguments files() const { return {"--rgb", path("rgb.pfm"), "--depth", path("depth.pfm")}; }
};

TEST_F(LensBlurProgram, WritesPicturesAndTheirMeasures) {
  const auto outcome = run("lens_blur", joined({thin,
                                                small,
                                                {"--scene", "town", "--focus-mm", "5000", "--compare", "--supersample",
                                                 "1", "--format", "exr,png,pfm", "--out", path("out")}}));
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
  EXPECT_LE(result["layers"], 4);
  EXPECT_GT(result["psnr_db"], 22);                       // so few pixels are far from smooth
  EXPECT_LT(result["psnr_edges_db"], result["psnr_db"]);  // edges of depths are what is hard
  EXPECT_GT(result["ssim"], 0.75);
  EXPECT_LT(result["flip_mean"], 0.2);
  EXPECT_LT(std::abs(result["energy_drift"].get<double>()), 0.01);
  EXPECT_NE(picture("out/sharp.pfm").pixels, picture("out/blur.pfm").pixels);
}

TEST_F(LensBlurProgram, LeavesAPlaneInFocusAsItIs) {
  write_files(2000, 2000);
  const json result = blur(joined({files(), thin, {"--focus-mm", "2000", "--highlights-above", "0"}}));
  const RgbImage given = picture("rgb.pfm"), blurred = picture("out/blur.pfm");
  ASSERT_EQ(given.pixels.size(), blurred.pixels.size());
  for (std::size_t i = 0; i < given.pixels.size(); ++i) EXPECT_NEAR(given.pixels[i], blurred.pixels[i], 1e-5);
  EXPECT_EQ(given.pixels, picture("out/sharp.pfm").pixels);
  EXPECT_EQ(result["miss_rate"], 0);
  EXPECT_EQ(result["layers"], 1);
}

TEST_F(LensBlurProgram, ReadsLayersAndDeepPicturesAlike) {
  // A near half over a plane of another colour, as parts of an EXR and as lists; what the near half hides is known.
  petzval::FragmentLists lists{.columns = 24, .rows = 16, .offsets = {0}, .fragments = {}};
  std::vector<petzval::ExrPart> parts;
  for (const char* name : {"near", "far"}) {
    parts.push_back({.name = name, .width = 24, .height = 16, .channels = {}});
    for (const char* channel : {"B", "G", "R", "Z"})
      parts.back().channels.push_back({channel, std::vector<float>(384)});
  }
  for (std::size_t i = 0; i < 384; ++i) {
    const auto put = [&](std::size_t part, float depth, float value) {
      for (std::size_t c = 0; c < 3; ++c) parts[part].channels[c].values[i] = value;
      parts[part].channels[3].values[i] = depth;
      lists.fragments.push_back({depth, value, value, value, 1});
    };
    // A part without a surface at a pixel has the depth 0 there.
    if (i % 24 < 12) put(0, 1000, 0.75f);
    put(1, 4000, static_cast<float>(i % 5) / 4);
    lists.offsets.push_back(lists.fragments.size());
  }
  petzval::write_exr(parts, path("layers.exr"));
  petzval::write_deep_exr(lists, path("deep.exr"));
  const Arguments lens = joined({thin, {"--focus-mm", "2000", "--rays", "32"}});
  const json from_layers = blur(joined({lens, {"--image", path("layers.exr")}}), "layers");
  const json from_deep = blur(joined({lens, {"--deep", path("deep.exr")}}), "deep");
  EXPECT_EQ(from_layers["layers"], 2);
  EXPECT_EQ(from_deep["layers"], 2);
  EXPECT_EQ(picture("layers/blur.pfm").pixels, picture("deep/blur.pfm").pixels);
  EXPECT_EQ(from_deep["miss_rate"], 0);
}

TEST_F(LensBlurProgram, SaysWhatASinglePictureDoesNotKnow) {
  write_files(500, 8000);
  EXPECT_GT(blur(joined({files(), thin, {"--focus-mm", "8000"}}))["miss_rate"], 0);
  // Rays that pass beside the near half want what it hides; to its right, the plane in focus is known.
  const RgbImage missed = picture("out/missed.pfm");
  EXPECT_GT(missed.pixel(10, 8)[0], 0.1);
  EXPECT_LT(missed.pixel(10, 8)[0], 0.9);
  for (int x = 12; x < 24; ++x) EXPECT_EQ(missed.pixel(x, 8)[0], 0) << x;
}

TEST_F(LensBlurProgram, AveragesTheSamplesOfPixels) {
  const Arguments street = joined({thin, small, {"--scene", "street", "--focus-mm", "5000", "--supersample", "2"}});
  const json result = blur(joined({street, {"--compare"}}));
  EXPECT_EQ(result["columns"], 80);
  EXPECT_EQ(result["rows"], 60);
  EXPECT_EQ(picture("out/blur.pfm").width, 80);
  EXPECT_GT(result["psnr_db"], 20);
}

TEST_F(LensBlurProgram, FollowsKeysOverFrames) {
  // The focus goes from the stall, 5 m away, to 2 m.
  write("keys.json", R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -5000]},
    {"time_s": 1, "position_mm": [0, 0, -2000]}]}])");
  const Arguments town = joined({thin, small, {"--scene", "town", "--focus-mm", "5000"}});
  const json result = blur(joined({town, {"--frames", "3", "--fps", "2", "--points", path("keys.json")}}), "frames");
  ASSERT_EQ(result["frames"].size(), 3u);
  const RgbImage first = picture("frames/blur_0001.pfm"), last = picture("frames/blur_0003.pfm");
  EXPECT_NE(first.pixels, last.pixels);
  // The frames are those of lenses that stand still.
  const auto difference = [](const RgbImage& a, const RgbImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += static_cast<double>(std::abs(a.pixels[i] - b.pixels[i]));
    return sum / static_cast<double>(a.pixels.size());
  };
  blur(town, "still");
  EXPECT_LT(difference(first, picture("still/blur.pfm")), 1e-3);
  blur(joined({thin, small, {"--scene", "town", "--focus-mm", "2000"}}), "near");
  EXPECT_LT(difference(last, picture("near/blur.pfm")), 1e-3);
  EXPECT_GT(difference(first, last), 1e-2);
}

TEST_F(LensBlurProgram, IsTheSameForAnyNumberOfThreads) {
  const Arguments street = {"--scene", "street", "--width",    "60",   "--height", "45",
                            "--rays",  "16",     "--focus-mm", "3000", "--lens",   lens("double_gauss_52mm_f1.8")};
  blur(joined({street, {"--threads", "1"}}), "one");
  blur(joined({street, {"--threads", "3"}}), "three");
  EXPECT_EQ(picture("one/blur.pfm").pixels, picture("three/blur.pfm").pixels);
}

TEST_F(LensBlurProgram, RefusesWhatItCannotBlur) {
  write_files(1000, 2000);
  const auto refused = [&](const Arguments& arguments, const std::string& reason) {
    expect_failure("lens_blur", joined({arguments, {"--out", path("out")}}), reason);
  };
  const Arguments focus{"--focus-mm", "3000"};
  refused(joined({thin, focus}), "found 0 of --scene, --image, --deep and --rgb, wanted one");
  refused(joined({thin, focus, files(), {"--scene", "town"}}), "found 2 of --scene");
  refused(joined({thin, focus, {"--rgb", path("rgb.pfm")}}), "--rgb and --depth: found one of them");
  refused(joined({thin, focus, files(), {"--compare"}}), "--compare: files have no scene to compare with");
  refused(joined({thin, focus, files(), {"--supersample", "2"}}), "--supersample: files have the pixels");
  refused(joined({thin, focus, files(), {"--width", "80"}}), "--width and --height: files have a size of their own");
  refused(joined({thin, focus, {"--scene", "moon"}}), "--scene");
  refused(joined({thin, focus, files(), {"--rays", "0"}}), "--rays");
  refused(joined({thin, files(), {"--focus-mm", "40"}}), "--focus-mm: found 40");
  refused(joined({focus, files()}), "wanted one");
  refused(joined({thin, focus, {"--deep", path("rgb.pfm")}}), "rgb.pfm");
  refused(joined({thin, focus, {"--image", path("nothing.exr")}}), "nothing.exr");
  petzval::write_exr(picture("rgb.pfm"), path("flat.exr"));
  refused(joined({thin, focus, {"--image", path("flat.exr")}}), "flat.exr: no channel Z");
  petzval::write_pfm(16, 24, std::vector<float>(384, 1000), path("turned.pfm"));
  refused(joined({thin, focus, {"--rgb", path("rgb.pfm"), "--depth", path("turned.pfm")}}),
          "turned.pfm: is 16 x 24, wanted the size of");
  refused(joined({thin, focus, files(), {"--lens-diameter-mm", "7000"}}), "lens-diameter-mm");
  const Arguments gauss{"--scene", "town", "--lens", lens("double_gauss_100mm_f1.35")};
  refused(joined({gauss, {"--focus-mm", "1"}}), "--focus-mm: ");
  refused(joined({gauss, {"--focus-mm", "1"}}), "1000 mm");  // metres?
  refused(joined({gauss, {"--focus-mm", "70", "--distance-from", "entrance_pupil"}}), "--focus-mm: ");
}

TEST_F(LensBlurProgram, RefusesFlagsWithoutAnEffect) {
  const auto refused = [&](const Arguments& arguments, const std::string& reason) {
    expect_failure("lens_blur", joined({arguments, {"--scene", "town", "--focus-mm", "3000", "--out", path("out")}}),
                   reason);
  };
  refused(joined({thin, {"--depth-kind", "distance"}}), "--depth-kind: found distance with --scene, wanted files");
  refused(joined({thin, {"--fps", "24"}}), "--fps requires --");
  refused(joined({thin, {"--frames", "2", "--fps", "12"}}), "--fps requires --points");
  refused(joined({thin, {"--travel-mm", "500"}}), "--travel-mm requires --frames");
  refused(joined({thin, {"--travel-mm", "500", "--frames", "1"}}), "--travel-mm: found 1 frame, wanted 2 or more");
  refused(joined({thin, {"--kind", "affine"}}), "--kind requires --points");
  refused(joined({thin, {"--beta", "2"}}), "--beta requires --points");
  refused(joined({thin, {"--iris-rotation-deg", "10"}}), "--iris-rotation-deg: found it without --blades");
  for (const Arguments& model : {thin, {"--singlet", "50,-50,5,N-BK7"}}) {
    refused(joined({model, {"--configuration", "tele"}}), "--configuration requires --lens");
    refused(joined({model, {"--glasses", "none.agf"}}), "--glasses requires --lens");
  }
}

// The film of 24 mm height is for lenses of that picture; --fov-deg makes it smaller.
TEST_F(LensBlurProgram, SaysThatTheLensDoesNotLightTheFilm) {
  const Arguments phone =
      joined({small, {"--scene", "town", "--focus-mm", "1000", "--lens", lens("phone_5.6mm_f3.5")}});
  const auto notes = [&](const Arguments& more) {
    const auto outcome = run("lens_blur", joined({phone, more, {"--format", "png", "--out", path("out")}}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    int count = 0;
    for (const std::string& line : lines(outcome.err)) {
      count += line.starts_with("note: the film is 32 by 24 mm and needs an image circle of 40 mm");
    }
    return count;
  };
  EXPECT_EQ(notes({"--frames", "2"}), 1);
  EXPECT_EQ(notes({"--fov-deg", "20"}), 0);
}

// The pupil of a fisheye moves with the field, and rays between the nodes of a table with it.
TEST_F(LensBlurProgram, SaysHowFarInterpolatedRaysAreOff) {
  const auto outcome = run("lens_blur", {"--scene",       "town", "--lens",     lens("fisheye_10mm_f4"),
                                         "--fov-deg",     "60",   "--focus-mm", "3000",
                                         "--width",       "320",  "--height",   "240",
                                         "--supersample", "1",    "--rays",     "16",
                                         "--format",      "png",  "--out",      path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(read_json(path("out/blur.json"))["rays_error_px"], 1);
  EXPECT_NE(outcome.err.find("note: rays are interpolated over the picture, and are off by up to "), std::string::npos);
}

}  // namespace
