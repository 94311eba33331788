// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "editor_scene.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using testing::mark;
using testing::patch;
using testing::thin_50;
using testing::wall_scene;

/// Distance from a thin lens of 50 mm to the image of an object at a distance.
double image_of(double distance) { return 50 * distance / (distance - 50); }

/// Diameter in mm, on a film at a distance from a lens of 50 mm f/2, of an object at a distance.
double blur_of(double film, double distance) { return 25 * (film - image_of(distance)) / image_of(distance); }

TEST(FocusEditor, FollowsOnePointByDistance) {
  FocusEditor editor(wall_scene(), thin_50());
  EXPECT_NEAR(editor.state().setup.film.z(), 50, 1e-9);
  editor.apply(R"({"type": "add_point", "id": "near", "position_mm": [100, 50, -2000]})");
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(2000), 1e-9);
  EXPECT_NEAR(editor.state().focus_mm, 2000, 1e-6);
  EXPECT_NEAR(mark(editor, "near").blur_px.value(), 0, 1e-9);
  editor.apply(R"({"type": "add_point", "id": "far", "position_mm": [0, 0, -8000]})");
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(8000), 1e-9);
  EXPECT_EQ(mark(editor, "near").status, "no_weight");
  const Film& film = editor.state().setup.film;
  EXPECT_NEAR(mark(editor, "near").blur_px.value(), blur_of(film.z(), 2000) / film.pixel_mm(), 1e-9);
}

TEST(FocusEditor, ShowsTheAngleOfTheScene) {
  FocusEditor editor(wall_scene(), thin_50());
  for (const double distance : {500.0, 3000.0, 1e6}) {
    editor.apply(patch(R"({"focus_mm": )" + std::to_string(distance) + "}"));
    const Film& film = editor.state().setup.film;
    EXPECT_NEAR(film.height_mm, 2 * std::tan(radians(15)) * film.z(), 1e-9) << distance;
    EXPECT_NEAR(film.width_mm, film.height_mm * 4 / 3, 1e-12);
  }
}

TEST(FocusEditor, TiltedFilmMeetsThreePoints) {
  FocusEditor editor(wall_scene(), thin_50());
  for (const char* const pixel : {"[100, 300]", "[700, 200]", "[400, 560]"}) {
    editor.apply(std::string(R"({"type": "add_point", "pixel": )") + pixel + "}");
  }
  editor.apply(R"({"type": "serve", "by": "tilt"})");
  EXPECT_EQ(editor.state().status, "solved");
  // The wall turns about the vertical axis, and the film with it: depth = 3000 + x / 2 on the wall.
  EXPECT_NEAR(editor.state().setup.film.tilt_rad, 0, 1e-9);
  EXPECT_GT(std::abs(editor.state().setup.film.swing_rad), 1e-3);
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(3000), 1e-8);
  EXPECT_NEAR(std::tan(editor.state().setup.film.swing_rad), -0.5 * (image_of(3000) - 50) / 50 * 50 / 50, 2e-4);
  for (const FocusMark& point : editor.state().targets) EXPECT_NEAR(point.blur_px.value(), 0, 1e-6) << point.id;
  editor.apply(R"({"type": "serve", "by": "film"})");
  EXPECT_EQ(editor.state().setup.film.swing_rad, 0);
}

TEST(FocusEditor, FocalSurfaceMeetsAnyPoints) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "id": "a", "position_mm": [-500, 0, -2000]})");
  editor.apply(R"({"type": "add_point", "id": "b", "position_mm": [300, 200, -9000], "blur_px": 3})");
  editor.apply(R"({"type": "add_point", "id": "c", "position_mm": [300, -300, -3000], "extent_stops": 1})");
  editor.apply(R"({"type": "serve", "by": "surface"})");
  editor.apply(patch(R"({"focal_surface": {"beta": 4}})"));
  ASSERT_TRUE(editor.state().surface);
  EXPECT_NEAR(mark(editor, "a").blur_px.value(), 0, 1e-6);
  // The pupil of the extent interpolates between 0 and 1 stop at b; requested diameters are of the open pupil.
  EXPECT_NEAR(mark(editor, "b").blur_px.value(), 3, 0.5);
  EXPECT_NEAR(mark(editor, "c").blur_px.value(), 0, 1e-6);
  EXPECT_EQ(editor.state().camera().model(), ModelKind::thin);
  EXPECT_LT(editor.state().camera().focal_steepness(), 1);
}

