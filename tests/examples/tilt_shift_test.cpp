// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include "../data_lenses.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

using nlohmann::json;
using petzval::radians;

/// Points of a table top, seen from above by a 100 mm lens.
constexpr const char* table = R"([{"position_mm": [-75, -73, -720]}, {"position_mm": [95, -54, -766]},
  {"position_mm": [0, 2, -900]}, {"position_mm": [-150, 86, -1100]}, {"position_mm": [160, 107, -1150]}])";
const Arguments thin_50{"--thin-lens", "50", "--f-number", "2"};

class TiltShift : public Programs {
 protected:
  Arguments command(Arguments arguments, const std::string& points, const Arguments& more) const {
    write("points.json", points);
    for (const std::string& a : {std::string("--points"), path("points.json"), std::string("--out"), path("out")}) {
      arguments.push_back(a);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  json result(const Arguments& lens, const std::string& points, Arguments more = {}) const {
    more.push_back("--json");
    const auto outcome = run("tilt", command(lens, points, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out);
  }
  json gauss(const std::string& points, Arguments more = {}) const {
    more.insert(more.end(), {"--f-number", "4"});
    return result({lens("double_gauss_100mm_f2_28deg")}, points, more);
  }
};

std::vector<petzval::FocusTarget> targets_of(const std::string& points) {
  std::vector<petzval::FocusTarget> result;
  for (const json& p : json::parse(points)) {
    const auto& at = p["position_mm"];
    result.push_back({{{at[0], at[1], at[2]}, false}, 0, p.value("weight", 1.0)});
  }
  return result;
}

TEST_F(TiltShift, KeepsAnUprightFilmWithoutPoints) {
  const json thin = result(thin_50, "[]"), real = gauss("[]");
  for (const json& found : {thin, real}) {
    EXPECT_EQ(found["status"], "no_targets");
    EXPECT_EQ(found["film_tilt_deg"], 0);
    EXPECT_EQ(found["film_swing_deg"], 0);
    EXPECT_TRUE(found["blur_um"].empty());
    EXPECT_TRUE(found["hinge_line"].is_null());
    EXPECT_EQ(found["files"].size(), 1u);
  }
  EXPECT_EQ(thin["film_z_mm"], 50);
  EXPECT_TRUE(thin["plane_normal"].is_null());  // infinity
}

/// The plane through (0, 0, -2 m) with the normal (0, sin 30, cos 30), and a thin lens of 50 mm: film, hinge line and
/// Scheimpflug line in closed form.
TEST_F(TiltShift, SolvesAThinLensExactly) {
  const double s = std::sin(radians(30)), c = std::cos(radians(30));
  json points = json::array();
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {300.0, 400.0}, {-400.0, -300.0}, {200.0, -250.0}}) {
    points.push_back({{"position_mm", {x, y, -(2000 * c + s * y) / c}}});
  }
  const json found = result(thin_50, points.dump());
  EXPECT_EQ(found["status"], "solved");
  EXPECT_NEAR(found["film_tilt_deg"], 0.848136346759917, 1e-9);
  EXPECT_NEAR(found["film_swing_deg"], 0, 1e-9);
  EXPECT_NEAR(found["film_z_mm"], 51.282051282051282, 1e-9);
  EXPECT_NEAR(found["plane_normal"][0], 0, 1e-9);
  EXPECT_NEAR(found["plane_normal"][1], s, 1e-9);
  EXPECT_NEAR(found["plane_normal"][2], c, 1e-9);
  EXPECT_NEAR(found["plane_offset_mm"], -2000 * c, 1e-6);
  EXPECT_NEAR(found["hinge_line"]["point_mm"][1], -3377.4990747593107, 1e-5);
  EXPECT_NEAR(found["hinge_line"]["point_mm"][2], -50, 1e-12);
  EXPECT_NEAR(found["scheimpflug_line"]["point_mm"][1], -3464.1016151377546, 1e-5);
  EXPECT_NEAR(found["scheimpflug_line"]["point_mm"][2], 0, 1e-12);
  EXPECT_NEAR(found["scheimpflug_line"]["direction"][0], 1, 1e-9);
  ASSERT_EQ(found["blur_um"].size(), 4u);
  for (const json& blur : found["blur_um"]) {
    EXPECT_LT(std::abs(blur["predicted"].get<double>()), 1e-6);
    EXPECT_TRUE(blur["traced"].is_null());  // an ideal lens has no rays
  }
  EXPECT_LT(found["rms_um"], 1e-6);
  EXPECT_GT(found["before"]["rms_um"], 40);
}

TEST_F(TiltShift, NumbersEqualTheLibrary) {
  const std::string id = "double_gauss_100mm_f2_28deg";
  const petzval::Lens lens = petzval::with_f_number(petzval::testing::data_lens(id), 4);
  const auto targets = targets_of(table);
  for (const std::string model : {"thin", "thick"}) {
    SCOPED_TRACE(model);
    const petzval::IdealLens ideal = model == "thin" ? petzval::thin_lens(lens) : petzval::thick_lens(lens);
    const auto before = petzval::autofocus(ideal, targets);
    const auto after = petzval::fit_tilt(ideal, targets, {.film = before.film});
    const json found = gauss(table, {"--model", model});
    EXPECT_EQ(found["before"]["film_z_mm"], before.film.z());
    EXPECT_EQ(found["film_z_mm"], after.film.z());
    EXPECT_EQ(found["film_tilt_deg"], petzval::degrees(after.film.tilt_rad));
    EXPECT_EQ(found["film_swing_deg"], petzval::degrees(after.film.swing_rad));
    std::vector<petzval::ScenePoint> points;
    for (const petzval::FocusTarget& target : targets) points.push_back(target.point);
    const auto traced = petzval::exact_blurs(lens, after.film, points, 4096);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      EXPECT_EQ(found["blur_um"][i]["predicted"], 1e3 * after.blurs[i].blur_mm);
      ASSERT_TRUE(traced[i]);
      EXPECT_NEAR(found["blur_um"][i]["traced"], 1e3 * traced[i]->signed_diameter, 1e-2 * 1e3 * traced[i]->rms_radius);
    }
  }
}

