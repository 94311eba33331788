// SPDX-License-Identifier: Apache-2.0
// Time of tilting a film to 24 focus points on one thread. Measures fits with ideal thin and thick lenses, robust or
// not, within and at the limit of tilt, and fits with exact rays, including their bundles.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "fit/fit_to_rays.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "table.hpp"

namespace {

using namespace petzval;

constexpr std::size_t point_count = 24;
constexpr double film_radius = 21.7;

/// Points near an inclined plane over the frame at 1 to 4 m; every fourth is an outlier.
std::vector<Vec3<double>> scene(const IdealLens& lens, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3<double>> points;
  for (std::size_t i = 0; i < point_count; ++i) {
    const double x = 15 / lens.rear_focal_length * unit(random), y = 10 / lens.rear_focal_length * unit(random);
    const double inverse = 6e-4 + 3e-4 * lens.rear_focal_length / 10 * y;
    const double depth = (i % 4 == 3 ? 1.5 + 0.2 * unit(random) : 1 + 0.003 * unit(random)) / inverse;
    points.push_back({x * depth, y * depth, lens.front_principal_z() - depth});
  }
  return points;
}

/// Several draws, so that branch prediction does not learn the data.
constexpr unsigned draws = 8;

template <class Lens>
void fit(benchmark::State& state, const Lens& lens, const IdealLens& ideal, bool robust, double max_tilt) {
  TiltOptions options{.max_tilt_rad = max_tilt, .robust = robust};
  options.film.z_mm = ideal.rear_focal_z;
  std::array<std::vector<FocusTarget>, draws> targets;
  for (unsigned i = 0; i < draws; ++i) {
    for (const auto& p : scene(ideal, i)) targets[i].push_back({.point = {p}});
    if (!fit_tilt(lens, targets[i], options)) throw Error("movement_bench: draw " + std::to_string(i) + " has no film");
  }
  unsigned i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(fit_tilt(lens, targets[i++ % draws], options).film.z());
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv);
  const Lens gauss =
      compile(read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/double_gauss_52mm_f1.8.json"));
  const IdealLens thin = thin_lens(50, 2), thick = thick_lens(gauss);
  const ImageRays bundles(gauss, film_radius);
  const double limit = radians(20);
  const auto add = [](const char* name, auto&&... work) { benchmark::RegisterBenchmark(name, work...); };
  add("thin", fit<IdealLens>, thin, thin, false, limit);
  add("thin, robust", fit<IdealLens>, thin, thin, true, limit);
  add("thick", fit<IdealLens>, thick, thick, false, limit);
  add("thick, robust", fit<IdealLens>, thick, thick, true, limit);
  add("thick, robust, at the limit", fit<IdealLens>, thick, thick, true, radians(0.5));
  add("exact rays", fit<ImageRays>, bundles, thick, false, limit);
  add("exact rays, robust", fit<ImageRays>, bundles, thick, true, limit);
  add("exact rays, at the limit", fit<ImageRays>, bundles, thick, false, radians(0.5));
  Rounds rounds;
  benchmark::RunSpecifiedBenchmarks(&rounds);
  std::printf("%-34s %9s\n", "film through 24 points (minima)", "us");
  for (const auto& line : rounds.lines()) std::printf("%-34s %9.1f\n", line.name.c_str(), 1e6 * line.min());
  return 0;
}
