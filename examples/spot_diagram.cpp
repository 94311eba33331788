// SPDX-License-Identifier: Apache-2.0
// Spot diagrams: the hits of a point's rays on the film, for several field angles and wavelengths.
//
//   spot_diagram data/lenses/cooke_triplet_50mm_f5.json --field-deg 0,14,20 --wavelengths-nm 486.1,587.6,656.3 --out
//   out
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/units.hpp"
#include "petzval/figure/spot_figure.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/psf/spot.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;

/// A kilometre. Beyond 1e150 mm the squares of hits would overflow.
constexpr examples::Range film_shift{-1e6, 1e6, "a number from -1000000 to 1000000"};

struct Options {
  examples::LensInput lens_file;
  std::string out_folder;
  std::vector<double> field_deg, wavelengths_nm;
  double subject_mm = std::numeric_limits<double>::infinity(), defocus_mm = 0;
  std::uint32_t samples = 4096;
};

std::vector<petzval::Spot> spots(const petzval::Lens& lens, const Options& options) {
  std::vector<double> fields;
  for (const double degrees : options.field_deg) fields.push_back(petzval::radians(degrees));
  return petzval::spot_diagram(lens, -options.subject_mm, fields, options.samples);
}

/// The field of a spot as given, without a conversion to radians and back. Spots are ordered by field.
double field_deg(const Options& options, std::size_t spot) {
  return options.field_deg[spot / options.wavelengths_nm.size()];
}

std::string hits_csv(const std::vector<petzval::Spot>& all, const Options& options) {
  std::string csv = "field_deg,wavelength_nm,x_mm,y_mm\n";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string start = examples::number(field_deg(options, i)) + ',' +
                              examples::number(options.wavelengths_nm[all[i].wavelength]) + ',';
    for (std::size_t k = 0; k < all[i].hits.x.size(); ++k) {
      csv += start + examples::number(all[i].hits.x[k]) + ',' + examples::number(all[i].hits.y[k]) + '\n';
    }
  }
  return csv;
}

Json to_json(const std::vector<petzval::Spot>& all, const petzval::Lens& lens, const Options& options) {
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json rows = Json::array();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const petzval::Spot& spot = all[i];
    const bool empty = spot.hits.x.empty();  // no ray passes: no size
    rows.push_back({{"field_deg", field_deg(options, i)},
                    {"wavelength_nm", options.wavelengths_nm[spot.wavelength]},
                    {"chief_ray_height_mm", or_null(spot.chief_ray_height)},
                    {"relative_illumination", or_null(spot.relative_illumination)},
                    {"rms_radius_mm", empty ? Json(nullptr) : Json(spot.size.rms_radius)},
                    {"max_radius_mm", empty ? Json(nullptr) : Json(spot.size.max_radius)},
                    {"reference", "centroid"},
                    {"rays_sent", spot.hits.sent},
                    {"rays_transmitted", spot.hits.x.size()},
                    {"film_z_mm", lens.film_z()},
                    {"dispersion", petzval::name(lens.dispersion())}});
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  examples::App app(
      "Draws spot diagrams. The film stands at the paraxial image of the subject at the primary wavelength (the "
      "one nearest to the d line, 587.5618 nm), plus --defocus-mm.\n"
      "Writes to DIR, and prints the paths: LENS_spots.svg, LENS_spots.csv (the hits: "
      "field_deg,wavelength_nm,x_mm,y_mm) and LENS_spots.json (one row per field and wavelength: height of the chief "
      "ray "
      "through the centre of the stop; illumination of the film relative to the axis; RMS and largest radius about the "
      "centroid; null if no such ray exists).",
      "spot_diagram");
  examples::add_lens(app, options.lens_file);
  examples::add_numbers(app, "--field-deg", options.field_deg, examples::finite_number,
                        "field angles towards +y, in object space at the paraxial entrance pupil (degrees)")
      ->required();
  examples::add_numbers(app, "--wavelengths-nm", options.wavelengths_nm, examples::positive_number, "wavelengths (nm)")
      ->required();
  examples::add_number(app, "--subject-distance-mm", options.subject_mm, examples::positive_length,
                       "distance of the subject from the front vertex (mm), or inf");
  examples::add_number(app, "--defocus-mm", options.defocus_mm, film_shift,
                       "shift of the film away from the lens (mm), -1000000 to 1000000");
  examples::add_samples(app, options.samples);
  app.add_option("--out", options.out_folder, "folder for the results")->required()->type_name("DIR");

  return examples::run(app, argc, argv, [&] {
    const auto loaded = examples::load_lens(options.lens_file, options.wavelengths_nm);
    const double image_z =
        petzval::with_focus(loaded.lens, options.subject_mm, {.criterion = petzval::FocusCriterion::paraxial}).film_z();
    const petzval::Lens lens = petzval::with_film(loaded.lens, image_z + options.defocus_mm);
    const auto all = spots(lens, options);

    const std::filesystem::path folder = options.out_folder;
    const auto write = [&](const char* kind, const std::string& text) {
      const auto file = folder / (loaded.id + "_spots." + kind);
      examples::write_text(file, text);
      std::cout << file.string() << '\n';
    };
    const std::string figure = petzval::spot_figure(lens, all);
    examples::make_folder(folder);
    write("svg", figure);
    write("csv", hits_csv(all, options));
    write("json", to_json(all, lens, options).dump(1) + '\n');
  });
}
