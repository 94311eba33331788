// SPDX-License-Identifier: Apache-2.0
// petzval render --ghosts: unit, occluders, resumed and merged pictures.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;

class RenderGhosts : public Programs {
 protected:
  static constexpr double x_mm = 2000, y_mm = 1200, z_mm = 20'000, radius_mm = 50, radiance = 1e4;

  void SetUp() override {
    Programs::SetUp();
    write_scene("lamp.json", "");
    write_scene("wall.json", R"(, {"quad": {"corner_mm": [-900, -900, -500], "edge_u_mm": [1800, 0, 0],
                                            "edge_v_mm": [0, 1800, 0]}})");
  }
  /// A lamp in front of a camera whose entrance pupil is at the origin.
  void write_scene(const std::string& name, const std::string& more) const {
    const json sphere{{"centre_mm", {x_mm, y_mm, -z_mm}}, {"radius_mm", radius_mm}};
    const json lamp{{"sphere", sphere}, {"emission", {radiance, radiance, radiance}}};
    write(name, R"({"sky": [0, 0, 0], "camera": {"position_mm": [0, 0, 0], "look_at_mm": [0, 0, -1]}, "objects": [)" +
                    lamp.dump() + more + "]}");
  }
  Arguments arguments(const std::string& out, const Arguments& more, const std::string& scene = "lamp.json",
                      const std::string& samples = "2") const {
    Arguments all{lens("double_gauss_52mm_f1.8"), "--scene", path(scene), "--spp", samples, "--out", path(out)};
    std::istringstream usual("--focus 3000 --from entrance_pupil --f-number 8 --size 60x40");
    for (std::string word; usual >> word;) all.push_back(word);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  json render(const std::string& out, const Arguments& more = {}, const std::string& scene = "lamp.json",
              const std::string& samples = "2") const {
    const Outcome done = run("render", arguments(out, more, scene, samples));
    EXPECT_EQ(done.status, 0) << done.err;
    return read_json(path(out + "/render.json"));
  }
  petzval::ExrPart picture(const std::string& out) const {
    return petzval::read_exr_parts(path(out + "/picture.exr")).front();
  }
  static double sum(const std::vector<float>& plane) { return std::accumulate(plane.begin(), plane.end(), 0.0); }
};

TEST_F(RenderGhosts, PictureWithMinusWithoutIsTheLayer) {
  for (const char* wavelengths : {"d", "hero"}) {
    for (const char* model : {"exact_float", "thin"}) {
      const Arguments same{"--wavelengths", wavelengths, "--model", model};
      render("without", same);
      Arguments more{same};
      more.insert(more.end(), {"--ghosts", "4", "--format", "exr,pfm"});
      const json report = render("with", more);
      const auto with = picture("with").channels, without = picture("without").channels;
      EXPECT_FALSE(without.contains("ghosts.R"));
      for (const char* c : {"R", "G", "B"}) {
        const std::vector<float>& layer = with.at(std::string("ghosts.") + c);
        EXPECT_GT(sum(layer), 0);
        for (std::size_t i = 0; i < layer.size(); ++i) ASSERT_EQ(with.at(c)[i], without.at(c)[i] + layer[i]);
      }
      EXPECT_EQ(report["ghosts"]["lights"], 4);
      EXPECT_GT(report["ghosts"]["seconds"], 0);
      const double fraction = sum(with.at("ghosts.G")) / sum(without.at("G"));
      EXPECT_NEAR(report["ghosts"]["fraction"], fraction, 0.05 * fraction);
    }
  }
}

