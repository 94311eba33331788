// SPDX-License-Identifier: Apache-2.0
// Time and error of rays from the film through the lens: the textbook tracer, the library ray by ray, and its batches
// on every instruction set of the processor.
//
//   trace_bench [--isa baseline|avx2|avx512] [options of Google Benchmark]
//
// Every round traces all rays of a set; rounds of all rows are interleaved. Ratios compare the fastest rounds, because
// slow rounds on a shared machine include the load of other users. Errors of directions are measured on the results of
// each row.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/io/json.hpp"
#include "table.hpp"
#include "trace_rays.hpp"
#include "trace_report.hpp"
#include "trace_work.hpp"

namespace {

using petzval::Arithmetic;
using petzval::BatchOptions;
using petzval::InstructionSet;

constexpr std::size_t ray_count = 16384;

void measure(benchmark::State& state, const Row& row) {
  petzval::limit_batches(row.isa);
  const auto work = row.make();
  for (auto _ : state) {
    work->trace();
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ray_count));
}

/// Errors over rays that pass in this row and in long double.
template <class T>
DirectionError direction_error(const Work& work, const RaySet::Of<T>& set) {
  DirectionError error;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < set.exact.size(); ++i) {
    const auto d = work.direction(i);
    if (!d || !set.exact[i]) continue;
    const auto off = *set.exact[i] - petzval::kernel::Vec<long double>{d->x, d->y, d->z};
    const auto square = static_cast<double>(dot(off, off));
    sum += square;
    error.max = std::max(error.max, std::sqrt(square));
    ++count;
  }
  error.rms = std::sqrt(sum / count);
  return error;
}

DirectionError direction_error(const Row& row) {
  petzval::limit_batches(row.isa);
  const auto work = row.make();
  work->trace();
  return row.in_double ? direction_error(*work, row.set->in_double) : direction_error(*work, row.set->in_float);
}

// ---- Measurements

template <template <class> class Single, class T>
Row one_by_one(const BenchLens& bench, const RaySet& set, const std::string& rays, const std::string& code) {
  Row row{.bench = &bench, .set = &set, .rays = rays, .code = code, .in_double = std::is_same_v<T, double>};
  row.make = [&bench, &set] { return std::make_unique<Single<T>>(bench, set); };
  return row;
}

template <template <class> class Batch, class T>
Row batch(const BenchLens& bench, const RaySet& set, const std::string& rays, const std::string& code,
          InstructionSet isa, Arithmetic mode) {
  Row row{&bench, &set, rays, code, std::is_same_v<T, double>, isa, mode};
  const BatchOptions options{.travel = petzval::Travel::to_scene, .arithmetic = mode};
  row.make = [&bench, &set, options] { return std::make_unique<Batch<T>>(bench, set, options); };
  return row;
}

/// Measures every implementation on one lens and set of rays; extra: also arrays of structures and derivatives.
std::vector<Row> rows_of(const BenchLens& bench, const RaySet& set, const std::string& rays,
                         const std::vector<InstructionSet>& sets, bool extra) {
  std::vector<Row> rows;
  rows.push_back({.bench = &bench, .set = &set, .rays = rays, .code = "textbook", .in_double = false});
  rows.back().make = [&bench, &set] { return std::make_unique<TextbookWork>(bench, set); };
  rows.push_back(one_by_one<TemplateWork, float>(bench, set, rays, "template"));
  rows.push_back(one_by_one<TemplateWork, double>(bench, set, rays, "template"));
  rows.push_back(one_by_one<SingleWork, float>(bench, set, rays, "scalar"));
  rows.push_back(one_by_one<SingleWork, double>(bench, set, rays, "scalar"));
  for (const InstructionSet isa : sets) {
    for (const Arithmetic mode : {Arithmetic::fast, Arithmetic::reproducible}) {
      rows.push_back(batch<ArraysWork, float>(bench, set, rays, "batch", isa, mode));
      rows.push_back(batch<ArraysWork, double>(bench, set, rays, "batch", isa, mode));
    }
  }
  if (!extra) return rows;
  const InstructionSet widest = sets.back();
  rows.push_back(batch<StructuresWork, float>(bench, set, rays, "batch_aos", widest, Arithmetic::fast));
  rows.push_back(batch<StructuresWork, double>(bench, set, rays, "batch_aos", widest, Arithmetic::fast));
  if (rays != "pass") return rows;
  rows.push_back(batch<DifferentialsWork, float>(bench, set, rays, "differentials", widest, Arithmetic::fast));
  rows.push_back(batch<DifferentialsWork, double>(bench, set, rays, "differentials", widest, Arithmetic::fast));
  return rows;
}

