// SPDX-License-Identifier: Apache-2.0
// Reports film position, depth of field and breathing for several subject distances and focus criteria.
//
//   petzval focus data/lenses/double_gauss_100mm_f2.0.json
//   petzval focus data/lenses/double_gauss_100mm_f2.0.json --json --at 700,2000,inf --criterion min_rms
//                --blur 0.05 --f-number 4 --fields 0,10
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;
using petzval::FocusStatus;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();  // no value

struct Options {
  examples::CameraFlags setup;
  std::vector<std::string> criteria{"min_rms", "paraxial", "min_max"};
  std::vector<double> distance_mm, field_deg{0}, wavelengths_nm;  // empty: values of the file
  double blur_mm = 0.03;
  bool json = false;
};

struct Row {
  std::string criterion, refusal{};  ///< the error message if the row cannot be computed
  double distance = 0;
  petzval::FocusSolution focus{};
  double near = none, far = none, blur = none, breathing = none;
  FocusStatus depth = FocusStatus::unreachable;
};

/// Results that do not depend on the distance.
struct Limits {
  std::string criterion;
  petzval::FocusSolution hyperfocal{.status = FocusStatus::unreachable}, nearest{.status = FocusStatus::unreachable};
};

struct Report {
  petzval::Lens lens;
  std::vector<Row> rows;  ///< ordered by criterion, then by distance
  std::vector<Limits> limits;
};

/// Default distances: the object distance of the file if finite, otherwise multiples of the focal length, rounded to
/// two digits, like the distances engraved on lenses of 50 to 100 mm.
std::vector<double> usual_distances(const petzval::Lens& lens, const petzval::DesignData& design,
                                    petzval::DistanceOrigin origin) {
  if (std::isfinite(design.object_distance_mm)) return {design.object_distance_mm + petzval::origin_z(lens, origin)};
  const auto first = petzval::first_order(lens, 0, petzval::main_meridian(lens));
  std::vector<double> distances;
  if (!first.afocal) {
    for (const double focal_lengths : {10.0, 20.0, 50.0, 100.0}) {
      const double distance = focal_lengths * std::abs(first.effective_focal_length);
      const double step = std::pow(10, std::floor(std::log10(distance)) - 1);
      distances.push_back(std::round(distance / step) * step);
    }
  }
  distances.push_back(infinity);
  return distances;
}

petzval::FocusOptions focus_options(const std::string& criterion, const Options& options) {
  petzval::FocusOptions result{.criterion = examples::named(criterion, examples::focus_criteria),
                               .origin = options.setup.focus.origin,
                               .fields = {}};
  for (const double degrees : options.field_deg) result.fields.push_back({petzval::radians(degrees), 1});
  result.wavelength_weights.assign(options.wavelengths_nm.size(), 1);
  return result;
}

void solve(Row& row, const petzval::Lens& lens, const petzval::FocusOptions& focus, double blur_mm) {
  row.focus = petzval::solve_focus(lens, row.distance, focus);
  row.depth = row.focus.status;
  if (!row.focus) return;
  const petzval::Lens set = petzval::with_film(lens, row.focus.film_z);
  row.blur = petzval::blur_diameter(set, row.distance, focus).value_or(none);
  row.breathing = petzval::breathing(lens, row.focus.film_z, focus).value_or(none);
  const petzval::DepthOfField depth = petzval::depth_of_field(set, blur_mm, focus);
  row.depth = depth.status;
  if (depth) row.near = depth.near_distance, row.far = depth.far_distance;
}

/// The message of an error that costs only one row: a subject inside the lens, or a field that cannot see the subject's
/// plane. Empty if there is no error.
template <class Work>
std::string refusal(Work&& work) {
  try {
    work();
  } catch (const petzval::Error& error) {
    return error.what();
  }
  return "";
}

/// The error message for a subject that is out of reach; it gives the nearest distance.
std::string reason(const petzval::Lens& lens, const Row& row, const Options& options) {
  return refusal([&] { petzval::with_focus(lens, row.distance, focus_options(row.criterion, options)); });
}

