// SPDX-License-Identifier: Apache-2.0
#include "camera_setup.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/lint.hpp"
#include "text.hpp"

namespace examples {

std::array<double, 2> CameraSetup::film_size() const { return parse_size("--film", film_mm, film_side); }

petzval::Film CameraSetup::film(std::uint32_t columns, std::uint32_t rows, std::uint32_t usual_columns) const {
  constexpr double max_side_px = 16384;
  auto [width, height] = film_size();
  double across = columns, down = rows;
  if (!film_given && across > 0 && down > 0) {
    if (down > across) std::swap(width, height);
    (across * height > down * width) ? height = width* down / across : width = height * across / down;
  }
  if (across == 0 && down == 0) across = usual_columns;
  if (across == 0) across = std::max(1.0, std::round(down * width / height));
  if (down == 0) down = std::max(1.0, std::round(across * height / width));
  if ((columns == 0 || rows == 0) && std::max(across, down) > max_side_px) {
    throw petzval::Error("--film = " + film_mm + ": a picture of " + number(across) + " x " + number(down) +
                         " pixels; must have at most " + number(max_side_px) + " along each side");
  }
  return {.width_mm = width, .height_mm = height, .columns = static_cast<int>(across), .rows = static_cast<int>(down)};
}

void add_camera(App& app, CameraSetup& setup, const std::string& frames_help) {
  add_iris(app, setup.iris);
  if (frames_help.empty()) {
    add_length(app, "--focus", setup.focus_mm, positive_length,
               "distance of the subject in focus (mm), or inf; at the primary wavelength: the one nearest to the d "
               "line, unless the lens states a reference");
  } else {
    add_focus_pull(app, setup.pull, setup.focus_mm, frames_help);
  }
  add_focus(app, setup.focus);
  app.add_option(
         "--film",
         [&setup](const std::string& text) {
           setup.film_mm = text;
           setup.film_given = true;
         },
         "width and height of the film (mm)")
      ->type_name("WxH")
      ->default_str(setup.film_mm);
}

void add_picture_size(App& app, std::uint32_t& width, std::uint32_t& height, std::uint32_t usual_width) {
  constexpr Range side{1, 16384, "a whole number from 1 to 16384"};
  width = height = 0;
  app.add_option(
         "--size",
         [&width, &height, side](const std::string& text) {
           const auto count = [&](std::string_view part) {
             const double value = parse_number("--size", part, side);
             if (value != std::floor(value)) throw petzval::Error("--size = \"" + text + "\"; must be whole numbers");
             return static_cast<std::uint32_t>(value);
           };
           const std::size_t x = text.find('x');
           width = count(std::string_view(text).substr(0, x));
           height = x == std::string::npos ? 0 : count(std::string_view(text).substr(x + 1));
         },
         "pixels across and down, or across only; without --film the film takes the picture's shape within 36 x 24 mm")
      ->type_name("WxH")
      ->default_str(std::to_string(usual_width) + " across, square pixels");
}

Option* add_model(App& app, std::string& model) {
  std::vector<std::string> names;
  for (const petzval::ModelKind m : petzval::models()) names.emplace_back(petzval::name(m));
  return app.add_option("--model", model, "model of the lens")->one_of(names);
}

std::array<double, 2> parse_size(const std::string& where, std::string_view text, const Range& range) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) {
    throw petzval::Error(where + " = \"" + std::string(text.substr(0, 60)) + "\"; must be a size like 36x24");
  }
  const auto parse = where == "--film" ? parse_length : parse_number;
  return {parse(where, text.substr(0, x), range), parse(where, text.substr(x + 1), range)};
}

petzval::Lens focused(const LoadedLens& loaded, const CameraSetup& setup) {
  const petzval::Lens lens = stopped_down(loaded.lens, setup.iris);
  return for_flag("--focus", [&] { return petzval::with_focus(lens, setup.focus_mm, setup.focus.options()); });
}

void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film, const std::string& pixel_flags) {
  for (const petzval::Finding& finding : petzval::lint(lens, film)) {
    if (finding.kind == petzval::FindingKind::film_size) note(finding.message);
    if (finding.kind == petzval::FindingKind::pixel_shape && !pixel_flags.empty()) {
      note("--film and " + pixel_flags + " have different shapes: " + finding.message);
    }
  }
}

}  // namespace examples
