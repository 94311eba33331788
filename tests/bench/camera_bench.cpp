// SPDX-License-Identifier: Apache-2.0
// Time of a camera ray on one thread: pupil sample, ray and weight for every model of a lens. Measures batches of 4096
// samples, single samples, tilted films, connections and bokeh controls, and the set-up time of cameras of all lenses.
//
//   camera_bench [options of Google Benchmark]
//
// A useful ray reaches the scene; lost samples count in the time. The textbook tracer is timed in the same run on the
// ray mix of trace_bench. Samples cover a 3:2 frame at full aperture.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../declared_radius.hpp"
#include "camera/make_model.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "table.hpp"
#include "trace_rays.hpp"
#include "trace_work.hpp"

namespace {

using petzval::Camera;
using petzval::Film;
using petzval::ModelKind;

constexpr std::size_t sample_count = 16384, batch_size = 4096;

template <class T>
using Column = std::vector<T, OnCacheLines<T>>;

/// Samples on the whole film, with memory for their rays.
template <class T>
struct Samples {
  Column<T> film_x, film_y, pupil_u, pupil_v;
  std::array<Column<T>, 6> rays;
  Column<T> weights;
  std::vector<petzval::RayFate> fates;

  explicit Samples(const Film& film) : weights(sample_count), fates(sample_count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> one;
    for (std::size_t i = 0; i < sample_count; ++i) {
      film_x.push_back(static_cast<T>((one(random) - 0.5) * film.width_mm));
      film_y.push_back(static_cast<T>((one(random) - 0.5) * film.height_mm));
      pupil_u.push_back(static_cast<T>(one(random)));
      pupil_v.push_back(static_cast<T>(one(random)));
    }
    for (auto& column : rays) column.resize(sample_count);
  }
};

/// A method of sampling camera rays.
struct Row {
  std::string lens, call;
  ModelKind model;
  bool in_double;
  Camera camera;
  double textbook_ns = 0, useful = 0, ns = 0;  ///< useful: fraction of the samples

  std::string name() const { return lens + '/' + std::string(petzval::name(model)) + '/' + call; }
  const char* precision() const { return in_double ? "double" : "float"; }
  double ns_per_useful() const { return ns / useful; }
  double ratio() const { return textbook_ns / ns_per_useful(); }
};

template <class T>
void sample_batches(const Camera& camera, Samples<T>& s) {
  for (std::size_t i = 0; i < sample_count; i += batch_size) {
    const petzval::CameraSamples<T> samples{s.film_x.data() + i, s.film_y.data() + i, s.pupil_u.data() + i,
                                            s.pupil_v.data() + i};
    const auto ray = [&](std::size_t k) { return s.rays[k].data() + i; };
    camera.sample<T>(batch_size, samples,
                     {{ray(0), ray(1), ray(2), ray(3), ray(4), ray(5)}, s.weights.data() + i, s.fates.data() + i});
  }
}

template <class T>
void time_batches(benchmark::State& state, const Row& row) {
  Samples<T> samples(row.camera.film());
  for (auto _ : state) {
    sample_batches(row.camera, samples);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(sample_count));
}

void time_single(benchmark::State& state, const Row& row) {
  const Samples<double> s(row.camera.film());
  std::vector<petzval::CameraRay> rays(sample_count);
  for (auto _ : state) {
    for (std::size_t i = 0; i < sample_count; ++i) {
      rays[i] =
          row.camera.sample({.film = {s.film_x[i], s.film_y[i]}, .pupil_u = s.pupil_u[i], .pupil_v = s.pupil_v[i]});
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(sample_count));
}

/// Connections from points of the scene 2 m away; single: one per call, otherwise 4096.
void time_connections(benchmark::State& state, const Row& row, bool single) {
  const Samples<double> s(row.camera.film());
  std::vector<petzval::Vec3<double>> points;
  for (std::size_t i = 0; i < sample_count; ++i) {
    const auto ray = row.camera.sample({.film = {s.film_x[i], s.film_y[i]}, .pupil_u = 0.3, .pupil_v = 0.4}).ray;
    points.push_back(ray.origin + ray.direction * 2000.0);
  }
  const std::size_t at_once = single ? 1 : batch_size;
  std::vector<petzval::ImportanceSample> found(sample_count);
  row.camera.sample_importance(points[0], 0.5, 0.5);  // builds the tables
  for (auto _ : state) {
    for (std::size_t i = 0; i < sample_count; i += at_once) {
      if (single) {
        found[i] = row.camera.sample_importance(points[i], s.pupil_u[i], s.pupil_v[i]);
      } else {
        row.camera.sample_importance(at_once, points.data() + i, s.pupil_u.data() + i, s.pupil_v.data() + i, {},
                                     found.data() + i);
      }
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(sample_count));
}

void time_textbook(benchmark::State& state, const BenchLens& bench) {
  TextbookWork work(bench, bench.mix);
  for (auto _ : state) {
    work.trace();
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(bench.mix.in_float.rays.size()));
}

double useful_share(const Camera& camera) {
  Samples<double> samples(camera.film());
  sample_batches(camera, samples);
  const auto useful = std::count_if(samples.weights.begin(), samples.weights.end(), [](double w) { return w > 0; });
  return static_cast<double>(useful) / static_cast<double>(sample_count);
}

/// The minimum of three times, ms.
double setup_ms(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count());
  }
  return least;
}

struct Bench {
  BenchLens lens;
  Film film, tilted;
  double half_diagonal;