TEST(FocusEditor, ReachesARequestedBlurInPixels) {
  for (const char* const by : {"film", "tilt"}) {
    for (const double blur : {-6.0, 4.0}) {
      FocusEditor editor(wall_scene(), thin_50());
      editor.apply(R"({"type": "add_point", "pixel": [400, 300], "blur_px": )" + std::to_string(blur) + "}");
      editor.apply(std::string(R"({"type": "serve", "by": ")") + by + "\"}");
      EXPECT_NEAR(editor.state().targets[0].blur_px.value(), blur, 1e-9) << by;
      const double film = editor.state().setup.film.z();
      EXPECT_NEAR(blur_of(film, 3000) / editor.state().setup.film.pixel_mm(), blur, 1e-6);
    }
  }
}

TEST(FocusEditor, ExactRaysAreSharpestOnTheFilmOfARealLens) {
  for (const char* const name : {"double_gauss_52mm_f1.8", "defocus_control_135mm_f2", "zoom_14-30mm_f4"}) {
    FocusEditor editor(wall_scene(), {.lens = {.file = name}});
    editor.apply(R"({"type": "add_point", "position_mm": [0, 0, -3000]})");
    editor.apply(R"({"type": "serve", "by": "film"})");
    const FocusEditorState& state = editor.state();
    const std::array<ScenePoint, 1> point{{{editor.to_lens({0, 0, -3000})}}};
    const auto radius = [&](double move) {
      Film film = state.setup.film;
      film.z_mm = film.z() + move;
      return exact_blurs(state.lens, film, point)[0].value().rms_radius;
    };
    EXPECT_LT(radius(0), radius(0.02)) << name;
    EXPECT_LT(radius(0), radius(-0.02)) << name;
    EXPECT_NEAR(state.targets[0].blur_px.value(), 0, 3) << name;
    // The best film is found with samples of rays: 6 mm at the subject are less than 2 um at the film of 52 mm.
    EXPECT_NEAR(state.focus_mm, -editor.to_lens({0, 0, -3000}).z, 6) << name;
  }
}

TEST(FocusEditor, PointFollowsItsTriangle) {
  FocusScene scene = wall_scene();
  scene.vertex = [](std::size_t vertex, double time) {
    return Vec3<double>(vertex == 1 ? 300 : 0, vertex == 2 ? 300 : 0, -2000 - 500 * time);
  };
  scene.place = [](const Ray<double>&, double) {
    return FocusPlace{.point = {{100, 100, -2000}}, .triangle = TrianglePoint{{0, 1, 2}, {1. / 3, 1. / 3, 1. / 3}}};
  };
  FocusEditor editor(scene, thin_50());
  editor.apply(R"({"type": "add_point", "pixel": [500, 250]})");
  for (const double time : {0.0, 1.0, 3.0}) {
    editor.apply(R"({"type": "time", "time_s": )" + std::to_string(time) + "}");
    EXPECT_NEAR(editor.state().setup.film.z(), image_of(2000 + 500 * time), 1e-9) << time;
    EXPECT_NEAR(editor.state().targets[0].place_mm->x, 100, 1e-9);
  }
}

TEST(FocusEditor, KeysAreMetAndJoined) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "id": 7, "position_mm": [0, 0, -2000]})");
  editor.apply(R"({"type": "key", "time_s": 0})");
  editor.apply(R"({"type": "move_point", "id": 7, "position_mm": [0, 0, -6000]})");
  editor.apply(R"({"type": "key", "time_s": 2})");
  EXPECT_EQ(editor.key_times(), (std::vector<double>{0, 2}));
  const auto focus_at = [&](double time) {
    editor.apply(R"({"type": "time", "time_s": )" + std::to_string(time) + "}");
    return editor.state().focus_mm;
  };
  EXPECT_NEAR(focus_at(0), 2000, 1e-6);
  EXPECT_NEAR(focus_at(2), 6000, 1e-6);
  EXPECT_NEAR(focus_at(9), 6000, 1e-6);
  EXPECT_NEAR(focus_at(1), 3000, 1);  // half of the way in inverse distance
  // A move between keys holds until the time changes.
  editor.apply(R"({"type": "move_point", "id": 7, "position_mm": [0, 0, -2500]})");
  EXPECT_NEAR(editor.state().focus_mm, 2500, 1e-6);
  EXPECT_NEAR(focus_at(1), 3000, 1);
}

TEST(FocusEditor, DistanceByHandHasKeysToo) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(patch(R"({"focus_mm": 1000})"));
  editor.apply(R"({"type": "key", "time_s": 0})");
  editor.apply(patch(R"({"focus_mm": null})"));
  editor.apply(R"({"type": "key", "time_s": 1})");
  EXPECT_TRUE(std::isinf(editor.state().focus_mm));
  editor.apply(R"({"type": "time", "time_s": 0.5})");
  EXPECT_NEAR(editor.state().focus_mm, 2000, 1);
}