/// Throws for fields without light and for reports without any result. Prints a note for distances that look like
/// metres.
void want_answers(const Report& report, const std::vector<double>& distances, const Options& options) {
  const double z = petzval::origin_z(report.lens, options.setup.focus.origin) - *std::ranges::max_element(distances);
  const bool no_rays =
      std::ranges::any_of(report.rows, [](const Row& r) { return r.focus.status == FocusStatus::no_rays; });
  for (const double field : options.field_deg) {
    if (no_rays && field != 0) examples::want_light(report.lens, {petzval::radians(field), z}, "--fields");
  }
  if (std::ranges::none_of(report.rows, [](const Row& r) { return r.refusal.empty(); })) {
    throw petzval::Error("--at: " + report.rows.front().refusal);
  }
  const auto unreached = [&](const Row& r) { return r.refusal.empty() && r.focus.status == FocusStatus::unreachable; };
  const bool none_solved = std::ranges::none_of(report.rows, [](const Row& r) { return r.refusal.empty() && r.focus; });
  constexpr double metres = 50;
  for (const Row& row : report.rows) {
    if (!unreached(row) || options.distance_mm.empty()) continue;
    const std::string why = reason(report.lens, row, options);
    if (none_solved) throw petzval::Error(why);
    if (row.distance < metres) examples::note(why);
  }
}

Report report(const examples::LoadedLens& loaded, const Options& options) {
  Report result{examples::stopped_down(loaded.lens, options.setup), {}, {}};
  const auto distances = options.distance_mm.empty()
                             ? usual_distances(result.lens, loaded.prescription.design, options.setup.focus.origin)
                             : options.distance_mm;
  examples::Progress progress("focus", options.criteria.size() * distances.size());
  for (const std::string& criterion : options.criteria) {
    const petzval::FocusOptions focus = focus_options(criterion, options);
    Limits limits{.criterion = criterion};
    refusal([&] {
      limits.hyperfocal = petzval::hyperfocal(result.lens, options.blur_mm, focus);
      limits.nearest = petzval::nearest_focus(result.lens, focus);
    });
    result.limits.push_back(std::move(limits));
    for (const double distance : distances) {
      progress.step(criterion);
      Row row{.criterion = criterion, .distance = distance};
      row.refusal = refusal([&] { solve(row, result.lens, focus, options.blur_mm); });
      result.rows.push_back(std::move(row));
    }
  }
  want_answers(result, distances, options);
  return result;
}

bool solved(const Row& row) { return row.refusal.empty() && row.focus; }

const Limits& limits_of(const Report& report, const std::string& criterion) {
  return *std::ranges::find(report.limits, criterion, &Limits::criterion);
}

Json to_json(const Report& report, const Options& options) {
  const auto distance_or_null = [](const petzval::FocusSolution& s) { return s ? finite_or_null(s.distance) : Json(); };
  Json rows = Json::array();
  for (const Row& r : report.rows) {
    const Limits& limits = limits_of(report, r.criterion);
    rows.push_back({{"criterion", r.criterion},
                    {"distance_mm", finite_or_null(r.distance)},
                    {"distance_from", petzval::name(options.setup.focus.origin)},
                    {"status", r.refusal.empty() ? std::string(petzval::name(r.focus.status)) : "refused"},
                    {"message", r.refusal.empty() ? Json() : Json(r.refusal)},
                    {"film_z_mm", solved(r) ? finite_or_null(r.focus.film_z) : Json()},
                    {"focus_blur_mm", finite_or_null(r.blur)},
                    {"blur_mm", options.blur_mm},
                    {"near_limit_mm", finite_or_null(r.near)},
                    {"far_limit_mm", finite_or_null(r.far)},
                    {"depth_status", r.refusal.empty() ? std::string(petzval::name(r.depth)) : "refused"},
                    {"hyperfocal_mm", distance_or_null(limits.hyperfocal)},
                    {"breathing", finite_or_null(r.breathing)},
                    {"nearest_distance_mm", distance_or_null(limits.nearest)}});
  }
  return rows;
}

std::string in_words(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "infinity";
  return examples::fixed(value, decimals);
}