TEST_F(RenderGhosts, SmallLampHasTheGhostsOfAPointLight) {
  render("irradiance", {"--ghosts", "4", "--normalisation", "irradiance"});
  const std::vector<float> layer = picture("irradiance").channels.at("ghosts.G");
  const double field = std::atan(std::hypot(x_mm, y_mm) / z_mm) * 180 / std::numbers::pi;
  const std::string light = std::to_string(field * x_mm / std::hypot(x_mm, y_mm)) + "," +
                            std::to_string(field * y_mm / std::hypot(x_mm, y_mm)) + "," + std::to_string(z_mm);
  ASSERT_EQ(
      run("ghosts", {lens("double_gauss_52mm_f1.8"), "--light", light, "--focus", "3000", "--from", "entrance_pupil",
                     "--f-number", "8", "--wavelengths", "d", "--size", "60x40", "--out", path("point")})
          .status,
      0);
  const petzval::RgbImage point = petzval::read_exr(path("point/ghosts.exr"));
  const double irradiance =
      radiance * std::numbers::pi * radius_mm * radius_mm / (x_mm * x_mm + y_mm * y_mm + z_mm * z_mm);
  double all = 0, off = 0;
  for (std::size_t i = 0; i < layer.size(); ++i) {
    const double expected = irradiance * static_cast<double>(point.pixels[3 * i + 1]);
    all += expected, off += std::abs(static_cast<double>(layer[i]) - expected);
  }
  EXPECT_NEAR(sum(layer), all, 0.01 * all);
  EXPECT_LT(off, 0.08 * all);  // the lamp is 0.3 degrees wide
  // The other unit divides the ghosts as it divides the picture.
  for (const char* model : {"exact_float", "thin"}) {
    render("unity", {"--ghosts", "4", "--model", model});
    const json own = render("own", {"--model", model, "--normalisation", "irradiance"});
    const double unity = sum(picture("unity").channels.at("ghosts.G"));
    EXPECT_NEAR(unity * own["job"]["white"].get<double>(), sum(layer), 1e-3 * sum(layer)) << model;
  }
}

TEST_F(RenderGhosts, OccludersStopTheLight) {
  render("wall", {"--ghosts", "4"}, "wall.json");
  EXPECT_EQ(sum(picture("wall").channels.at("ghosts.G")), 0);
}

TEST_F(RenderGhosts, ThreadsShardsAndResumedRunsEqualOneRunToTheBit) {
  render("whole", {"--ghosts", "3", "--threads", "1"});
  render("without");
  const std::string whole = read(path("whole/picture.exr")), without = read(path("without/picture.exr"));
  render("threads", {"--ghosts", "3", "--threads", "3"});
  EXPECT_EQ(read(path("threads/picture.exr")), whole);
  // A resumed picture gets ghosts, gets more ghosts, and loses them.
  for (const char* lights : {"2", "3"}) render("resumed", {"--ghosts", lights, "--resume"});
  EXPECT_EQ(read(path("resumed/picture.exr")), whole);
  EXPECT_EQ(render("resumed", {"--resume"}).count("ghosts"), 0u);
  EXPECT_EQ(read(path("resumed/picture.exr")), without);
  for (const char* tile : {"1/2", "2/2"}) {
    const Outcome shard = run("render", arguments("tiles", {"--ghosts", "3", "--shard", tile}));
    EXPECT_EQ(shard.status, 0) << shard.err;
  }
  EXPECT_EQ(run("render", {"merge", path("tiles"), "--out", path("merged")}).status, 0);
  EXPECT_EQ(read(path("merged/picture.exr")), whole);
  EXPECT_EQ(read_json(path("merged/render.json"))["ghosts"]["lights"], 3);
}

TEST_F(RenderGhosts, TimeIncludesGhostsAndLeavesOnePass) {
  EXPECT_GT(render("short", {"--ghosts", "2", "--time", "0.01"})["samples"], 0);
  const json report = render("time", {"--ghosts", "6", "--time", "2"}, "lamp.json", "65536");
  const double ghosts = report["ghosts"]["seconds"];
  EXPECT_LT(report["seconds"], std::max(2 - ghosts / 2, 0.5));
}

TEST_F(RenderGhosts, NeedTheSurfacesOfTheLens) {
  expect_failure("render", arguments("out", {"--model", "thin", "--from-lens", "1", "--ghosts", "4"}), {"--ghosts"});
}

}  // namespace