TEST(FocusEditor, PointsFadeOutsideThePictureUnlessSwitchedOff) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "id": "in", "position_mm": [0, 0, -2000]})");
  editor.apply(R"({"type": "add_point", "id": "out", "position_mm": [0, 0, -5000]})");
  editor.apply(R"({"type": "key", "time_s": 0})");
  editor.apply(R"({"type": "move_point", "id": "out", "position_mm": [9000, 0, -5000]})");
  editor.apply(R"({"type": "key", "time_s": 1})");
  editor.apply(R"({"type": "serve", "by": "film"})");
  editor.apply(R"({"type": "time", "time_s": 0})");
  editor.apply(R"({"type": "time", "time_s": 1})");
  EXPECT_NEAR(mark(editor, "out").fade, std::exp(-1 / 0.2), 1e-4);
  editor.apply(R"({"type": "time", "time_s": 4})");
  EXPECT_EQ(mark(editor, "out").status, "hidden");
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(2000), 1e-9);
  editor.apply(R"({"type": "weighting", "fade": false})");
  editor.apply(R"({"type": "time", "time_s": 9})");
  EXPECT_NEAR(mark(editor, "out").fade, 1, 1e-6);
  EXPECT_LT(editor.state().setup.film.z(), image_of(2000) - 0.1);
}

TEST(FocusEditor, NearerPointsWeighMoreIfAsked) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "position_mm": [0, 0, -2000]})");
  editor.apply(R"({"type": "add_point", "position_mm": [0, 100, -8000]})");
  editor.apply(R"({"type": "serve", "by": "film"})");
  const double equal = editor.state().setup.film.z();
  editor.apply(R"({"type": "weighting", "nearer": true})");
  EXPECT_GT(editor.state().setup.film.z(), equal + 0.1);
}

TEST(FocusEditor, StatusTellsWhyAPointIsNotServed) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "serve", "by": "film"})");
  EXPECT_EQ(editor.state().status, "no_targets");
  editor.apply(R"({"type": "add_point", "id": "behind", "position_mm": [0, 0, 100]})");
  editor.apply(R"({"type": "add_point", "id": "hole", "pixel": [400, 595]})");
  EXPECT_EQ(mark(editor, "behind").status, "no_image");
  EXPECT_FALSE(mark(editor, "behind").blur_px);
  EXPECT_EQ(mark(editor, "hole").status, "no_depth");
  EXPECT_FALSE(mark(editor, "hole").place_mm);
  EXPECT_EQ(editor.state().status, "no_targets");
  editor.apply(R"({"type": "serve", "by": "distance"})");
  EXPECT_EQ(editor.state().status, "no_targets");
  editor.apply(R"({"type": "serve", "by": "film"})");
  editor.apply(R"({"type": "add_point", "id": "sky", "pixel": [400, 20]})");
  EXPECT_EQ(mark(editor, "sky").status, "used");
  EXPECT_NEAR(editor.state().setup.film.z(), 50, 1e-9);
  // Nearer than the focal length: the film stays.
  editor.apply(R"({"type": "serve", "by": "distance"})");
  editor.apply(patch(R"({"focus_mm": 4000})"));
  editor.apply(R"({"type": "add_point", "id": "macro", "position_mm": [0, 0, -40]})");
  EXPECT_EQ(editor.state().status, "unreachable");
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(4000), 1e-9);
}

TEST(FocusEditor, ChangesTheLens) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(patch(R"({"focus_mm": 3000})"));
  editor.apply(patch(R"({"f_number": 1})"));
  EXPECT_NEAR(pupils(editor.state().lens).entrance.diameter, 50, 1e-9);
  editor.apply(patch(R"({"lens": {"file": "double_gauss_52mm_f1.8", "thin_mm": null}, "f_number": null})"));
  EXPECT_NEAR(editor.state().focus_mm, 3000, 1e-6);
  EXPECT_NEAR(editor.state().f_number, 1.8, 0.1);
  EXPECT_EQ(editor.state().camera().model(), ModelKind::exact_float);
  editor.apply(patch(R"({"f_number": 4, "iris": {"blades": 6, "rotation_rad": 0.5}})"));
  EXPECT_EQ(editor.state().f_number, 4);
  EXPECT_EQ(editor.state().lens.iris().blades, 6);
  editor.apply(
      patch(R"({"camera": {"expressive": {"power": [{"radius": 0, "power": 1}, {"radius": 1, "power": 1.01}]}}})"));
  EXPECT_EQ(editor.state().camera().model(), ModelKind::thick);
  EXPECT_EQ(editor.state().setup.camera.expressive.power.size(), 2u);
  editor.apply(patch(R"({"camera": {"bokeh": {"weight_distribution": 2}}})"));
  EXPECT_EQ(editor.state().setup.camera.bokeh.weight_distribution, 2);
}

