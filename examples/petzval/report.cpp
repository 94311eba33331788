// SPDX-License-Identifier: Apache-2.0
// Prints the first-order data of a lens, its pupils and f-numbers, and doubtful entries of its prescription. With --out
// it draws the lens, its spots, pupils, focus and brightness, and combines them in a page.
//
//   petzval report data/lenses/double_gauss_100mm_f1.35.json
//   petzval report data/lenses/double_gauss_100mm_f1.35.json --json --wavelengths 486.1327
//   petzval report data/lenses/double_gauss_100mm_f1.35.json --out out --fields 0,6,12 --f-number 2
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/apertures.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/lens_light.hpp"
#include "support/lens_page.hpp"
#include "support/lens_report.hpp"
#include "support/load_lens.hpp"

namespace {

struct Options {
  examples::CameraFlags setup;
  std::optional<int> first_surface_number;  // nullopt: as the file counts
  std::vector<double> wavelengths_nm;       // empty: of the file
  double subject_mm = 0;
  bool subject_given = false, json = false;
  std::string film, out_folder;
  std::vector<double> field_deg;
  std::string coatings;  // empty: the coatings of the file
};

/// Subject, film and light from the command line; by default from the file.
examples::ReportSubject subject_of(const examples::LensFile& file, const Options& options) {
  examples::ReportSubject subject{.focus = options.setup.focus};
  const petzval::DesignData& design = file.prescription.design;
  const bool designed =
      std::isfinite(design.object_distance_mm) || !design.wavelengths.empty() || !design.fields.empty();
  subject.distance_of_file = !options.subject_given && designed;
  if (options.subject_given) {
    subject.distance_mm = options.subject_mm;
  } else {
    subject.focus.origin = petzval::DistanceOrigin::front_vertex;
    subject.distance_mm = design.object_distance_mm;
  }
  subject.film_of_file = options.film == "file" || (options.film.empty() && !options.subject_given);
  if (const auto& nm = options.wavelengths_nm; !nm.empty()) {
    const auto from_d = [](double wavelength) { return std::abs(wavelength - petzval::d_line_nm); };
    subject.light = {.wavelengths_nm = nm,
                     .weights = std::vector<double>(nm.size(), 1),
                     .primary_nm = *std::ranges::min_element(nm, {}, from_d)};
  } else {
    subject.light = examples::light_of(file);
  }
  return subject;
}

/// The lens, stopped down and focused.
petzval::Lens set(const petzval::Lens& wide_open, const Options& options, const examples::ReportSubject& subject) {
  const petzval::Lens lens = examples::stopped_down(wide_open, options.setup);
  return subject.film_of_file ? lens : examples::for_flag("--at", [&] {
    return petzval::with_focus(lens, subject.distance_mm, subject.focus);
  });
}

examples::Report report_of(const Options& options) {
  examples::LensFile file = examples::read_lens(options.setup.lens);
  file.first_surface_number = options.first_surface_number.value_or(file.first_surface_number);
  examples::ReportSubject subject = subject_of(file, options);
  const std::array primary{subject.light.primary_nm};
  examples::LoadedLens loaded = examples::compiled(std::move(file), primary);
  const auto declared = examples::declared_pupil(loaded.prescription.design, loaded.lens);
  // Image heights refer to the film of the file.
  subject.fields = options.field_deg.empty() ? examples::fields_of(loaded, loaded.lens)
                                             : examples::ReportFields{options.field_deg, false};
  loaded.lens = set(loaded.lens, options, subject);
  if (!options.field_deg.empty() && petzval::has_pupils(loaded.lens)) {
    for (const double field : options.field_deg) {
      examples::want_light(loaded.lens, {petzval::radians(field), examples::subject_z(subject, loaded.lens)},
                           "--fields");
    }
  }
  return examples::report(std::move(loaded), std::move(subject), declared);
}

/// The lens at all wavelengths of the report, stopped down and focused. with_notes: as compiled_for().
petzval::Lens colours_of(const examples::Report& report, const Options& options, bool with_notes = true) {
  const auto& [nm, weights, primary_nm, of_file] = report.subject.light;
  const petzval::Lens lens = with_notes ? examples::compiled_for(report.loaded, nm, primary_nm)
                                        : petzval::compile(report.loaded.prescription, nm,
                                                           examples::compile_options(report.loaded, primary_nm));
  return set(lens, options, report.subject);
}

/// Light that passes the lens with --coatings or with the coatings of its file; nullopt without coatings.
std::optional<examples::LightReport> light_of(const examples::Report& report, const petzval::Lens& colours,
                                              const Options& options) {
  const auto coated = examples::coated(colours, options.coatings);
  if (!coated) return {};
  std::optional<petzval::Lens> visible = examples::visible_lens(report.loaded, *coated);
  if (visible) visible = examples::coated(set(*visible, options, report.subject), options.coatings);
  try {
    return examples::report_light(report, options.coatings == "file" ? "" : options.coatings, *coated, visible);
  } catch (const petzval::Error& error) {
    if (!options.coatings.empty()) throw;
    examples::note(std::string("the light that passes the lens is unknown: ") + error.what());
    return {};
  }
}

void write_page(const examples::Report& report, const petzval::LensReport& aberrations,
                const std::optional<examples::LightReport>& light, const Options& options) {
  const auto figures = examples::lens_figures(report, aberrations, light);

  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  const auto write = [&](const std::string& ending, const std::string& text) {
    const auto file = folder / (report.loaded.id + ending);
    examples::write_text(file, text);
    (options.json ? std::cerr : std::cout) << file.string() << '\n';
  };
  for (const examples::LensFigure& figure : figures) write('_' + figure.name + ".svg", figure.svg);
  write(".html", examples::lens_page(report, aberrations, figures, light, examples::report_ghosts(report, light)));
}

}  // namespace