/// Eleven refracting surfaces of weak menisci, which differ only in the kind of surface.
petzval::Prescription eleven(const std::string& kind, double conic, const std::vector<petzval::AsphereTerm>& terms) {
  petzval::Prescription p;
  p.id = "eleven_" + kind;
  p.name = kind;
  for (const double nd : {1.5, 1., 1.6, 1., 1.5, 1.7, 1., 1.6, 1., 1.5, 1.}) {
    const double place = static_cast<double>(p.surfaces.size());
    p.surfaces.push_back({.radius = 90 + 2 * place,
                          .thickness = nd > 1 ? 4. : 1.,
                          .medium = {.nd = nd},
                          .semi_diameter = 20,
                          .conic = conic,
                          .aspheric = terms});
  }
  p.surfaces.back().thickness = 60;
  return p;
}

// ---- The program

struct Options {
  std::vector<InstructionSet> sets;
};

/// Removes the options of this program from the command line.
Options own_options(std::vector<char*>& arguments) {
  Options options;
  const auto available = petzval::instruction_sets();
  options.sets.assign(available.begin(), available.end());
  if (const auto isa = take_option(arguments, "--isa")) {
    std::erase_if(options.sets, [&](InstructionSet set) { return petzval::name(set) != *isa; });
    if (options.sets.empty()) {
      throw petzval::Error("trace_bench: --isa = \"" + *isa + "\"; must be an instruction set of this processor");
    }
  }
  return options;
}

int run(std::vector<char*> arguments) {
  const Options options = own_options(arguments);
  initialize(static_cast<int>(arguments.size()), arguments.data(), 15, 0.005);
  const auto file = [](const char* id) {
    return petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/" + id + ".json");
  };
  // The half diagonals are 22 degrees, 9 degrees, the image circle, and the frame of 24 x 36 mm.
  std::deque<BenchLens> lenses;
  lenses.emplace_back(file("double_gauss_100mm_f2.0"), 40.4, ray_count);
  lenses.emplace_back(file("petzval_100mm_f1.6"), 16, ray_count);
  lenses.emplace_back(file("fisheye_10mm_f4"), 13, ray_count);
  lenses.emplace_back(file("modern_58mm_f0.95"), 21.6, ray_count);
  std::deque<BenchLens> kinds;
  kinds.emplace_back(eleven("spheres", 0, {}), 10, ray_count);
  kinds.emplace_back(eleven("conics", -0.5, {}), 10, ray_count);
  kinds.emplace_back(eleven("aspheres", 0, {{4, 1e-7}, {6, 1e-10}, {8, -1e-13}, {10, 1e-16}}), 10, ray_count);

  std::vector<Row> rows, kind_rows;
  for (const BenchLens& bench : lenses) {
    for (const bool pass : {true, false}) {
      const auto some =
          rows_of(bench, pass ? bench.pass : bench.mix, pass ? "pass" : "mix", options.sets, &bench == &lenses.front());
      rows.insert(rows.end(), some.begin(), some.end());
    }
  }
  for (const BenchLens& bench : kinds) {
    const InstructionSet widest = options.sets.back();
    kind_rows.push_back(batch<ArraysWork, float>(bench, bench.pass, "pass", "batch", widest, Arithmetic::fast));
    kind_rows.push_back(batch<ArraysWork, double>(bench, bench.pass, "pass", "batch", widest, Arithmetic::fast));
  }
  for (const auto* some : {&rows, &kind_rows}) {
    for (const Row& row : *some) benchmark::RegisterBenchmark(row.name().c_str(), measure, row);
  }
  Rounds rounds;
  benchmark::RunSpecifiedBenchmarks(&rounds);

  // Skips rows that a filter of the command line excluded.
  const auto results_of = [&](const std::vector<Row>& asked) {
    std::vector<Result> results;
    for (const Row& row : asked) {
      const auto times = std::find_if(rounds.lines().begin(), rounds.lines().end(),
                                      [&](const Rounds::Line& line) { return line.name == row.name(); });
      if (times != rounds.lines().end()) results.push_back({row, *times, direction_error(row)});
    }
    for (Result& r : results) {
      const auto textbook = std::find_if(results.begin(), results.end(), [&](const Result& t) {
        return t.row.code == "textbook" && t.row.beside(r.row);
      });
      if (textbook != results.end()) r.textbook = &*textbook;
    }
    return results;
  };
  const std::vector<Result> results = results_of(rows);
  print_results(results);
  print_kinds(results_of(kind_rows));
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return guarded(run, argc, argv); }
