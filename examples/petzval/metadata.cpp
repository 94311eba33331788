// SPDX-License-Identifier: Apache-2.0
// Writes the data of a lens at its stop and focus for compositing and virtual production: a lens sample of OpenTrackIO,
// and ST maps that remove and restore its distortion.
//
//   petzval metadata data/lenses/biogon_35mm_f2.8.json --f-number 4 --focus 2000 --out out
#include "commands.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/exports/lens_metadata.hpp"
#include "petzval/image/exr.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/lens_light.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::number;

struct Options {
  std::string out_folder;
  examples::CameraFlags setup;
  std::string coatings;  // empty: the coatings of the file
  examples::Output output;
};

void write(const Options& options) {
  examples::LensFile source = examples::read_lens(options.setup.lens);
  const double primary_nm = examples::light_of(source).primary_nm;  // as in `petzval report`
  const examples::LoadedLens loaded = examples::compiled(std::move(source), std::array{primary_nm});
  petzval::Lens lens = examples::focused(loaded, options.setup);
  if (const auto coated = examples::coated(lens, options.coatings)) lens = *coated;
  const auto [width, height] = std::array{options.setup.film.width_mm, options.setup.film.height_mm};
  constexpr int columns = 1920, most_rows = 8 * columns;
  const double rows = std::round(columns * height / width);  // pixels are square
  if (!(rows >= 1 && rows <= most_rows)) {
    throw petzval::Error("--film = \"" + number(width) + 'x' + number(height) + "\"; the height must be 1/" +
                         number(columns) + " to " + number(most_rows / columns) + " times the width");
  }
  const petzval::Film film{.width_mm = width, .height_mm = height, .columns = columns, .rows = static_cast<int>(rows)};
  const petzval::LensDistortion distortion(petzval::Camera(lens, film, {.model = petzval::ModelKind::exact_double}));
  const petzval::LensIdentity identity = petzval::identity_of(loaded.prescription);
  examples::make_folder(options.out_folder);
  const std::filesystem::path stem = std::filesystem::path(options.out_folder) / loaded.id;
  const auto written = [&](const std::string& ending, const auto& write_to) {
    const std::filesystem::path file = stem.string() + ending;
    write_to(file);
    options.output.file(file);
  };

  const petzval::BrownConrady fit = petzval::fit_brown_conrady(distortion);
  if (!options.output.json) {
    std::cout << "pinhole " << number(fit.pinhole.focal_length_mm.y, 6) << " mm in front of its film, field "
              << number(petzval::degrees(fit.field_rad), 3) << " degrees; Brown-Conrady within "
              << number(fit.largest_px, 2) << " pixels of " << film.columns << " x " << film.rows
              << "; beyond this field the coefficients extrapolate, up to "
              << number(petzval::degrees(fit.rises_to_rad), 3) << " degrees\n";
  }
  const petzval::LensState state = petzval::lens_state(distortion);
  if (!options.output.json) {
    std::cout << "f/" << number(state.f_number, 4) << ", f/" << number(state.area_f_number, 4)
              << " by the area of the pupil, "
              << (state.t_number ? "T" + number(*state.t_number, 4) : "no T-stop: losses are not modelled") << '\n';
  }
  written(".opentrackio.json", [&](const auto& file) { petzval::write_open_track_io(lens, film, identity, file); });
  written(".stmap.exr",
          [&](const auto& file) { petzval::write_st_map(lens, film, identity, file, {}, examples::threads()); });
  options.output.report({{"lens", lens.name()},
                         {"pinhole_focal_length_mm", fit.pinhole.focal_length_mm.y},
                         {"columns", film.columns},
                         {"rows", film.rows},
                         {"field_deg", petzval::degrees(fit.field_rad)},
                         {"rms_px", fit.rms_px},
                         {"largest_px", fit.largest_px},
                         {"rises_to_deg", petzval::degrees(fit.rises_to_rad)},
                         {"f_number", examples::finite_or_null(state.f_number)},
                         {"area_f_number", examples::finite_or_null(state.area_f_number)},
                         {"t_stop", examples::or_null(state.t_number)}});
}

}  // namespace

int commands::metadata(int argc, char** argv) {
  Options options;
  examples::App app(
      "Writes the lens sample at its stop and focus as DIR/LENS.opentrackio.json, and the ST maps of its distortion as "
      "DIR/LENS.stmap.exr. Prints the fit of the Brown-Conrady coefficients.",
      "petzval metadata");
  examples::add_lens(app, options.setup.lens);
  examples::add_camera(app, options.setup);
  examples::add_coatings(app, options.coatings,
                         "the coatings of the file; if it states none, the files have no T-stop");
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder, "folder for the files")->required();
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] { write(options); });
}
