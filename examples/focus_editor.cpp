// SPDX-License-Identifier: Apache-2.0
// Focus control without a window: points in a picture with depths, films that serve them, undo, and the log of events.
//
//   focus_editor
#include <cmath>
#include <exception>
#include <iostream>
#include <optional>

#include "petzval/core/geometry.hpp"
#include "petzval/editor/focus_editor.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"

namespace {

using namespace petzval;

/// A floor 1 m below the lens in front of a wall 6 m away.
std::optional<FocusPlace> floor_and_wall(const Ray<double>& ray, double) {
  const Vec3<double> along = ray.direction / -ray.direction.z;
  const double to_floor = along.y < 0 ? -1000 / along.y : INFINITY;
  return FocusPlace{.point = {ray.origin + along * std::fmin(to_floor, 6000)}};
}

void print(const char* what, const FocusEditorState& state) {
  const Film& film = state.setup.film;
  std::cout << what << ": film at " << film.z() << " mm, tilt " << degrees(film.tilt_rad)
            << " degrees, focus on the axis " << state.focus_mm << " mm\n";
  for (const FocusMark& mark : state.targets) {
    std::cout << "  " << mark.id << ": " << mark.status;
    if (mark.blur_px) std::cout << ", blur " << *mark.blur_px << " px";
    std::cout << '\n';
  }
}

void run() {
  FocusScene scene{.columns = 800, .rows = 600};
  scene.lens = [](const CameraSetup& setup) { return compile(read_prescription(*find_lens(setup.lens.file))); };
  scene.place = floor_and_wall;

  FocusEditor editor(scene, {.lens = {.file = "double_gauss_52mm_f1.8"}});
  editor.apply(R"({"type": "add_point", "id": "floor", "pixel": [200, 590]})");
  print("one point", editor.state());

  editor.apply(R"({"type": "add_point", "id": "left", "pixel": [100, 450]})");
  editor.apply(R"({"type": "add_point", "id": "right", "pixel": [700, 450]})");
  editor.apply(R"({"type": "serve", "by": "film"})");
  print("upright film", editor.state());

  editor.apply(R"({"type": "serve", "by": "tilt"})");
  print("tilted film", editor.state());

  editor.apply(R"({"type": "undo"})");
  print("undo", editor.state());

  editor.apply(R"({"type": "setup", "setup": {"f_number": 4}})");
  print("f/4", editor.state());
  std::cout << "events: " << editor.log() << '\n';
}

}  // namespace

int main() {
  try {
    run();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
