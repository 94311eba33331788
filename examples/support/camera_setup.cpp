// SPDX-License-Identifier: Apache-2.0
#include "camera_setup.hpp"

#include <iostream>

#include "cli.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lint/lint.hpp"

namespace examples {

std::array<double, 2> CameraSetup::film_size() const { return parse_size("--film-mm", film_mm, positive_number); }

void add_camera(App& app, CameraSetup& setup) {
  add_iris(app, setup.iris);
  add_number(
      app, "--focus-mm", setup.focus_mm, positive_length,
      "distance of the subject in focus from the film (mm), or inf; at the primary of the wavelengths in use: the one "
      "nearest to the d line, unless the lens states its reference");
  add_criterion(app, setup.criterion);
  app.add_option("--film-mm", setup.film_mm, "width and height of the film (mm)")
      ->type_name("WxH")
      ->capture_default_str();
}

Option* add_distance_origin(App& app, CameraSetup& setup) {
  return app.add_option("--distance-from", setup.origin, "origin of --focus-mm")
      ->one_of({"front_vertex", "film"})
      ->capture_default_str();
}

Option* add_model(App& app, std::string& model) {
  std::vector<std::string> names;
  for (const petzval::ModelKind m : petzval::models()) names.emplace_back(petzval::name(m));
  return app.add_option("--model", model, "model of the lens")->one_of(names);
}

std::array<double, 2> parse_size(const std::string& where, std::string_view text, const Range& range) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) {
    throw petzval::Error(where + ": found \"" + std::string(text.substr(0, 60)) + "\", wanted a size like 36x24");
  }
  return {parse_number(where, text.substr(0, x), range), parse_number(where, text.substr(x + 1), range)};
}

petzval::Lens focused(const LoadedLens& loaded, const CameraSetup& setup) {
  return petzval::with_focus(
      stopped_down(loaded.lens, setup.iris), setup.focus_mm,
      {.criterion = named(setup.criterion, focus_criteria), .origin = named(setup.origin, distance_origins)});
}

void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film, bool has_pixels) {
  for (const petzval::Finding& finding : petzval::lint(lens, film)) {
    if (has_pixels || finding.kind == petzval::FindingKind::film_size) {
      std::cerr << "note: " << finding.message << '\n';
    }
  }
}

}  // namespace examples
