// SPDX-License-Identifier: Apache-2.0
#include "movement_setup.hpp"

#include <algorithm>
#include <cmath>

#include "camera_setup.hpp"
#include "cli.hpp"
#include "load_lens.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {

void add_movement_options(App& app, MovementOptions& options) {
  add_lens(app, options.setup.lens, "LENS", "may be omitted for a thin lens");
  app.add_option("--model", options.model,
                 "model of the lens: thin (one plane), thick (cardinal points and pupils), real (exact rays)")
      ->one_of({"thin", "thick", "real"})
      ->default_str("real");
  add_thin_lens(app, options.setup.lens.thin_mm);
  add_f_number(app, options.setup);
  add_film(app, options.setup, "width and height of the film (mm); if given, points outside the picture are ignored");
}

MovingLens moving_lens(const MovementOptions& options) {
  MovingLens result;
  const petzval::LensSource& source = options.setup.lens;
  const std::optional<double> f_number = options.setup.f_number;
  result.film = options.setup.film;
  if (source.thin_mm > 0) {
    if (!source.file.empty()) {
      throw petzval::Error("--thin-lens cannot be combined with the lens file " + source.file + " (LENS)");
    }
    if (options.model_name() != "thin") {
      throw petzval::Error("--thin-lens with --model " + options.model + "; must be --model thin");
    }
    if (!f_number) throw petzval::Error("--thin-lens needs --f-number");
    result.id = "thin_lens";
    result.title = "Thin lens, " + number(source.thin_mm) + " mm";
    result.conditions = "f/" + number(*f_number, 3);
    result.ideal = petzval::thin_lens(source.thin_mm, *f_number);
    return result;
  }
  if (source.file.empty()) {
    throw petzval::Error("LENS is required, or --thin-lens F --f-number N");
  }
  const LoadedLens loaded = load_lens(source, std::array{petzval::d_line_nm});
  petzval::Lens lens = stopped_down(loaded.lens, options.setup);
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