  Bench(const std::string& id, double half, double tilt_deg)
      : lens(petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/" + id + ".json"), half,
             sample_count),
        film{.width_mm = 6 / std::sqrt(13.) * half, .height_mm = 4 / std::sqrt(13.) * half},
        tilted(film),
        half_diagonal(half) {
    tilted.tilt_rad = petzval::radians(tilt_deg);
  }
};

void print_rows(const Bench& bench, const std::vector<Row>& rows) {
  const auto mine = [&](const Row& row) { return row.lens == bench.lens.id; };
  const auto first = std::find_if(rows.begin(), rows.end(), mine);
  if (first == rows.end()) return;
  std::printf(
      "\n%s, %zu surfaces, film %.0f x %.0f mm (tilted by %.0f degrees); textbook tracer %s ns per ray of the mix\n\n",
      bench.lens.name.c_str(), bench.lens.lens.surface_count(), bench.film.width_mm, bench.film.height_mm,
      petzval::degrees(bench.tilted.tilt_rad), digits(first->textbook_ns).c_str());
  std::printf(
      "| model         | call            | precision | ns per sample | useful  | ns per useful ray | x textbook ray |\n"
      "|---------------|-----------------|-----------|--------------:|--------:|------------------:|---------------:|"
      "\n");
  for (const Row& row : rows) {
    if (!mine(row)) continue;
    std::printf("| %-13s | %-15s | %-9s | %13s | %5.1f %% | %17s | %14s |\n",
                std::string(petzval::name(row.model)).c_str(), row.call.c_str(), row.precision(),
                digits(row.ns).c_str(), 100 * row.useful, digits(row.ns_per_useful()).c_str(),
                digits(row.ratio(), 3).c_str());
  }
}

void print_setup(const Bench& bench) {
  const petzval::Lens& lens = bench.lens.lens;
  std::printf("\n%s, set-up, ms\n\n| what                  |      ms |\n|-----------------------|--------:|\n",
              bench.lens.name.c_str());
  const auto print = [](const std::string& what, const std::function<void()>& work) {
    std::printf("| %-21s | %7s |\n", what.c_str(), digits(setup_ms(work), 3).c_str());
  };
  print("FilmPupilTable::enclosing", [&] { petzval::FilmPupilTable::enclosing(lens, bench.half_diagonal); });
  print("Camera, exact_float", [&] { Camera(lens, bench.film); });
  print("exact_float, tilted", [&] { Camera(lens, bench.tilted); });
  for (const ModelKind model : petzval::models()) {
    print(std::string(petzval::name(model)),
          [&] { petzval::camera_detail::make_model(model, lens, bench.half_diagonal); });
  }
}

/// Every lens of data/ on a film as large as its declared field, the slowest first.
void print_all_setups() {
  struct Setup {
    std::string id;
    std::size_t surfaces;
    double ms;
  };
  std::vector<Setup> setups;
  for (const auto& file : std::filesystem::directory_iterator(std::string(PETZVAL_BENCH_DATA) + "/lenses")) {
    if (file.path().extension() != ".json") continue;
    const petzval::Prescription p = petzval::read_prescription(file.path());
    const petzval::Lens lens = petzval::compile(p);
    const double half = petzval::testing::declared_radius(p, lens);
    const Film film{.width_mm = 6 / std::sqrt(13.) * half, .height_mm = 4 / std::sqrt(13.) * half};
    setups.push_back({p.id, lens.surface_count(), setup_ms([&] { Camera(lens, film); })});
  }
  std::sort(setups.begin(), setups.end(), [](const Setup& a, const Setup& b) { return a.ms > b.ms; });
  std::printf("\nset-up of exact cameras of all lenses\n\n| lens | surfaces | ms |\n|------|---------:|---:|\n");
  for (const auto& [id, surfaces, ms] : setups) {
    std::printf("| %s | %zu | %s |\n", id.c_str(), surfaces, digits(ms, 3).c_str());
  }
}

int run(std::vector<char*> arguments) {
  initialize(static_cast<int>(arguments.size()), arguments.data(), 15, 0.005);
  std::deque<Bench> benches;
  benches.emplace_back("double_gauss_100mm_f2.0", 40.4, 8);
  benches.emplace_back("modern_58mm_f0.95", 21.6, 4);
  std::deque<Row> rows;
  for (const Bench& bench : benches) {
    benchmark::RegisterBenchmark((bench.lens.id + "/textbook").c_str(), time_textbook, bench.lens);
    for (const ModelKind model : petzval::models()) {
      const Camera camera(bench.lens.lens, bench.film, {.model = model});
      const bool in_double = model == ModelKind::exact_double;
      rows.push_back({bench.lens.id, "batch", model, in_double, camera});
      benchmark::RegisterBenchmark(rows.back().name().c_str(), in_double ? time_batches<double> : time_batches<float>,
                                   rows.back());
      rows.push_back({bench.lens.id, "single", model, true, camera});
      benchmark::RegisterBenchmark(rows.back().name().c_str(), time_single, rows.back());
      rows.push_back(
          {bench.lens.id, "tilted", model, in_double, Camera(bench.lens.lens, bench.tilted, {.model = model})});
      benchmark::RegisterBenchmark(rows.back().name().c_str(), in_double ? time_batches<double> : time_batches<float>,
                                   rows.back());
    }
    // Connections.
    for (const ModelKind model :
         {ModelKind::thin, ModelKind::polynomial(7), ModelKind::exact_float, ModelKind::exact_double}) {
      for (const bool single : {false, true}) {
        rows.push_back({bench.lens.id, single ? "connection, single" : "connection", model, true,
                        Camera(bench.lens.lens, bench.film, {.model = model})});
        benchmark::RegisterBenchmark(rows.back().name().c_str(), time_connections, rows.back(), single);
      }
    }
    // Bokeh controls.
    struct Shape {
      const char* call;
      petzval::BokehControls controls;
    };
    petzval::BokehControls rings;
    rings.weight_map = petzval::onion_rings({}, 512);
    for (const ModelKind model :
         {ModelKind::thin, ModelKind::thin_two_disc, ModelKind::polynomial(7), ModelKind::exact_float}) {
      for (const auto& [call, controls] :
           {Shape{"hexagon", {.blades = 6}}, Shape{"cat's eye", {.rate_of_change = 1}},
            Shape{"rim", {.weight_distribution = 12.7, .weight_strength = 0.6}}, Shape{"rings", rings}}) {
        rows.push_back({bench.lens.id, call, model, false,
                        Camera(bench.lens.lens, bench.film, {.model = model, .bokeh = controls})});
        benchmark::RegisterBenchmark(rows.back().name().c_str(), time_batches<float>, rows.back());
      }
    }
  }
  Rounds rounds;
  benchmark::RunSpecifiedBenchmarks(&rounds);

  // Skips rows that a filter of the command line excluded.
  const auto ns_of = [&](const std::string& name) {
    const auto line = std::find_if(rounds.lines().begin(), rounds.lines().end(),
                                   [&](const Rounds::Line& l) { return l.name == name; });
    return line == rounds.lines().end() ? std::numeric_limits<double>::quiet_NaN() : 1e9 * line->min();
  };
  std::vector<Row> results;
  for (Row& row : rows) {
    row.ns = ns_of(row.name());
    row.textbook_ns = ns_of(row.lens + "/textbook");
    if (!std::isfinite(row.ns) || !std::isfinite(row.textbook_ns)) continue;
    row.useful = useful_share(row.camera);
    results.push_back(row);
  }
  for (const Bench& bench : benches) print_rows(bench, results);
  for (const Bench& bench : benches) print_setup(bench);
  print_all_setups();
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return guarded(run, argc, argv); }
