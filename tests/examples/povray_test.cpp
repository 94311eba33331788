// SPDX-License-Identifier: Apache-2.0
// An unmodified renderer: POV-Ray renders a scene through an exact lens with the file of `petzval camera-rays
// --povray`.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using petzval::RgbImage;

/// A luminous red ball under a blue sky; lens frame, mm.
struct Ball {
  const char* name;
  double x, y, z, radius;
  double half;  ///< half the side of the square in the picture that holds the blurred image, pixels
};
constexpr int columns = 144, rows = 96;
constexpr const char* lens_id = "double_gauss_100mm_f1.35";
/// In focus at 1 m.
const std::vector<Ball> balls{
    {"in focus, on the axis", 0, 0, -1000, 8, 10}, {"in focus, at the edge", 125, 0, -1000, 8, 10},
    {"far, near the axis", 0, 190, -3000, 27, 19}, {"far, in the corner", -340, 175, -3000, 27, 19},
    {"near, off the axis", 60, -47, -700, 6, 15},  {"large disc", -108, -70, -1300, 35, 21}};

/// Centre (pixels), diameter (four standard deviations: a uniform disc has its own diameter) and sum of an image.
struct Spot {
  double x = 0, y = 0, diameter = 0, sum = 0;
};
Spot measured(const RgbImage& image, const petzval::Vec2<double>& middle, double half, std::size_t channel = 0) {
  const auto pixels = [&](const auto& add) {
    const auto pixel = [](double position, int most) { return std::clamp(static_cast<int>(position), 0, most); };
    for (int y = pixel(middle.y - half, rows); y < pixel(middle.y + half, rows); ++y) {
      for (int x = pixel(middle.x - half, columns); x < pixel(middle.x + half, columns); ++x) {
        add(x + 0.5, y + 0.5, double{image.pixels[3 * static_cast<std::size_t>(y * image.width + x) + channel]});
      }
    }
  };
  Spot spot;
  pixels([&](double x, double y, double value) { spot.x += x * value, spot.y += y * value, spot.sum += value; });
  spot.x /= spot.sum, spot.y /= spot.sum;
  double square = 0;
  pixels([&](double x, double y, double value) {
    square += value * (std::pow(x - spot.x, 2) + std::pow(y - spot.y, 2)) / (2 * spot.sum);
  });
  spot.diameter = 4 * std::sqrt(square);
  return spot;
}

class Povray : public Programs {
 protected:
  void render(const petzval::Lens& lens) const {
    json scene{{"sky", {0, 0, 1}}, {"camera", {{"position_mm", {0, 0, petzval::pupils(lens).entrance.z}}}}};
    for (const Ball& ball : balls) {
      scene["objects"].push_back({{"sphere", {{"centre_mm", {ball.x, ball.y, ball.z}}, {"radius_mm", ball.radius}}},
                                  {"material", {{"diffuse", {0, 0, 0}}}},
                                  {"emission", {1, 0, 0}}});
    }
    write("scene.json", scene.dump());
    const auto outcome = run("render", {"--scene", path("scene.json"), this->lens(lens_id), "--focus", "1000", "--size",
                                        "144x96", "--spp", "256", "--out", path("petzval")});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  /// Renders the picture of POV-Ray, and reads the factor to the picture of `petzval render` from the camera's file.
  double render_by_povray(const std::string& before, const std::string& pose) const {
    const auto outcome = run("camera-rays", {lens(lens_id), "--povray", "--focus", "1000", "--size", "144x96", "--spp",
                                             "128", "--model", "exact_double", "--out", path("lens.inc")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::string scene = "#version 3.7;\nglobal_settings { assumed_gamma 1 }\nbackground { rgb <0,0,1> }\n" + before +
                        "#include \"lens.inc\"\n";
    for (const Ball& ball : balls) {
      const auto text = [](double value) { return std::to_string(value); };
      scene += "sphere { <" + text(ball.x) + "," + text(ball.y) + "," + text(-ball.z) + ">, " + text(ball.radius) +
               " pigment { rgb <1,0,0> } finish { ambient 0 diffuse 0 emission 1 } " + pose + " }\n";
    }
    write("scene.pov", scene);
    const std::string command = "cd '" + folder.string() + "' && timeout 300 povray scene.pov +Opovray.exr +FE +W" +
                                std::to_string(columns) + " +H" + std::to_string(rows) + " -A -D > povray.log 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << read(path("povray.log"));
    const std::string camera = read(path("lens.inc")), words = "picture of POV-Ray * ";
    return std::stod(camera.substr(camera.find(words) + words.size(), 10));
  }
};

TEST_F(Povray, PictureEqualsPetzvalRender) {
  if (std::system("command -v povray >/dev/null 2>&1") != 0) GTEST_SKIP() << "povray is missing";
  const petzval::Lens focused = petzval::with_focus(petzval::testing::data_lens(lens_id), 1000);
  const petzval::Camera camera(focused, {.columns = columns, .rows = rows});
  render(focused);
  // The whole scene is moved, to test the pose of the camera.
  const std::string pose = "rotate <20, 35, 10> translate <300, -2000, 700>";
  const double scale = render_by_povray("#declare petzval_pose = transform { " + pose + " }\n", pose);
  const RgbImage expected = petzval::read_exr(path("petzval/picture.exr")),
                 found = petzval::read_exr(path("povray.exr"));
  ASSERT_EQ(found.width, columns);
  ASSERT_EQ(found.height, rows);
  for (const Ball& ball : balls) {
    SCOPED_TRACE(ball.name);
    const auto projection = camera.project({ball.x, ball.y, ball.z});
    const Spot a = measured(expected, projection.raster, ball.half), b = measured(found, projection.raster, ball.half);
    EXPECT_NEAR(b.x, a.x, 0.5);
    EXPECT_NEAR(b.y, a.y, 0.5);
    EXPECT_NEAR(b.diameter, a.diameter, 0.02 * a.diameter);
    EXPECT_NEAR(b.sum * scale, a.sum, 0.03 * a.sum);
  }
  // The sky: dropped and lost rays are black.
  for (const petzval::Vec2<double>& corner : {petzval::Vec2<double>{72, 85}, {136, 10}, {136, 88}}) {
    const double a = measured(expected, corner, 8, 2).sum, b = measured(found, corner, 8, 2).sum * scale;
    EXPECT_NEAR(b, a, 0.005 * a);
  }
}

}  // namespace
