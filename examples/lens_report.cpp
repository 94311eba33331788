// SPDX-License-Identifier: Apache-2.0
// Prints the first-order data of a lens, its pupils and f-numbers, and the doubtful entries of its prescription. With
// --out it draws the lens, its spots, pupils, focus and brightness, and makes a page of them.
//
//   lens_report data/lenses/double_gauss_100mm_f1.35.json
//   lens_report data/lenses/double_gauss_100mm_f1.35.json --json --wavelength-nm 486.1327
//   lens_report data/lenses/double_gauss_100mm_f1.35.json --out out --field-deg 0,6,12 --f-number 2
#include <array>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/lens_page.hpp"
#include "support/lens_report.hpp"
#include "support/load_lens.hpp"

namespace {

struct Options {
  examples::LensInput lens_file;
  double wavelength_nm = petzval::d_line_nm;
  bool wavelength_given = false;
  bool json = false;
  double f_number = 0;    // 0: wide open
  double subject_mm = 0;  // 0: at infinity, with the film of the prescription
  std::string out_folder;
  std::vector<double> field_deg;
};

/// The lens, stopped down and focused.
petzval::Lens set(petzval::Lens lens, const Options& options) {
  if (options.f_number > 0) lens = petzval::with_f_number(lens, options.f_number);
  return options.subject_mm > 0
             ? petzval::with_focus(lens, options.subject_mm, {.criterion = petzval::FocusCriterion::paraxial})
             : lens;
}

examples::LoadedLens load(const Options& options) {
  examples::LoadedLens loaded = examples::load_lens(options.lens_file, std::array{options.wavelength_nm});
  loaded.lens = set(loaded.lens, options);
  return loaded;
}

/// F, d and C if the dispersion is known and no wavelength is given.
std::vector<double> figure_wavelengths(const Options& options, const petzval::Lens& lens) {
  if (options.wavelength_given || lens.dispersion() == petzval::Dispersion::none) {
    return {options.wavelength_nm};
  }
  return {486.1327, petzval::d_line_nm, 656.2725};
}

void write_page(const examples::Report& report, const Options& options) {
  const auto colours = examples::compiled_for(report.loaded, figure_wavelengths(options, report.loaded.lens));
  examples::PageOptions page{.field_deg = options.field_deg, .colours = set(colours, options)};
  if (options.subject_mm > 0) page.subject_mm = options.subject_mm;
  const auto figures = examples::lens_figures(report, page);

  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  const auto write = [&](const std::string& ending, const std::string& text) {
    const auto file = folder / (report.loaded.id + ending);
    examples::write_text(file, text);
    std::cout << file.string() << '\n';
  };
  for (const examples::LensFigure& figure : figures) write('_' + figure.name + ".svg", figure.svg);
  write(".html", examples::lens_page(report, figures));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  examples::App app(
      "Reports the first-order data, pupils, f-numbers and lint findings of a lens, for a lens with cylinders in both "
      "sections. Lengths in mm; z from the first vertex, towards the film. Findings are not failures.\n"
      "With --out: writes LENS_layout.svg (and LENS_layout_x.svg of a lens with cylinders), LENS_spots.svg, "
      "LENS_footprints.svg, LENS_focus.svg, LENS_illumination.svg and LENS.html, a page with all of them, to DIR, and "
      "prints their paths instead.",
      "lens_report");
  examples::add_lens(app, options.lens_file);
  app.add_flag("--json", options.json, "print one JSON object; null is an infinite or absent value");
  const auto* wavelength =
      examples::add_number(app, "--wavelength-nm", options.wavelength_nm, examples::positive_number,
                           "wavelength (nm); without it figures show F, d and C");
  examples::add_number(app, "--f-number", options.f_number, examples::positive_number,
                       "stop the lens down to this f-number")
      ->default_str("wide open");
  examples::add_number(
      app, "--subject-distance-mm", options.subject_mm, examples::positive_length,
      "put the film at the paraxial image of a subject at this distance from the front vertex (mm), or "
      "inf")
      ->default_str("infinity, with the film of the prescription");
  auto* out = app.add_option("--out", options.out_folder, "draw figures and a page in this folder")->type_name("DIR");
  examples::add_numbers(app, "--field-deg", options.field_deg, examples::finite_number,
                        "fields of the figures (degrees)")
      ->default_str("the axis, 0.7 and 1 of the declared half field")
      ->needs(out);
  out->excludes("--json");

  return examples::run(app, argc, argv, [&] {
    options.wavelength_given = wavelength->given();
    const examples::Report report = examples::report(load(options));
    if (out->given()) return write_page(report, options);
    std::cout << (options.json ? examples::to_json(report).dump(2) + '\n' : examples::to_text(report));
  });
}
