// SPDX-License-Identifier: Apache-2.0
#include "model_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <utility>

#include "load_lens.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// Calls use(name, value) for the numbers of a row, in the order of JSON and CSV.
template <class Use>
void for_numbers(const ModelRow& row, Use use) {
  use("rms_um", row.rms_um);
  use("p99_um", row.p99_um);
  use("max_um", row.max_um);
  use("rms_px", row.rms_px);
  use("max_px", row.max_px);
  use("pupil_shape_error", row.pupil_shape_error);
  use("exposure_error", row.exposure_error);
  use("ns_per_ray", row.ns_per_ray);
  use("setup_ms", row.setup_ms);
  use("cost", row.cost);
}

}  // namespace

void add_model_options(App& app, ModelOptions& options) {
  add_lens(app, options.setup.lens);
  add_camera(app, options.setup);
  add_picture_size(app, options.columns, options.rows, 3840);
  app.add_flag("--json", options.json, "print JSON");
}

LoadedLens focused_lens(const ModelOptions& options) {
  LoadedLens loaded = load_lens(options.setup.lens, std::array{petzval::d_line_nm});
  loaded.lens = focused(loaded, options.setup);
  return loaded;
}

std::string conditions(const petzval::Lens& lens, const ModelOptions& options) {
  const auto size = [](double a, double b) { return number(a) + " x " + number(b); };
  const petzval::Film film = options.film();
  const double focus = *options.setup.focus_mm;
  return "f/" + number(petzval::real_f_number(lens), 3) + ", focused at " +
         (std::isinf(focus) ? "infinity" : number(focus) + " mm from the " + in_words(options.setup.focus.origin)) +
         " (" + in_words(options.setup.focus.criterion) + "), film " + size(film.width_mm, film.height_mm) + " mm, " +
         size(film.columns, film.rows) + " pixels of " + number(1e3 * film.pixel_mm(), 3) + " um, " +
         number(petzval::d_line_nm, 6) + " nm";
}

std::vector<ModelRow> model_rows(std::span<const petzval::ModelCandidate> table, const petzval::Film& film,
                                 bool guarded) {
  const double um_per_px = 1e3 * film.pixel_mm();
  std::vector<ModelRow> rows;
  for (const petzval::ModelCandidate& candidate : table) {
    if (!candidate.available) continue;
    const petzval::RayErrors& rays = candidate.error.all;
    const double max_px = guarded ? candidate.bound_px : rays.max_px;
    rows.push_back({candidate.model, 1e3 * rays.rms_mm, 1e3 * rays.p99_mm, max_px * um_per_px, rays.rms_px, max_px,
                    guarded ? candidate.bound_pupil_shape : candidate.error.pupil_shape,
                    guarded ? candidate.bound_exposure : candidate.error.exposure, candidate.ns_per_ray,
                    candidate.setup_ms, candidate.cost});
  }
  for (ModelRow& row : rows) {
    row.on_front = std::ranges::none_of(rows, [&](const ModelRow& other) {
      return other.cost <= row.cost && other.max_um <= row.max_um &&
             (other.cost < row.cost || other.max_um < row.max_um);
    });
  }
  return rows;
}

Json to_json(std::span<const ModelRow> rows) {
  Json result = Json::array();
  for (const ModelRow& row : rows) {
    Json object{{"model", petzval::name(row.model)}};
    for_numbers(row, [&](const char* name, double value) { object[name] = finite_or_null(value); });
    object["on_front"] = row.on_front;
    result.push_back(std::move(object));
  }
  return result;
}

std::string to_csv(std::span<const ModelRow> rows) {
  std::string csv = "model";
  for_numbers({}, [&](const char* name, double) { csv += std::string(",") + name; });
  csv += ",on_front\n";
  for (const ModelRow& row : rows) {
    csv += petzval::name(row.model);
    for_numbers(row, [&](const char*, double value) { csv += ',' + number(value); });
    csv += row.on_front ? ",true\n" : ",false\n";
  }
  return csv;
}

std::string to_text(std::span<const ModelRow> rows) {
  std::ostringstream text;
  text << "model          rms um    99% um    max um    rms px    max px     pupil  exposure    ns/ray  setup ms    "
          "cost\n";
  for (const ModelRow& row : rows) {
    text << std::left << std::setw(13) << petzval::name(row.model) << std::right;
    for (const double value : {row.rms_um, row.p99_um, row.max_um, row.rms_px, row.max_px}) {
      text << std::setw(9) << number(value, 3) << ' ';
    }
    for (const double value : {row.pupil_shape_error, row.exposure_error}) {
      text << std::setw(8) << number(100 * value, 3) << "% ";
    }
    text << std::setw(8) << number(row.ns_per_ray, 3) << "  " << std::setw(8) << number(row.setup_ms, 3) << std::setw(8)
         << number(row.cost, 3) << (row.on_front ? "  front" : "") << '\n';
  }
  return std::move(text).str();
}

std::string bullets(std::span<const std::string> lines) {
  std::string text;
  for (const std::string& line : lines) text += "  - " + line + '\n';
  return text;
}

void say_what_is_missing(std::span<const petzval::ModelCandidate> table) {
  for (const petzval::ModelCandidate& candidate : table) {
    if (!candidate.available)
      std::cerr << "note: no " << petzval::name(candidate.model) << ": " << candidate.remark << '\n';
  }
}

}  // namespace examples