TEST(FocusEditor, CameraOfAThinLensIsSharpAtThePoints) {
  for (const double f_number : {0.7, 1.4, 5.6}) {
    FocusEditor editor(wall_scene(), thin_50(f_number));
    for (const char* const pixel : {"[400, 300]", "[100, 200]", "[500, 560]"}) {
      editor.apply(std::string(R"({"type": "add_point", "pixel": )") + pixel + "}");
    }
    editor.apply(R"({"type": "serve", "by": "tilt"})");
    const Film& film = editor.state().setup.film;
    const Camera& camera = editor.state().camera();
    for (const FocusMark& point : editor.state().targets) {
      // All rays of the film point pass through the scene point.
      const Vec3<double> there = editor.to_lens(*point.place_mm);
      for (const double u : {0.1, 0.4, 0.7}) {
        const CameraRay ray =
            camera.sample({.film = film.point(point.raster->x, point.raster->y), .pupil_u = u, .pupil_v = 0.8});
        ASSERT_TRUE(ray);
        const double run = (there.z - ray.ray.origin.z) / ray.ray.direction.z;
        const Vec3<double> at = ray.ray.origin + ray.ray.direction * run;
        EXPECT_LT(std::hypot(at.x - there.x, at.y - there.y), 1e-7) << f_number << ' ' << point.id;
        const Importance back = camera.importance({ray.ray.origin, -ray.ray.direction});
        EXPECT_NEAR(back.raster.x, point.raster->x, 1e-6);
        EXPECT_NEAR(back.we / (back.pdf_position * back.pdf_direction), ray.weight, 2e-3 * ray.weight);
      }
    }
  }
}

TEST(FocusEditor, SetUpMakesTheCameraOfTheState) {
  const FocusScene scene = wall_scene();
  for (const CameraSetup& lens : {thin_50(), CameraSetup{.lens = {.file = "double_gauss_52mm_f1.8"}}}) {
    for (const std::string by : {"distance", "film", "tilt", "surface"}) {
      FocusEditor editor(scene, lens);
      editor.replay(R"([{"type": "add_point", "pixel": [300, 300], "blur_px": 2},
                        {"type": "add_point", "pixel": [500, 200], "extent_stops": 1},
                        {"type": "setup", "setup": {"f_number": 4.5, "iris": {"blades": 5}}},
                        {"type": "serve", "by": ")" +
                    by + "\"}]");
      const CameraSetup setup = camera_setup(to_json(editor.state().setup), by);
      const Camera again = camera(setup, prepared(setup, scene.lens(setup)));
      EXPECT_EQ(setup.focus_mm, editor.state().focus_mm) << by;
      for (const double u : {0.1, 0.5, 0.8}) {
        const CameraSample sample{.film = {7 * u, 4 - 6 * u}, .pupil_u = u, .pupil_v = 1 - u};
        const CameraRay one = editor.state().camera().sample(sample), two = again.sample(sample);
        EXPECT_TRUE(one.ray.origin == two.ray.origin && one.ray.direction == two.ray.direction) << by;
        EXPECT_EQ(one.weight, two.weight) << by;
      }
    }
  }
}

TEST(FocusEditor, TiltByHandKeepsTheDistanceOnTheAxis) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(patch(R"({"focus_mm": 3000})"));
  editor.apply(patch(R"({"film": {"tilt_rad": 0.05, "swing_rad": -0.03}})"));
  EXPECT_NEAR(editor.state().setup.film.z(), image_of(3000), 1e-9);
  EXPECT_NEAR(editor.state().setup.film.tilt_rad, 0.05, 1e-12);
  editor.apply(patch(R"({"film": {"tilt_rad": 0.02}})"));
  EXPECT_NEAR(editor.state().setup.film.swing_rad, -0.03, 1e-12);
}

TEST(FocusEditor, SceneFrameHasAnyPose) {
  FocusScene turned = wall_scene();
  turned.position = {500, 600, 700};
  turned.right = {0, 0, -1}, turned.up = {0, 1, 0}, turned.back = {1, 0, 0};  // looks along -x of the scene
  for (const CameraSetup& lens : {thin_50(), CameraSetup{.lens = {.file = "double_gauss_52mm_f1.8"}}}) {
    FocusEditor editor(turned, lens), plain(wall_scene(), lens);
    editor.apply(R"({"type": "add_point", "position_mm": [-2500, 620, 680]})");
    plain.apply(R"({"type": "add_point", "position_mm": [20, 20, -3000]})");
    EXPECT_NEAR(editor.state().setup.film.z(), plain.state().setup.film.z(), 1e-9);
    EXPECT_NEAR(editor.state().targets[0].raster->x, plain.state().targets[0].raster->x, 1e-6);
    const Vec3<double> there = editor.to_scene(editor.to_lens({1, 2, 3}));
    EXPECT_NEAR(there.x, 1, 1e-9);
    EXPECT_NEAR(there.z, 3, 1e-9);
  }
}

}  // namespace
}  // namespace petzval
