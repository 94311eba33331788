// SPDX-License-Identifier: Apache-2.0
#include "movement_setup.hpp"

#include <algorithm>
#include <cmath>

#include "camera_setup.hpp"
#include "cli.hpp"
#include "iris_setup.hpp"
#include "load_lens.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {

void add_movement_options(App& app, MovementOptions& options) {
  add_lens(app, options.lens_file, "LENS", "may be omitted for a thin lens");
  app.add_option("--model", options.model,
                 "model of the lens: thin (one plane), thick (cardinal points and pupils), real (exact rays)")
      ->one_of({"thin", "thick", "real"})
      ->default_str("real");
  add_thin_lens(app, options.focal_length_mm);
  add_number(app, "--f-number", options.f_number, positive_number, "f-number to stop the lens down to (by exact rays)")
      ->default_str("wide open");
  app.add_option(
         "--film",
         [&options](const std::string& text) {
           options.film_mm = text;
           options.film_given = true;
         },
         "width and height of the film (mm); if given, points outside the picture are ignored")
      ->type_name("WxH")
      ->default_str(options.film_mm);
}

MovingLens moving_lens(const MovementOptions& options) {
  MovingLens result;
  const auto [width, height] = parse_size("--film", options.film_mm, film_side);
  result.film = {.width_mm = width, .height_mm = height};
  if (options.focal_length_mm > 0) {
    if (!options.lens_file.file.empty()) {
      throw petzval::Error("--thin-lens cannot be combined with the lens file " + options.lens_file.file + " (LENS)");
    }
    if (options.model_name() != "thin") {
      throw petzval::Error("--thin-lens with --model " + options.model + "; must be --model thin");
    }
    if (!(options.f_number > 0)) throw petzval::Error("--thin-lens needs --f-number");
    result.id = "thin_lens";
    result.title = "Thin lens, " + number(options.focal_length_mm) + " mm";
    result.conditions = "f/" + number(options.f_number, 3);
    result.ideal = petzval::thin_lens(options.focal_length_mm, options.f_number);
    return result;
  }
  if (options.lens_file.file.empty()) {
    throw petzval::Error("LENS is required, or --thin-lens F --f-number N");
  }
  const LoadedLens loaded = load_lens(options.lens_file, std::array{petzval::d_line_nm});
  petzval::Lens lens = loaded.lens;
  if (options.f_number > 0) lens = stopped_to(lens, options.f_number);
  result.id = loaded.id;
  result.title = lens.name();
  result.conditions = "f/" + number(petzval::real_f_number(lens), 3) + ", " + options.model_name() + " model";
  result.ideal = options.model_name() == "thin" ? petzval::thin_lens(lens) : petzval::thick_lens(lens);
  result.exact = options.model_name() == "real";
  result.lens = std::move(lens);
  return result;
}

const char* in_words(petzval::TargetStatus status) {
  switch (status) {
    case petzval::TargetStatus::used: return "";
    case petzval::TargetStatus::no_weight: return "shown only: its weight is 0";
    case petzval::TargetStatus::not_finite: return "left out: not a number";
    case petzval::TargetStatus::no_image: return "left out: no film can reach its image";
    case petzval::TargetStatus::outlier: return "an outlier: given no weight";
    case petzval::TargetStatus::no_rays: return "left out: no ray of the point passes the lens";
  }
  return "";
}

}  // namespace examples