TEST_F(TiltShift, ReportsTheUseOfEveryPoint) {
  const std::string points = R"([{"position_mm": [-200, -100, -1000]}, {"position_mm": [200, -100, -1000]},
    {"position_mm": [0, 150, -1400]}, {"position_mm": [0, 0, 500]}, {"position_mm": [0, 0, -20]},
    {"position_mm": [10, 20, -1300], "weight": 0}, {"position_mm": [0, 3000, -1000]}])";
  const json all = result(thin_50, points);
  EXPECT_EQ(all["use"], json::array({"used", "used", "used", "no_image", "no_image", "no_weight", "used"}));
  const json framed = result(thin_50, points, {"--film", "36x24"});
  EXPECT_EQ(framed["use"],
            json::array({"used", "used", "used", "no_image", "no_image", "no_weight", "outside_picture"}));
  for (const std::size_t i : {3u, 4u, 6u}) {
    EXPECT_TRUE(framed["blur_um"][i]["predicted"].is_null()) << i;
    EXPECT_TRUE(framed["blur_um"][i]["traced"].is_null()) << i;
  }
  EXPECT_TRUE(framed["blur_um"][5]["predicted"].is_number());
  EXPECT_EQ(framed["rank"], "plane");
}

TEST_F(TiltShift, AcceptsPointsAtInfinityAndBlurs) {
  const json far = result(thin_50, R"([{"position_mm": [0, -150, -1000]}, {"position_mm": [100, -150, -3000]},
    {"position_mm": [0, 0.1, -2], "at_infinity": true}])");
  EXPECT_EQ(far["status"], "solved");
  for (const json& blur : far["blur_um"]) EXPECT_LT(std::abs(blur["predicted"].get<double>()), 1e-6);
  const json blurred = result(thin_50, R"([{"position_mm": [0, 0, -1000], "blur_mm": 0.05}])");
  EXPECT_NEAR(blurred["blur_um"][0]["predicted"], 50, 1e-6);
  // Now the point lies beyond the plane of focus.
  EXPECT_GT(blurred["plane_offset_mm"], -1000);
  const json infinity = result(thin_50, R"([{"position_mm": [0, 0, -1], "at_infinity": true}])");
  EXPECT_TRUE(infinity["plane_normal"].is_null());
  EXPECT_TRUE(infinity["plane_offset_mm"].is_null());
}

TEST_F(TiltShift, WritesOnlyThreePictures) {
  const auto outcome = run("tilt", command(thin_50, table, {}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(path("out"))) names.insert(file.path().filename());
  EXPECT_EQ(names, (std::set<std::string>{"thin_lens_side.svg", "thin_lens_before.svg", "thin_lens_after.svg"}));
  EXPECT_TRUE(read(path("out/thin_lens_before.svg")).starts_with("<svg"));
  EXPECT_TRUE(read(path("out/thin_lens_after.svg")).starts_with("<svg"));
  EXPECT_NE(read(path("out/thin_lens_before.svg")), read(path("out/thin_lens_after.svg")));
  const std::string svg = read(path("out/thin_lens_side.svg"));
  EXPECT_TRUE(svg.starts_with("<svg"));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  for (const std::string& name : names) EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
}

}  // namespace
