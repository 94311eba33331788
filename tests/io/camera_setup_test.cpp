// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/json.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace {

using nlohmann::json;
using testing::expect_error;

/// Converts to every type, to count the members of an aggregate.
struct Any {
  template <class T>
  operator T() const {
    std::abort();  // never runs
  }
};
template <class T, std::size_t... i>
constexpr std::size_t count_members(std::index_sequence<i...>) {
  if constexpr (requires { T{(void(i), Any{})..., Any{}}; }) {
    return count_members<T>(std::make_index_sequence<sizeof...(i) + 1>());
  } else {
    return sizeof...(i);
  }
}
template <class T>
constexpr std::size_t members_of = count_members<T>(std::index_sequence<>());

/// A set-up in which no value is a default, but for the lens, which is given once.
json full_setup() {
  json full = json::parse(R"({
    "format": "petzval-camera 2",
    "lens": {"file": "", "thin_mm": 0, "configuration": "0", "glass_files": ["a.agf", "b\"\u00b5.yml"],
      "glasses": [{"catalogue": "own", "name": "X-1", "nd": 1.8333333333333335, "vd": 60.1, "formula": 7,
        "shortest_nm": 380, "longest_nm": 800, "coefficients": [0.38, 1.6, 0.8, 1.5],
        "absorption": [{"wavelength_nm": 500, "per_mm": 1e-5}]}],
      "match_glasses": true, "require_glasses": true, "clamp_wavelengths": true,
      "wavelengths_nm": [486.1, 587.5618, 656.3], "primary_nm": 486.1},
    "f_number": 5.6, "iris": {"blades": 7, "roundness": -0.1, "rotation_rad": 0.30000000000000004},
    "coating": {"layers": [{"index": 1.38, "absorption": 1e-4, "thickness_nm": 99.6}]},
    "focus_mm": null,
    "focus": {"criterion": "paraxial", "origin": "film", "fields": [{"field_rad": 0.1, "weight": 2}],
      "wavelength_weights": [1, 0.5, 1]},
    "film": {"width_mm": 23.6, "height_mm": 15.7, "columns": 640, "rows": 427, "shift_x_mm": 1, "shift_y_mm": -2,
      "margin_mm": 0.5, "z_mm": 101.25, "tilt_rad": 3.3333333333333335e-4, "swing_rad": -5e-324, "travel_mm": 0.1},
    "camera": {"model": "polynomial_7", "normalisation": "unity_at_each_wavelength",
      "bokeh": {"blades": 6, "lens_ratio": 1.5, "rate_of_change": 0.4, "keep_light": true, "weight_distribution": 4,
        "weight_strength": 0.8, "map_keeps_mean": true},
      "expressive": {"power": [{"radius": 0.5, "power": 1.01}],
        "film_offsets": [{"film_point": {"x": 3, "y": 4}, "offset_mm": 0.2, "weight": 3}], "dispersion": [0.5]}, "paraxial_focus": true,
      "transmission": true, "clamp_wavelengths": true, "importance_tables": true},
    "iris_map": "map.png",
    "focal_points": [{"film_point": {"x": 1, "y": -2}, "inverse_distance": 3.3333333333333335e-4, "blur_mm": 0.01,
      "extent_stops": 1, "weight": 0.5, "fade": 0.25}],
    "focal_surface": {"kind": "shepard", "beta": 4, "default_inverse_distance": 1e-4}})");
  full["lens"]["prescription"] = json::parse(format_prescription(testing::data_prescription("achromat_100mm")));
  return full;
}

/// Paths of the values of `full` that are equal in `other`.
void equal_values(const json& full, const json& other, const std::string& path, std::vector<std::string>& found) {
  if (full.is_object() && other.is_object()) {
    for (const auto& [key, value] : full.items()) {
      if (other.contains(key)) equal_values(value, other[key], path + '.' + key, found);
    }
  } else if (full == other) {
    found.push_back(path);
  }
}

