// SPDX-License-Identifier: Apache-2.0
// Chooses the fastest model of a lens for a scene and an error budget, and verifies it on fresh samples.
//
//   petzval choose data/lenses/double_gauss_52mm_f1.8.json --near 1000 --far inf --budget 0.25
//   petzval choose data/lenses/double_gauss_52mm_f1.8.json --near 1000 --far 5000 --f-number 4 --focus 2000
//                 --budget 1 --json
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/lens_light.hpp"
#include "support/model_rows.hpp"
#include "support/text.hpp"

namespace {

struct Options : examples::ModelOptions {
  double near_mm = 0, far_mm = 0, budget_px = 0, contrast = 0;
};

constexpr examples::Range budget{0, std::numeric_limits<double>::max(), "a finite number, 0 or more"};

/// Largest error of the model for samples that were not used for the choice: at the nearest and the farthest depth, and
/// at random depths between them.
double verified_max_px(const petzval::Lens& lens, const Options& options, petzval::ModelKind model) {
  std::mt19937 random(20'241);
  std::uniform_real_distribution<double> unit;
  const double near = 1 / options.near_mm, far = 1 / options.far_mm;
  const double from_z = petzval::origin_z(lens, options.setup.focus.origin);
  std::vector<double> depths{from_z - options.near_mm, from_z - options.far_mm};
  for (int k = 0; k < 3; ++k) depths.push_back(from_z - 1 / (far + unit(random) * (near - far)));
  const petzval::ErrorSamples samples{.depths_z = depths,
                                      .film_points = 512,
                                      .seed = static_cast<std::uint32_t>(random()),
                                      .threads = examples::threads()};
  return petzval::model_error(lens, options.film(), model, samples).all.max_px;
}

/// The radiance of a lamp of 1 degree diameter, relative to its surroundings, below which its brightest ghost stays
/// under 1 % of the surroundings; infinite if no ghost reaches the film, NaN if petzval::ghost_pairs() throws. The
/// image of the lamp lies at 0.7 of the half diagonal of the film.
double contrast_limit(const petzval::Lens& lens, const petzval::Film& film) try {
  constexpr double pi = std::numbers::pi;
  const double lamp_rad = petzval::radians(0.5), f_number = petzval::real_f_number(lens);
  const petzval::Camera camera(lens, film, {.model = petzval::ModelKind::exact_double});
  const petzval::Vec3<double> to =
      camera.sample({film.point(0.85 * film.columns, 0.15 * film.rows), 0.5, 0.5}).ray.direction;
  const petzval::GhostOptions options{.max_pairs = 300, .tolerance = 1e-2, .threads = examples::threads()};
  const petzval::Ghosts ghosts = petzval::ghost_pairs(lens, {to, true}, options);
  const petzval::Vec3<double> rim = to + lamp_rad * glm::normalize(glm::cross(to, {0, 1, 0}));
  const petzval::Ghosts of_rim = petzval::ghost_pairs(lens, {rim, true}, options);
  double brightest = 0;
  for (const petzval::GhostPair& pair : ghosts.pairs) {
    const auto same = std::ranges::find_if(of_rim.pairs, [&](const petzval::GhostPair& other) {
      return other.first == pair.first && other.second == pair.second;
    });
    if (same == of_rim.pairs.end() || !film.contains(pair.centre)) continue;
    const double shift = std::hypot(same->centre.x - pair.centre.x, same->centre.y - pair.centre.y);
    const double blurred = pair.energy / (pi * shift * shift);  // the ghost of a point is smaller than its shift
    brightest = std::max(brightest, ghosts.entering_mm2 * std::min(pair.peak_per_mm2, blurred));
  }
  return 0.01 * pi / (4 * f_number * f_number) / (brightest * pi * lamp_rad * lamp_rad);
} catch (const petzval::Error&) {
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

int commands::choose(int argc, char** argv) {
  Options options;
  examples::App app(
      "Chooses the fastest model of a lens for a scene. The error of its rays must be within a budget for all film "
      "points, pupil points and depths of the scene, its exposure within 1 %, and the shape of its pupil within 2 % of "
      "the area. At the d line (587.5618 nm).\n"
      "predicted_max_px is the bound used for the choice; max_px in the table is the bound of each model; "
      "verified_max_px is the largest error of fresh samples.",
      "petzval choose");
  examples::add_model_options(app, options);
  examples::add_length(app, "--near", options.near_mm, examples::positive_number, "distance of the nearest object (mm)")
      ->required()
      ->default_str("");
  examples::add_length(app, "--far", options.far_mm, examples::positive_length,
                       "distance of the farthest object (mm), or inf")
      ->required()
      ->default_str("");
  examples::add_number(app, "--budget", options.budget_px, budget, "largest error of a ray (pixels)")
      ->required()
      ->default_str("");
  examples::add_number(app, "--contrast", options.contrast, examples::positive_number,
                       "radiance of a lamp of 1 degree diameter in the scene, divided by the radiance around the lamp: "
                       "says if the scene needs ghosts")
      ->default_str("none");
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    const petzval::Film film = options.film();
    const examples::LoadedLens loaded = examples::focused_lens(options);
    const petzval::Lens& lens = loaded.lens;
    examples::say_what_does_not_fit(lens, film, "--size");
    const petzval::ModelChoice choice = petzval::choose_model(
        lens,
        {.near_mm = options.near_mm, .far_mm = options.far_mm, .film = film, .origin = options.setup.focus.origin},
        {.max_px = options.budget_px, .exposure = 0.01, .pupil_shape = 0.02}, examples::threads());
    examples::say_what_is_missing(choice.table);
    const auto visible = examples::visible_lens(loaded, lens);
    const double subject_z = petzval::origin_z(lens, options.setup.focus.origin) - *options.setup.focus_mm;
    const auto colour = visible ? examples::daylight_behind(*visible, subject_z) : std::nullopt;
    const auto rows = examples::model_rows(choice.table, film, true);
    const double predicted = std::ranges::find(choice.table, choice.model, &petzval::ModelCandidate::model)->bound_px;
    const double verified = verified_max_px(lens, options, choice.model);
    const double limit = contrast_limit(lens, film);
    const bool known = options.contrast > 0 && !std::isnan(limit), needed = options.contrast > limit;
    if (options.json) {
      std::cout << examples::Json{{"model", petzval::name(choice.model)},
                                  {"predicted_max_px", predicted},
                                  {"verified_max_px", verified},
                                  {"reasons", choice.reasons},
                                  {"not_needed", choice.not_needed},
                                  {"without_transmission",
                                   {{"exposure", choice.without_transmission.exposure},
                                    {"field", choice.without_transmission.field},
                                    {"colour", colour ? examples::to_json(*colour) : examples::Json()}}},
                                  {"ghosts",
                                   {{"needed", known ? examples::Json(needed) : examples::Json()},
                                    {"contrast_limit", examples::finite_or_null(limit)}}},
                                  {"table", examples::to_json(rows)}}
                       .dump(1)
                << '\n';
      return;
    }
    std::cout << lens.name() << '\n'
              << examples::conditions(lens, options) << "\n\n"
              << petzval::name(choice.model) << ": error of rays at most " << examples::number(predicted, 3)
              << " px predicted, " << examples::number(verified, 3) << " px on fresh samples\n"
              << examples::bullets(choice.reasons);
    if (!choice.not_needed.empty()) std::cout << "not needed:\n" << examples::bullets(choice.not_needed);
    if (colour) std::cout << "with transmission: " << examples::colour_in_words(*colour)[1] << '\n';
    if (std::isinf(limit)) {
      std::cout << "ghosts: none reaches the film\n";
    } else if (limit > 0) {
      std::cout << "ghosts are visible if a lamp of 1 degree diameter is more than " << examples::number(limit, 3)
                << " times as bright as its surroundings" << (known ? needed ? ": needed" : ": not needed" : "")
                << '\n';
    }
    std::cout << "\nmax, pupil and exposure are bounds\n" << examples::to_text(rows);
  });
}
