// SPDX-License-Identifier: Apache-2.0
// Draws spot diagrams: film points of the rays of a field point, for several field angles and wavelengths.
//
//   petzval spots data/lenses/cooke_triplet_50mm_f5.json --fields 0,14,20 --wavelengths 486.1,587.6,656.3 --out
//   out
#include "commands.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/focus/focus.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;

/// A kilometre. Beyond 1e150 mm the squares of film points would overflow.
constexpr examples::Range film_shift{-1e6, 1e6, "a number from -1000000 to 1000000"};

struct Options {
  examples::CameraFlags setup;
  std::string out_folder, film = "focus";
  std::vector<double> field_deg, wavelengths_nm;  // empty: the fields and wavelengths of the file
  double subject_mm = 0, defocus_mm = 0;
  bool film_given = false, subject_given = false;
  std::uint32_t samples = 4096;
  examples::Output output;
};

/// The lens and all other inputs of its spots.
struct Setting {
  examples::LoadedLens loaded;
  petzval::Lens lens;  ///< stopped down, with its film
  examples::ReportLight light;
  examples::ReportFields fields;
  double subject_mm = 0;
  petzval::DistanceOrigin origin{};
  bool film_of_file = false;
};

Setting setting_of(const Options& options) {
  examples::LensFile file = examples::read_lens(options.setup.lens);
  examples::ReportLight light;
  if (options.wavelengths_nm.empty()) {
    light = examples::light_of(file);
  } else {
    light = {.wavelengths_nm = options.wavelengths_nm,
             .weights = std::vector<double>(options.wavelengths_nm.size(), 1)};
  }
  const std::optional<double> primary = light.of_file ? std::optional(light.primary_nm) : std::nullopt;
  examples::LoadedLens loaded = examples::compiled(std::move(file), light.wavelengths_nm, primary);
  petzval::FocusOptions focus = options.setup.focus;
  double subject_mm = options.subject_mm;
  if (!options.subject_given) {
    focus.origin = petzval::DistanceOrigin::front_vertex;
    subject_mm = loaded.prescription.design.object_distance_mm;
  }
  petzval::Lens lens = examples::stopped_down(loaded.lens, options.setup);
  bool film_of_file = options.film == "file";
  if (!film_of_file) try {
      lens = examples::for_flag("--at", [&] { return petzval::with_focus(lens, subject_mm, focus); });
    } catch (const petzval::Error& error) {
      // Field lenses and eyepieces: the film of the file may lie on or before the last vertex.
      if (options.subject_given || options.film_given) throw;
      film_of_file = true;
      examples::note(std::string(error.what()) + "; the film of the file is used");
    }
  if (options.defocus_mm != 0) lens = petzval::with_film(lens, lens.film_z() + options.defocus_mm);
  examples::ReportFields fields{options.field_deg, false};
  if (fields.degrees.empty()) fields = examples::fields_of(loaded, loaded.lens);
  return {std::move(loaded), std::move(lens), std::move(light), std::move(fields),
          subject_mm,        focus.origin,    film_of_file};
}

petzval::Grid<petzval::Spot> spots(const Setting& setting, bool fields_given, std::uint32_t samples) {
  const double subject_z = petzval::origin_z(setting.lens, setting.origin) - setting.subject_mm;
  std::vector<double> fields;
  for (const double degrees : setting.fields.degrees) {
    fields.push_back(petzval::radians(degrees));
    const petzval::FieldPoint point{fields.back(), subject_z};
    if (fields_given) {
      examples::want_light(setting.lens, point, "--fields");
    } else if (!examples::reached_by_light(setting.lens, point)) {
      examples::note("the file has a field of " + examples::number(degrees) + " degrees, from which no light passes");
    }
  }
  return petzval::spot_diagram(setting.lens, subject_z, fields, samples);
}

std::string hits_csv(const petzval::Grid<petzval::Spot>& all, const Setting& setting) {
  std::string csv = "field_deg,wavelength_nm,x_mm,y_mm\n";
  for (std::size_t field = 0; field < all.size(); ++field) {
    for (const petzval::Spot& spot : all[field]) {
      const std::string start = examples::number(setting.fields.degrees[field]) + ',' +
                                examples::number(setting.light.wavelengths_nm[spot.wavelength]) + ',';
      for (std::size_t k = 0; k < spot.x.size(); ++k) {
        csv += start + examples::number(spot.x[k]) + ',' + examples::number(spot.y[k]) + '\n';
      }
    }
  }
  return csv;
}