TEST(CameraSetup, EveryMemberIsReadBackToTheBit) {
  const json full = full_setup();
  const CameraSetup setup = camera_setup(full.dump(), "full.json");
  EXPECT_EQ(json::parse(to_json(setup)), full);
  EXPECT_EQ(setup.lens.prescription, testing::data_prescription("achromat_100mm"));
  EXPECT_EQ(setup.film.swing_rad, -std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(setup.focus_mm, std::numeric_limits<double>::infinity());
  // A value that is a default would hide a member that is not read.
  std::vector<std::string> defaults;
  equal_values(full, json::parse(to_json({.lens = {.file = "double_gauss_52mm_f1.8"}})), "", defaults);
  EXPECT_EQ(defaults, (std::vector<std::string>{".format", ".lens.thin_mm"}));
  for (const LensSource& lens : {LensSource{.file = "double_gauss_52mm_f1.8"}, LensSource{.thin_mm = 50}}) {
    const std::string text = to_json({.lens = lens, .f_number = 2});
    EXPECT_EQ(to_json(camera_setup(text, "lens.json")), text);
  }
}

TEST(CameraSetup, JsonHasEveryMember) {
  const json full = full_setup(), &camera = full["camera"];
  EXPECT_EQ(full.size(), members_of<CameraSetup> + 1);  // the format
  EXPECT_EQ(full["lens"].size(), members_of<LensSource>);
  EXPECT_EQ(full["lens"]["glasses"][0].size(), members_of<Glass>);
  EXPECT_EQ(full["iris"].size(), members_of<Iris>);
  EXPECT_EQ(full["focus"].size(), members_of<FocusOptions>);
  EXPECT_EQ(full["film"].size(), members_of<Film>);
  EXPECT_EQ(camera.size(), members_of<CameraOptions> - 2);  // threads, and the surface of the focal points
  EXPECT_EQ(camera["bokeh"].size(), members_of<BokehControls>);
  EXPECT_EQ(camera["expressive"].size(), members_of<ExpressiveLens>);
  EXPECT_EQ(camera["expressive"]["film_offsets"][0].size(), members_of<FilmOffset>);
  EXPECT_EQ(full["focal_points"][0].size(), members_of<FocalPoint>);
  EXPECT_EQ(full["focal_surface"].size(), members_of<FocalSurfaceOptions>);
}

TEST(CameraSetup, ReportsAndMissingKeysAreRead) {
  const std::string text = to_json({.lens = {.file = "achromat_100mm"}});
  const std::string few = R"({"format": "petzval-camera 2", "lens": {"file": "achromat_100mm"}})";
  EXPECT_EQ(to_json(camera_setup(few, "few.json")), text);
  EXPECT_EQ(to_json(camera_setup(R"({"spp": [1, 2], "setup": )" + few + "}", "report.json")), text);
}

TEST(CameraSetup, CamerasHaveTheSameRays) {
  CameraSetup setup{.lens = {.file = "double_gauss_52mm_f1.8"}, .f_number = 2.8, .focus_mm = 2000};
  setup.iris.blades = 6, setup.film.tilt_rad = 0.05, setup.camera.model = ModelKind::thick;
  setup.focal_points = {{.film_point = {-9, 0}, .inverse_distance = 1e-3}, {.film_point = {9, 0}, .extent_stops = 1}};
  Lens lens = compile(testing::data_prescription("double_gauss_52mm_f1.8"));
  lens = with_focus(with_f_number(with_iris(lens, {.blades = 6}), 2.8), 2000);
  const Film film{.z_mm = lens.film_z(), .tilt_rad = 0.05};
  const FocalSurface surface(thick_lens(lens), film, setup.focal_points);
  const Camera by_hand(lens, film, {.model = ModelKind::thick, .focal_surface = surface});
  for (const Camera& made : {camera(setup), camera(camera_setup(to_json(setup), "setup.json"))}) {
    for (double u = 0.05; u < 1; u += 0.1) {
      const CameraSample sample{.film = {20 * u - 9, 8 * u}, .pupil_u = u, .pupil_v = 1 - u};
      const CameraRay one = by_hand.sample(sample), two = made.sample(sample);
      EXPECT_EQ(one.ray.origin, two.ray.origin);
      EXPECT_EQ(one.ray.direction, two.ray.direction);
      EXPECT_EQ(one.weight, two.weight);
    }
  }
}

TEST(CameraSetup, BadInputIsRefusedByPosition) {
  const auto refused = [](const std::string& members, const std::vector<testing::Token>& tokens) {
    const std::string text = "{\"format\": \"petzval-camera 2\",\n" + members + "}";
    expect_error([&] { camera_setup(text, "bad.json"); }, tokens);
  };
  const std::string lens = "\"lens\": {\"file\": \"achromat_100mm\"},\n";
  refused(lens + R"("fstop": 2)", {"bad.json:3:1", "fstop", "f_number"});
  refused(lens + R"("film": {"width_mm": -1})", {"bad.json:3:22", "width_mm", -1, 0});
  refused(lens + R"("film": {"columns": 1.5})", {"bad.json:3:21", "columns", 1.5, 1});
  refused(lens + R"("focus_mm": 0)", {"bad.json:3:13", "focus_mm", 0});
  refused(lens + R"("camera": {"model": "fisheye"})", {"bad.json:3:21", "model", "fisheye", "exact_double"});
  refused(lens + R"("camera": {"model": 3})", {"bad.json:3:21", "model", 3});
  refused(lens + R"("iris": [])", {"bad.json:3:9", "iris", "object"});
  refused(R"("f_number": 2)", {"bad.json", "lens", 0, 1});
  refused(R"("lens": {"file": "achromat_100mm", "thin_mm": 50}, "f_number": 2)", {"bad.json:2:9", "lens", 2, 1});
  refused(R"("lens": {"thin_mm": 50})", {"bad.json:2:21", "f_number"});
  expect_error([] { compile(CameraSetup{.lens = {.file = "gone.json"}}); }, {"lens", "file", "gone.json"});
  const std::string prescription = R"("lens": {"prescription": {"format": "petzval-lens 1", "surfaces": [{"radius": )";
  refused(prescription + R"("x", "thickness": 1}]}})", {"bad.json:2:79", "surface 0", "radius", "x"});
  refused(prescription + R"(1, "thickness": 1, "nd": 9}]}})", {"bad.json:2:104", "surface 0", "nd", 9});
  expect_error([] { camera_setup("{}", "bad.json"); }, {"bad.json", "format"});
  expect_error([] { camera_setup("[]", "bad.json"); }, {"bad.json", "object"});
  expect_error([] { camera_setup(R"({"setup": {"format": "petzval-camera 1"}})", "bad.json"); },
               {"bad.json:1:22", "petzval-camera 2"});
}

TEST(CameraSetup, ValuesThatJsonCannotHoldAreRefused) {
  CameraSetup setup{.lens = {.file = "achromat_100mm"}};
  setup.camera.bokeh.weight_map.values = {1};
  expect_error([&] { to_json(setup); }, {"weight_map", "iris_map"});
  setup.iris_map = "map.png", setup.camera.bokeh.weight_map.values.clear();
  expect_error([&] { camera(setup); }, {"iris_map", "map.png"});
}

}  // namespace
}  // namespace petzval
