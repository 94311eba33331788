// SPDX-License-Identifier: Apache-2.0
// petzval ghosts: its report, its pictures and its lights.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;

class GhostsProgram : public Programs {
 protected:
  json ghosts(Arguments arguments, const std::string& out = "out") const {
    arguments.insert(arguments.begin(), "double_gauss_52mm_f1.8");
    arguments.insert(arguments.end(), {"--wavelengths", "d", "--size", "60", "--out", path(out), "--json"});
    const Outcome outcome = run("ghosts", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out), read_json(path(out + "/ghosts.json")));
    return json::parse(outcome.out);
  }
  /// Power on the film for an irradiance of 1 W/m^2, as a fraction of the light that enters.
  double power(const json& report, const std::string& out = "out") const {
    double sum = 0;
    const petzval::RgbImage image = petzval::read_exr(path(out + "/ghosts.exr"));
    for (std::size_t i = 1; i < image.pixels.size(); i += 3) sum += static_cast<double>(image.pixels[i]);
    const double pixel_m2 = 36e-3 * 24e-3 / (60 * 40);
    return sum * pixel_m2 / report["entering_w_per_w_m2"].get<double>();
  }
};

TEST_F(GhostsProgram, PictureHasTheEnergyOfThePairs) {
  // At f/11 the ghosts of a light near the axis lie on the film, except the widest.
  const json report = ghosts({"--light", "0,4", "--f-number", "11", "--film", "36x24"});
  EXPECT_NEAR(report["audit"]["sum"], 1, 0.002);
  EXPECT_EQ(report["light"]["y_deg"], 4);
  double all = 0, within = 0;
  for (const json& pair : report["pairs"]) {
    all += pair["energy"].get<double>();
    const double y = pair["centre_mm"][1], reach = 2 * pair["rms_radius_mm"].get<double>();
    if (std::abs(y) + reach < 12) within += pair["energy"].get<double>();
  }
  EXPECT_NEAR(report["audit"]["ghosts"], all, 1e-3 * all);
  EXPECT_GT(power(report), 0.98 * within);
  EXPECT_LT(power(report), 1.02 * all);
}

TEST_F(GhostsProgram, LayersOfPairsAddUpToThePicture) {
  const json report = ghosts({"--light", "5,4", "--pairs", "3", "--pair-layers"});
  ASSERT_EQ(report["pairs"].size(), 3u);
  const petzval::ExrPart part = petzval::read_exr_parts(path("out/ghosts.exr")).at(0);
  std::vector<float> sum(part.channels.at("G").size());
  for (const json& pair : report["pairs"]) {
    const std::string name = "pair_" + pair["first"].dump() + '_' + pair["second"].dump() + ".G";
    const std::vector<float>& layer = part.channels.at(name);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += layer[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], part.channels.at("G")[i], 1e-5f * sum[i] + 1e-12f);
}

TEST_F(GhostsProgram, LightOfAPixelIsImagedThere) {
  // The image of a light 10 degrees up lies below the middle of the film, in the upper half of the upright picture.
  for (const char* distance : {"", ",3m"}) {
    const json report = ghosts({"--light", std::string("40px,12px") + distance});
    EXPECT_GT(report["light"]["x_deg"], 0);
    EXPECT_GT(report["light"]["y_deg"], 0);
    EXPECT_NEAR(report["light"]["x_deg"].get<double>() * 8, report["light"]["y_deg"].get<double>() * 10, 0.5);
  }
}

TEST_F(GhostsProgram, CoatingsAndThreads) {
  const json plain = ghosts({"--light", "5,4", "--threads", "1"}, "one");
  EXPECT_EQ(ghosts({"--light", "5,4", "--threads", "2"}, "two"), plain);
  EXPECT_EQ(petzval::read_exr(path("one/ghosts.exr")).pixels, petzval::read_exr(path("two/ghosts.exr")).pixels);
  const json coated = ghosts({"--light", "5,4", "--coatings", "mgf2"}, "coated");
  EXPECT_LT(coated["audit"]["ghosts"].get<double>(), plain["audit"]["ghosts"].get<double>() / 5);
  EXPECT_GT(coated["audit"]["image"], plain["audit"]["image"]);
}

TEST_F(GhostsProgram, MissingCoatingsAreNotedOnlyIfASurfaceRefracts) {
  for (const auto& [name, refracts] : {std::pair{"mirror_newton_200mm_f8", false}, {"cooke_triplet_50mm_f5", true}}) {
    const Outcome outcome =
        run("ghosts", {name, "--light", "0,1", "--wavelengths", "d", "--size", "8", "--out", path("out")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("coating") != std::string::npos, refracts) << outcome.err;
  }
}

// A pixel of a picture, far away, is a light like that of petzval ghosts.
TEST_F(GhostsProgram, OfABlurredPixelHaveTheirShareOfItsLight) {
  petzval::RgbImage picture(60, 40), depth(60, 40);
  picture.pixel(40, 12)[1] = 1e6f;
  std::fill(depth.pixels.begin(), depth.pixels.end(), 1e9f);
  petzval::write_pfm(picture, path("picture.pfm"));
  petzval::write_pfm(depth, path("depth.pfm"));
  const auto blurred = [&](const std::string& out, const Arguments& more) {
    Arguments arguments{"--image",
                        path("picture.pfm"),
                        "--depth",
                        path("depth.pfm"),
                        "double_gauss_52mm_f1.8",
                        "--focus",
                        "inf",
                        "--rays",
                        "64",
                        "--out",
                        path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run("blur", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return petzval::read_exr_parts(path(out + "/blur.exr")).at(0).channels;
  };
  auto with = blurred("with", {"--ghosts", "3"}), without = blurred("without", {});
  for (std::size_t i = 0; i < with["G"].size(); ++i) {
    EXPECT_NEAR(with["G"][i], without["G"][i] + with["ghosts.G"][i], 1e-6f * with["G"][i]);
  }
  const json share = read_json(path("with/blur.json"))["ghosts"];
  EXPECT_EQ(share["lights"], 1);
  const json alone = ghosts({"--light", "40.5px,12.5px", "--focus", "inf"});
  const double expected = power(alone) / alone["audit"]["image"].get<double>();
  EXPECT_NEAR(share["fraction"].get<double>(), expected, 0.05 * expected);

  const Outcome thin = run("blur", {"--image", path("picture.pfm"), "--depth", path("depth.pfm"), "--thin-lens", "50",
                                    "--f-number", "2", "--focus", "2000", "--ghosts", "3", "--out", path("thin")});
  EXPECT_NE(thin.status, 0);
  EXPECT_NE(thin.err.find("--ghosts"), std::string::npos) << thin.err;
}

}  // namespace