Json to_json(const petzval::Grid<petzval::Spot>& all, const Setting& setting, const Options& options) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < all.values.size(); ++i) {
    const petzval::Spot& spot = all.values[i];
    const bool empty = spot.x.empty();  // no ray passes
    rows.push_back({{"field_deg", setting.fields.degrees[i / all.columns]},
                    {"wavelength_nm", setting.light.wavelengths_nm[spot.wavelength]},
                    {"wavelength_weight", setting.light.weights[spot.wavelength]},
                    {"chief_ray_height_mm", examples::or_null(spot.chief_ray_height)},
                    {"relative_illumination", examples::or_null(spot.relative_illumination)},
                    {"rms_radius_mm", empty ? Json(nullptr) : Json(spot.size.rms_radius)},
                    {"max_radius_mm", empty ? Json(nullptr) : Json(spot.size.max_radius)},
                    {"reference", "centroid"},
                    {"rays_sent", spot.sent},
                    {"rays_transmitted", spot.x.size()},
                    {"film_z_mm", setting.lens.film_z()},
                    {"film", setting.film_of_file ? "file" : "focus"},
                    {"criterion", setting.film_of_file ? Json() : Json(petzval::name(options.setup.focus.criterion))},
                    {"subject_distance_mm", examples::finite_or_null(setting.subject_mm)},
                    {"distance_from", petzval::name(setting.origin)},
                    {"dispersion", petzval::name(setting.lens.dispersion())}});
  }
  return rows;
}

}  // namespace

int commands::spots(int argc, char** argv) {
  Options options;
  examples::App app(
      "Draws spot diagrams. The film is at the focus of the subject, or with --film-position file at the position in "
      "the file; "
      "--defocus shifts it. The focus is computed at the primary wavelength of the file, or at the wavelength "
      "nearest to the d line (587.5618 nm).\n"
      "Writes to DIR and prints the paths: LENS_spots.svg, LENS_spots.csv (film points of rays: "
      "field_deg,wavelength_nm,x_mm,y_mm) and LENS_spots.json. Its rows have for each field and wavelength the height "
      "of the chief ray, the illumination of the film relative to the axis, and the RMS and maximum radius about the "
      "centroid; values are null if no ray passes.",
      "petzval spots");
  examples::add_lens(app, options.setup.lens);
  examples::add_numbers(app, "--fields", options.field_deg, examples::field_angle,
                        "field angles towards +y, in object space at the paraxial entrance pupil (degrees)")
      ->default_str("fields of the file, else the axis, 0.7 and 1 of the declared half field");
  examples::add_wavelengths(app, "--wavelengths", options.wavelengths_nm, "wavelengths")
      ->default_str("wavelengths of the file, with their weights, else F, d and C");
  examples::add_f_number(app, options.setup);
  auto* subject = examples::add_length(app, "--at", options.subject_mm, examples::positive_length,
                                       "distance of the subject (mm), or inf")
                      ->default_str("subject of the file");
  examples::add_focus(app, options.setup.focus);
  const auto* film = examples::add_film_choice(app, options.film, options.film);
  examples::add_length(app, "--defocus", options.defocus_mm, film_shift,
                       "shift of the film away from the lens (mm), -1000000 to 1000000");
  examples::add_samples(app, options.samples);
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder)->required();

  return examples::run(app, argc, argv, [&] {
    options.subject_given = subject->given();
    options.film_given = film->given();
    const Setting setting = setting_of(options);
    const auto all = spots(setting, !options.field_deg.empty(), options.samples);

    const std::filesystem::path folder = options.out_folder;
    const auto write = [&](const char* kind, const std::string& text) {
      const auto file = folder / (setting.loaded.id + "_spots." + kind);
      examples::write_text(file, text);
      options.output.file(file);
    };
    const std::string figure = petzval::spot_figure(setting.lens, all, setting.light.weights);
    examples::make_folder(folder);
    write("svg", figure);
    write("csv", hits_csv(all, setting));
    const Json rows = to_json(all, setting, options);
    write("json", rows.dump(1) + '\n');
    options.output.report(rows);
  });
}
