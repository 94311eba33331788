// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

class ChromaticBokeh : public Programs {
 protected:
  static constexpr const char* id = "double_gauss_100mm_f1.35";

  nlohmann::json colours(std::vector<std::string> more = {}, const std::string& out = "out") const {
    std::vector<std::string> arguments{lens(id), "--out", path(out), "--rays", "8192"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("colour", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const auto& line : lines(outcome.out)) {
      EXPECT_TRUE(!line.starts_with("/") || std::filesystem::exists(line)) << line;
    }
    EXPECT_TRUE(outcome.out.starts_with("wavelength   paraxial focus   sharpest film")) << outcome.out;
    EXPECT_TRUE(read(path(out + '/' + id + "_chromatic.svg")).starts_with("<svg"));
    return read_json(path(out + '/' + id + "_chromatic.json"));
  }

  /// The channels of a picture by name.
  std::map<std::string, std::vector<float>> channels(const nlohmann::json& picture) const {
    std::map<std::string, std::vector<float>> result;
    for (const auto& part : petzval::read_exr_parts(path("out/" + picture["file"].get<std::string>()))) {
      result.insert(part.channels.begin(), part.channels.end());
    }
    return result;
  }
};

TEST_F(ChromaticBokeh, WritesAChannelForEachWavelength) {
  const auto json = colours({"--focus", "1800,2200", "--f-number", "1.35"});
  EXPECT_NEAR(json["f_number_real"].get<double>(), 1.35352, 1e-5);  // at 590 nm; the declared f-number is rounded
  EXPECT_EQ(json["subject_distance_mm"], 2000);
  EXPECT_EQ(json["white_point"], "D65");
  ASSERT_EQ(json["pictures"].size(), 4u);  // two fields
  const auto& weights = json["rgb_weights"];
  for (const auto& picture : json["pictures"]) {
    const auto file = channels(picture);
    ASSERT_EQ(file.size(), 3 + 26u);
    for (const char* name : {"S0.430nm", "S0.475nm", "S0.670nm"}) EXPECT_EQ(file.count(name), 1u) << name;
    // R, G and B are the weighted sums of the channels, and no light is lost.
    const double area = std::pow(picture["picture_pixel_mm"].get<double>(), 2);
    double throughput = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> sums(file.at("R").size());
      for (std::size_t w = 0; w < 26; ++w) {
        const auto nm = json["longitudinal"][w]["wavelength_nm"].get<int>();
        const auto& light = file.at("S0." + std::to_string(nm) + "nm");
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weights[w][k].get<double>() * light[i];
        if (k == 0) {
          for (const float value : light) throughput += value * area / 26;
        }
      }
      const auto& channel = file.at(std::string(1, "RGB"[k]));
      const float most = *std::max_element(channel.begin(), channel.end());
      for (std::size_t i = 0; i < sums.size(); ++i) ASSERT_NEAR(channel[i], sums[i], 1e-5 * most);
    }
    EXPECT_NEAR(throughput, picture["throughput"].get<double>(), 1e-3);
  }
}

// Blue light focuses nearer to this lens: the blue image is larger if the film is too far from the lens, and smaller if
// the film is too near.
TEST_F(ChromaticBokeh, OutlineIsBlueIfFocusedNearerAndRedIfFarther) {
  const auto json = colours({"--focus", "1600,2400", "--fields", "0"});
  EXPECT_LT(json["longitudinal"][0]["paraxial_focus_shift_mm"], -0.2);
  EXPECT_GT(json["longitudinal"][25]["paraxial_focus_shift_mm"], 0.1);
  const auto rms_radius = [&](const nlohmann::json& picture, const std::string& name) {
    const auto values = channels(picture).at(name);
    double light = 0, squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double x = static_cast<double>(i % 320) - 159.5, y = static_cast<double>(i / 320) - 159.5;
      light += values[i], squares += values[i] * (x * x + y * y);
    }
    return std::sqrt(squares / light);
  };
  const auto &nearer = json["pictures"][0], &farther = json["pictures"][1];
  EXPECT_GT(rms_radius(nearer, "S0.450nm"), 1.3 * rms_radius(nearer, "S0.650nm"));
  EXPECT_LT(1.3 * rms_radius(farther, "S0.450nm"), rms_radius(farther, "S0.650nm"));
}

}  // namespace