std::string to_text(const Report& report, const Options& options) {
  std::ostringstream text;
  text << report.lens.name() << "\ndistances in mm from the " << examples::in_words(options.setup.focus.origin)
       << "; film_z from the front vertex; depth of field for a blur of " << examples::number(options.blur_mm)
       << " mm in diameter (too_blurred: even the sharpest image has a larger blur; increase --f-number or --blur)\n";
  std::string before;
  for (const Row& r : report.rows) {
    if (r.criterion != before) {
      const Limits& limits = limits_of(report, r.criterion);
      const auto reached = [](const petzval::FocusSolution& s) {
        return s ? in_words(s.distance, 1) : std::string(petzval::name(s.status));
      };
      text << '\n'
           << r.criterion << ": nearest " << reached(limits.nearest) << ", hyperfocal " << reached(limits.hyperfocal)
           << '\n'
           << std::setw(12) << "distance" << std::setw(14) << "film_z" << std::setw(11) << "blur" << std::setw(14)
           << "near limit" << std::setw(14) << "far limit" << std::setw(12) << "breathing" << '\n';
      before = r.criterion;
    }
    text << std::setw(12) << in_words(r.distance, 1);
    if (!solved(r)) {
      text << "  " << (r.refusal.empty() ? petzval::name(r.focus.status) : r.refusal) << '\n';
      continue;
    }
    text << std::setw(14) << in_words(r.focus.film_z, 4) << std::setw(11) << in_words(r.blur, 4);
    if (r.depth == FocusStatus::solved) {
      text << std::setw(14) << in_words(r.near, 1) << std::setw(14) << in_words(r.far, 1);
    } else {
      text << std::setw(28) << petzval::name(r.depth);
    }
    text << std::setw(12) << (std::isnan(r.breathing) ? "-" : in_words(100 * r.breathing, 3) + '%') << '\n';
  }
  return text.str();
}

}  // namespace

int commands::focus(int argc, char** argv) {
  Options options;
  examples::App app(
      "Reports focus, depth of field and breathing for subject distances and focus criteria: the film position, the "
      "blur of the subject, the depth of "
      "field, the hyperfocal distance, the nearest distance, and breathing (growth of the image compared with focus at "
      "infinity).\n"
      "Criteria: thin (a thin lens of the same focal length), paraxial (the cardinal points), min_rms and min_max "
      "(exact rays through the whole aperture: smallest RMS and smallest maximum radius of the blur). Blurs are "
      "diameters: the paraxial cone, the uniform disc with the RMS radius, or twice the maximum radius.\n"
      "thin and paraxial use only the axis and the wavelength nearest to the d line (587.5618 nm).",
      "petzval focus");
  examples::add_lens(app, options.setup.lens);
  app.add_flag(
      "--json", options.json,
      "print an array of rows, one per criterion and distance; null is an infinite or absent value, explained by "
      "status and depth_status (refused: see message; too_blurred: even the sharpest image has a larger blur than "
      "--blur); blur_mm is the value of --blur; breathing is a fraction");
  examples::add_lengths(app, "--at", options.distance_mm, examples::positive_length, "subject distances (mm), or inf")
      ->default_str("the object of the file if finite, else 10, 20, 50, 100 focal lengths, rounded, and inf");
  examples::add_criteria(app, options.criteria);
  examples::add_distance_origin(app, options.setup.focus.origin);
  examples::add_length(app, "--blur", options.blur_mm, examples::positive_number,
                       "largest blur in the depth of field, a diameter on the film (mm); 0.03 is usual for 24 x 36 mm");
  examples::add_f_number(app, options.setup);
  examples::add_numbers(app, "--fields", options.field_deg, examples::field_angle,
                        "fields of min_rms and min_max, of equal weight (degrees)");
  examples::add_wavelengths(app, "--wavelengths", options.wavelengths_nm,
                            "wavelengths of min_rms and min_max, of equal weight")
      ->default_str("the primary wavelength of the file, else the d line");

  return examples::run(app, argc, argv, [&] {
    for (const std::string& criterion : options.criteria) {
      if (std::ranges::count(options.criteria, criterion) == 1) continue;
      throw petzval::Error("--criterion: " + criterion + " occurs twice; criteria must differ");
    }
    examples::LensFile file = examples::read_lens(options.setup.lens);
    if (options.wavelengths_nm.empty()) options.wavelengths_nm = {examples::light_of(file).primary_nm};
    const Report r = report(examples::compiled(std::move(file), options.wavelengths_nm), options);
    std::cout << (options.json ? to_json(r, options).dump(1) + '\n' : to_text(r, options));
  });
}