int commands::report(int argc, char** argv) {
  Options options;
  examples::App app(
      "Reports the first-order data, pupils, f-numbers and lint findings of a lens, in both sections if it has "
      "cylinders, and draws with --out the layout, spots, through-focus spots, encircled energy, ray fans, wavefront, "
      "footprints, focus, MTF, colour, field curvature, distortion, Seidel sums, illumination and, with coatings, "
      "transmittance. Lengths in mm; z from the first vertex, towards the film. Findings are not failures. Subject, "
      "wavelengths with their weights, and fields are taken from the file if it has them.\n"
      "With --out: writes LENS_layout.svg (and LENS_layout_x.svg for a lens with cylinders), LENS_spots.svg, "
      "LENS_through_focus.svg, LENS_energy.svg, LENS_fans.svg, LENS_wavefront.svg, LENS_footprints.svg, "
      "LENS_focus.svg, LENS_mtf_chart.svg, LENS_mtf.svg, LENS_mtf_focus.svg, "
      "LENS_mtf_field.svg, LENS_colour.svg, LENS_field.svg, LENS_seidel.svg, LENS_illumination.svg, with coatings "
      "LENS_transmittance.svg and LENS_transmittance_field.svg, and LENS.html, a page with all of them, to DIR, and "
      "prints their paths instead; with --json on standard error.",
      "petzval report");
  examples::add_lens(app, options.setup.lens);
  app.add_option(
         "--surfaces-from", [&options](const std::string& text) { options.first_surface_number = text == "1" ? 1 : 0; },
         "number of the first surface in the report; patents count from 1")
      ->one_of({"0", "1"})
      ->default_str("1 for files of OpticStudio, CODE V, OSLO and tables, else 0");
  app.add_flag("--json", options.json, "print one JSON object; null is an infinite or absent value");
  examples::add_wavelengths(app, "--wavelengths", options.wavelengths_nm, "wavelengths")
      ->default_str("wavelengths of the file, else F, d and C; numbers at the primary one, the nearest to d of a list");
  examples::add_f_number(app, options.setup);
  const auto* subject = examples::add_length(app, "--at", options.subject_mm, examples::positive_length,
                                             "distance of the subject (mm), or inf")
                            ->default_str("distance and film of the file");
  examples::add_focus(app, options.setup.focus);
  examples::add_film_choice(app, options.film, "file; with --at focus");
  examples::add_coatings(app, options.coatings, "the coatings of the file; if it states none, losses are not modelled");
  auto* out = examples::add_out_folder(app, options.out_folder, "folder for figures and a page");
  const auto* fields = examples::add_numbers(app, "--fields", options.field_deg, examples::field_angle,
                                             "fields of --out, --json and transmittances (degrees)")
                           ->default_str("fields of the file, else the axis, 0.7 and 1 of the declared half field");
  return examples::run(app, argc, argv, [&] {
    options.subject_given = subject->given();
    const examples::Report report = report_of(options);
    if (out->given() || options.json) {
      const petzval::Lens lens = colours_of(report, options, out->given());
      const auto light = light_of(report, lens, options);
      const auto aberrations = petzval::lens_report(lens, examples::conditions(report, lens));
      if (out->given()) write_page(report, aberrations, light, options);
      if (!options.json) return;
      examples::Json json = examples::to_json(report, aberrations);
      json.update(examples::to_json(light));
      std::cout << json.dump(2) << '\n';
      return;
    }
    const bool modelled = !options.coatings.empty() || petzval::states_coatings(report.loaded.lens);
    const auto light = modelled ? light_of(report, colours_of(report, options), options) : std::nullopt;
    if (fields->given() && !light) {
      throw petzval::Error("--fields needs --out, --json or --coatings: the text alone has no fields");
    }
    std::cout << examples::to_text(report) << (light ? examples::to_text(*light) : std::string());
  });
}
