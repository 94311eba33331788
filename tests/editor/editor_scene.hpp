// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/editor/focus_editor.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::testing {

/// A wall, tilted about the vertical axis, behind the pixels of a picture, and above it the sky, in the lens frame.
inline FocusScene wall_scene() {
  FocusScene scene{.columns = 800, .rows = 600, .vertical_angle_rad = radians(30)};
  scene.lens = [](const CameraSetup& setup) {
    const LensSource& lens = setup.lens;
    if (lens.thin_mm > 0) return compile(thin_elements(lens.thin_mm, setup.f_number.value()));
    return data_lens(lens.file + (lens.configuration.empty() ? "" : ':' + lens.configuration));
  };
  scene.place = [](const Ray<double>& ray, double) -> std::optional<FocusPlace> {
    const Vec3<double> along = ray.direction / -ray.direction.z;  // from the pinhole in the origin
    if (along.y > std::tan(radians(10))) return FocusPlace{{along, true}};
    if (along.y < std::tan(radians(-14.5))) return std::nullopt;
    return FocusPlace{{along * (3000 / (1 - 0.5 * along.x))}};
  };
  return scene;
}

inline CameraSetup thin_50(double f_number = 2) { return {.lens = {.thin_mm = 50}, .f_number = f_number}; }

/// An event with a patch of the set-up.
inline std::string patch(const std::string& setup) { return R"({"type": "setup", "setup": )" + setup + "}"; }

inline const FocusMark& mark(const FocusEditor& editor, const std::string& id) {
  for (const FocusMark& found : editor.state().targets) {
    if (found.id == id) return found;
  }
  throw std::runtime_error("no point " + id);
}

/// All numbers of a state that a picture or a listing depends on.
inline std::vector<double> numbers(const FocusEditorState& state) {
  const Film& film = state.setup.film;
  std::vector<double> result{film.z(),
                             film.tilt_rad,
                             film.swing_rad,
                             film.width_mm,
                             film.height_mm,
                             state.f_number,
                             state.focus_mm,
                             state.time_s,
                             static_cast<double>(state.serve),
                             static_cast<double>(state.lens.iris().blades)};
  for (const LensSurface& surface : state.lens.surfaces()) {
    result.push_back(surface.vertex_z);
    result.push_back(surface.semi_diameter);
  }
  if (state.surface) {
    for (double x = -8; x <= 8; x += 4) {
      const FocalSurface::Values at = state.surface->at({x, x / 2});
      result.insert(result.end(), {at.inverse_distance, at.extent_stops});
    }
  }
  for (const FocusMark& point : state.targets) {
    result.push_back(point.blur_px.value_or(-1e30));
    result.push_back(point.fade);
    if (!point.place_mm) continue;
    for (int i = 0; i < 3; ++i) result.push_back((*point.place_mm)[i]);
  }
  return result;
}

}  // namespace petzval::testing
