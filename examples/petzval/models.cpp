// SPDX-License-Identifier: Apache-2.0
// Prints errors and times of every model of a lens, and the fastest model within each of four error budgets.
//
//   petzval models data/lenses/double_gauss_52mm_f1.8.json
//   petzval models data/lenses/double_gauss_52mm_f1.8.json --f-number 4 --json --out out
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/parallel.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/model_rows.hpp"
#include "support/text.hpp"

namespace {

constexpr std::array budgets_px{4.0, 1.0, 0.25, 0.05};

struct Options : examples::ModelOptions {
  std::string out_folder;
};

/// Half the focus distance, in front of the lens. Infinity is replaced by 100 focal lengths.
double nearest_mm(const petzval::Lens& lens, const Options& options) {
  const double far = 100 * std::abs(petzval::first_order(lens, 0, petzval::main_meridian(lens)).effective_focal_length);
  const double half = std::min(*options.setup.focus_mm, far) / 2;
  // Macro: if half the distance is inside the lens, use the midpoint between its front and the focus.
  const double front = petzval::origin_z(lens, options.setup.focus.origin);
  return half > front ? half : (front + std::min(*options.setup.focus_mm, far)) / 2;
}

std::string figure(const std::vector<examples::ModelRow>& rows, const petzval::Lens& lens, const Options& options) {
  std::vector<petzval::ParetoPoint> points;
  for (const examples::ModelRow& row : rows) {
    points.push_back({petzval::name(row.model), row.ns_per_ray, row.max_um, row.rms_um, row.on_front});
  }
  return petzval::pareto_figure(lens.name(), examples::conditions(lens, options), points);
}

}  // namespace

int commands::models(int argc, char** argv) {
  Options options;
  examples::App app(
      "Compares every model of a lens with exact rays in double. Prints a row for each model: errors of rays on the "
      "film (RMS, 99 %, maximum), error of the pupil's shape (symmetric difference divided by area), largest error of "
      "the exposure over the film, ns per ray in batches on one thread, set-up time, and the expected time of a ray in "
      "rays of a thin lens (cost), which is the same on all machines. Ray errors cover planes from "
      "half the focus distance to infinity, and the plane in focus; at infinity they are angles times the focal "
      "length. Then chooses the fastest model for ray errors of at most 4, 1, 0.25 and 0.05 pixels and pupil errors "
      "of at most 10 %. --json prints only the rows.\n"
      "front: no other model has both a lower cost and a lower error (max_um). At the d line (587.5618 nm).\n"
      "--out writes DIR/LENS_accuracy_speed.csv and .svg and prints their paths (with --json on standard error).",
      "petzval models");
  examples::add_model_options(app, options);
  const auto* out = examples::add_out_folder(app, options.out_folder, "folder for the table and the figure");

  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    const petzval::Film film = options.film();
    const examples::LoadedLens loaded = examples::focused_lens(options);
    const petzval::Lens& lens = loaded.lens;
    const std::filesystem::path folder = options.out_folder;
    const examples::Output output{options.json};
    if (out->given()) examples::make_folder(folder);  // fail before the measurement, which takes seconds
    examples::say_what_does_not_fit(lens, film, "--size");
    std::vector<petzval::ErrorBudget> budgets;
    for (const double px : budgets_px) budgets.push_back({.max_px = px});
    const double nearest = nearest_mm(lens, options);
    const auto choices = petzval::choose_models(
        lens, {.near_mm = nearest, .film = film, .origin = options.setup.focus.origin}, budgets, examples::threads());
    const auto& table = choices.front().table;
    examples::say_what_is_missing(table);
    const auto rows = examples::model_rows(table, film, false);

    if (out->given()) {
      const auto write = [&](const char* kind, const std::string& text) {
        const auto file = folder / (loaded.id + "_accuracy_speed." + kind);
        examples::write_text(file, text);
        output.file(file);
      };
      write("csv", examples::to_csv(rows));
      write("svg", figure(rows, lens, options));
    }
    if (options.json) return output.report(examples::to_json(rows));
    std::cout << lens.name() << "\n"
              << examples::conditions(lens, options) << "\nerrors from " << examples::number(nearest, 6)
              << " mm to infinity, and at the focus\n\n"
              << examples::to_text(rows);
    for (std::size_t k = 0; k < choices.size(); ++k) {
      std::cout << '\n'
                << examples::number(budgets_px[k]) << " px: " << petzval::name(choices[k].model) << '\n'
                << examples::bullets(choices[k].reasons);
      if (choices[k].not_needed.empty()) continue;
      std::cout << "  not needed:\n" << examples::bullets(choices[k].not_needed);
    }
  });
}
