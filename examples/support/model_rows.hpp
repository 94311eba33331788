// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "camera_setup.hpp"
#include "cli.hpp"
#include "files.hpp"
#include "load_lens.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/film.hpp"

namespace examples {

/// Command line of the programs that compare models.
struct ModelOptions {
  CameraFlags setup;
  std::uint32_t columns = 0, rows = 0;  ///< 0: not given
  bool json = false;

  petzval::Film film() const { return setup.sized_film(columns, rows, 3840); }
};
void add_model_options(App& app, ModelOptions& options);

/// The lens of the options at the d line, stopped down and focused.
LoadedLens focused_lens(const ModelOptions& options);
/// The conditions in one line: "f/2, focused at 3000 mm from the front vertex, ...".
std::string conditions(const petzval::Lens& lens, const ModelOptions& options);

/// A model's row in the printed tables. Models that cannot be built have no row.
struct ModelRow {
  petzval::ModelKind model{};
  double rms_um = 0, p99_um = 0, max_um = 0, rms_px = 0, max_px = 0;
  double pupil_shape_error = 0, exposure_error = 0, ns_per_ray = 0, setup_ms = 0, cost = 0;
  bool on_front = false;  ///< no other row is as cheap and more accurate (max_um), or cheaper and as accurate
};
/// guarded: gives the bounds that are compared with budgets instead of the largest measured errors.
std::vector<ModelRow> model_rows(std::span<const petzval::ModelCandidate> table, const petzval::Film& film,
                                 bool guarded);

Json to_json(std::span<const ModelRow> rows);
std::string to_csv(std::span<const ModelRow> rows);
std::string to_text(std::span<const ModelRow> rows);
/// "  - line" for each line.
std::string bullets(std::span<const std::string> lines);

/// Prints a note for each model that could not be built.
void say_what_is_missing(std::span<const petzval::ModelCandidate> table);

}  // namespace examples
