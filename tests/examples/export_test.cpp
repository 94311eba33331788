// SPDX-License-Identifier: Apache-2.0
// The files of `petzval export`, read back.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/exports/ray_map.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using Vec3 = petzval::Vec3<double>;

class Export : public Programs {};

TEST_F(Export, TablesOfOmniverseAreFiles) {
  const std::string stem = path("out/fisheye_6.3mm_f2.8");
  const Outcome outcome =
      run("export", {lens("fisheye_6.3mm_f2.8"), "--focus", "inf", "--size", "96", "--calibration", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("omniverse_lut"), std::string::npos) << outcome.out;
  EXPECT_NE(read(stem + ".usda.txt").find("@./fisheye_6.3mm_f2.8.omniverse.exit.exr@"), std::string::npos);
  const petzval::RgbImage enter = petzval::read_exr(stem + ".omniverse.enter.exr"),
                          exit = petzval::read_exr(stem + ".omniverse.exit.exr");
  ASSERT_EQ(enter.width, 96);
  ASSERT_EQ(enter.height, 64);
  const float* const up = enter.pixel(48, 20);
  EXPECT_GT(up[1], 0.1f);
  EXPECT_LT(up[2], 0.0f);
  EXPECT_NEAR(std::hypot(up[0], up[1], up[2]), 1, 1e-6);
  const float* const centre = exit.pixel(exit.width / 2, exit.height / 2);
  EXPECT_NEAR(centre[0], 0.5, 1e-6);
  EXPECT_NEAR(centre[1], 0.5, 1e-6);
  EXPECT_LT(exit.pixel(exit.width / 2, exit.height * 3 / 4)[1], 0.5f);  // towards +y: the upper half of the picture
}

/// A ray by the description in a file, from the channels of a part.
petzval::Ray<double> described(const nlohmann::json& head, const petzval::ExrPart& part, int column, int row) {
  const auto pixel = static_cast<std::size_t>(row * part.width + column);
  const auto value = [&](const std::string& name) { return double{part.channels.at(name)[pixel]}; };
  if (head.at("layout") == "directions") {
    return {{value("x"), value("y"), value("z")}, glm::normalize(Vec3{value("dx"), value("dy"), value("dz")})};
  }
  const auto slope = [&](const char* name, int axis, double from_centre) {
    return value(name) + head.at("slope_per_pixel").at(static_cast<std::size_t>(axis)).get<double>() * from_centre;
  };
  return {{value("x"), value("y"), head.at("plane_z_mm").get<double>()},
          glm::normalize(Vec3{slope("slope_x", 0, column + 0.5 - part.width / 2.0),
                              slope("slope_y", 1, row + 0.5 - part.height / 2.0), -1})};
}

TEST_F(Export, LensfunFileHasOneRoot) {
  ASSERT_EQ(run("export", {lens("double_gauss_52mm_f1.8"), "--size", "48", "--calibration", path("out")}).status, 0);
  const std::string xml = read(path("out/double_gauss_52mm_f1.8.lensfun.xml"));
  EXPECT_TRUE(xml.starts_with("<calibration>")) << xml;
  EXPECT_TRUE(xml.ends_with("</calibration>\n")) << xml;
  for (const char* element : {"<distortion ", "<vignetting "}) EXPECT_NE(xml.find(element), std::string::npos);
}

TEST_F(Export, RayMapsHoldTheRaysOfTheCamera) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "anamorphic_60mm_2x"}) {
    for (const bool half : {false, true}) {
      SCOPED_TRACE(std::string(id) + (half ? " half" : ""));
      Arguments arguments{lens(id),         "--focus", "inf",       "--size",        "48", "--wavelengths", "d",
                          "--lens-samples", "5",       "--ray-map", path("rays.exr")};
      if (half) arguments.push_back("--half");
      const Outcome outcome = run("export", arguments);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      const std::vector<petzval::ExrPart> parts = petzval::read_exr_parts(path("rays.exr"));
      ASSERT_EQ(parts.size(), 5u);
      const nlohmann::json head = nlohmann::json::parse(parts[0].texts.at("ray_map"));
      EXPECT_EQ(head.at("layout") == "directions", std::string(id).starts_with("fisheye"));
      EXPECT_LT(head.at("largest_px"), 0.2);
      const petzval::Lens own = petzval::with_focus(petzval::testing::data_lens(id), HUGE_VAL);
      const petzval::Camera camera(own, {.columns = 48, .rows = 32}, {.model = petzval::ModelKind::exact_double});
      int lit = 0;
      for (std::size_t s = 0; s < parts.size(); ++s) {
        const nlohmann::json& sample = head.at("lens_samples").at(s);
        EXPECT_NEAR(parts[s].pairs.at("lens_sample").x, sample.at("u").get<double>(), 1e-6);
        for (int row = 0; row < 32; row += 3) {
          for (int column = 0; column < 48; column += 5) {
            const petzval::CameraRay exact = camera.sample({.film = camera.film().point(column + 0.5, row + 0.5),
                                                            .pupil_u = sample.at("u").get<double>(),
                                                            .pupil_v = sample.at("v").get<double>()});
            if (!exact) continue;
            const auto& [o, d] = described(head, parts[s], column, row);
            EXPECT_LT(glm::length(d - exact.ray.direction), half ? 1e-3 : 3e-7);
            EXPECT_LT(glm::length(glm::cross(o - exact.ray.origin, d)), half ? 0.04 : 1e-5);
            ++lit;
          }
        }
      }
      EXPECT_GT(lit, 150);
    }
  }
}

TEST_F(Export, HalvesAreRoundedOnceAndChiefRaysAreOnePart) {
  const Arguments arguments{lens("double_gauss_100mm_f2.0"),
                            "--size",
                            "24",
                            "--wavelengths",
                            "d",
                            "--lens-samples",
                            "1",
                            "--half",
                            "--ray-map",
                            path("rays.exr")};
  ASSERT_EQ(run("export", arguments).status, 0);
  const std::vector<petzval::ExrPart> parts = petzval::read_exr_parts(path("rays.exr"));
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_TRUE(nlohmann::json::parse(parts[0].texts.at("ray_map")).at("chief_rays"));
  const petzval::Camera camera(petzval::with_focus(petzval::testing::data_lens("double_gauss_100mm_f2.0"), 3000),
                               {.columns = 24, .rows = 16}, {.model = petzval::ModelKind::exact_double});
  const petzval::RayMap map = petzval::ray_map(camera, {.lens_samples = 1, .half = true});
  const std::vector<std::string_view> names = map.channels();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::vector<float>& values = parts[0].channels.at(std::string(names[k]));
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], map.channel(0, k)[i]);
  }
  EXPECT_LT(std::filesystem::file_size(path("rays.exr")), 24u * 16 * 5 * 2 + 3000);
  expect_failure("export", {lens("double_gauss_100mm_f2.0")}, {"--calibration", "--ray-map"});
}

TEST_F(Export, NamesOfLensesStayInTheComment) {
  nlohmann::json json = read_json(lens("double_gauss_100mm_f2.0"));
  json["name"] = "x */ \n#error 1 /* \r\n#error 2 */";
  write("lens.json", json.dump());
  ASSERT_EQ(run("export", {path("lens.json"), "--camera", path("c.h")}).status, 0);
  const std::string text = read(path("c.h"));
  const std::size_t end = text.find("*/");
  ASSERT_LT(end, text.find('\n'));
  EXPECT_LT(text.rfind("#error"), end);
  EXPECT_EQ(text.find("/*", 2), std::string::npos);
}

}  // namespace
