// SPDX-License-Identifier: Apache-2.0
// Time of pupils, one thread, in microseconds and in rays traced through the same lens: a chief ray, a boundary of
// 64 or 256 directions, and the 64 boundaries (of 256) from the axis to the edge of the field that set up a camera.
// Points at infinity.
#include <benchmark/benchmark.h>

#include <limits>
#include <string>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "table.hpp"

namespace {

using petzval::FieldPoint;

struct Setup {
  petzval::Lens lens;
  std::vector<FieldPoint> near_field;  ///< 64 fields within 1 % of the measured field, so that runs differ
  std::vector<FieldPoint> all_fields;  ///< 64 from the axis to the edge
};

FieldPoint at_infinity(double field_deg) {
  return {.field_rad = petzval::radians(field_deg), .z = -std::numeric_limits<double>::infinity()};
}

/// edge_deg: the declared half field of the lens.
Setup setup(const std::string& id, double field_deg, double edge_deg) {
  Setup result{
      petzval::compile(petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/" + id + ".json")),
      {},
      {}};
  for (int i = 0; i < 64; ++i) {
    result.near_field.push_back(at_infinity(field_deg * (0.99 + 0.02 * i / 63)));
    result.all_fields.push_back(at_infinity(edge_deg * i / 63));
  }
  return result;
}

/// Rays over the pupil of the field, one at a time; the unit of the other times.
void traced(benchmark::State& state, const Setup& setup) {
  const petzval::PupilSampler sampler(petzval::pupil_boundary(setup.lens, setup.near_field.front()));
  std::vector<petzval::Ray<double>> rays;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const auto uv = petzval::owen_sobol(i, 0);
    const double u = uv.x, v = uv.y;
    const petzval::Vec2<double> p = sampler(u, v);
    rays.push_back(sampler.plane().ray(p.x, p.y));
  }
  for (auto _ : state) {
    for (const auto& ray : rays) {
      const auto end = petzval::trace(setup.lens, ray);
      benchmark::DoNotOptimize(&end);
      benchmark::ClobberMemory();
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}

void chief(benchmark::State& state, const Setup& setup) {
  for (auto _ : state) {
    for (const FieldPoint& point : setup.near_field) benchmark::DoNotOptimize(petzval::chief_ray(setup.lens, point));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(setup.near_field.size()));
}

void outline(benchmark::State& state, const Setup& setup, std::size_t directions) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(petzval::pupil_boundary(setup.lens, setup.near_field[i++ % 64], 0, directions));
  }
  state.SetItemsProcessed(state.iterations());
}

void fields(benchmark::State& state, const Setup& setup) {
  for (auto _ : state) {
    for (const FieldPoint& point : setup.all_fields) {
      benchmark::DoNotOptimize(petzval::pupil_boundary(setup.lens, point));
    }
  }
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv, 7);
  const auto add = [](const std::string& name, const std::string& id, int field_deg, int edge_deg) {
    const Setup lens = setup(id, field_deg, edge_deg);
    const std::string there = " at " + std::to_string(field_deg) + " deg/" + name;
    const std::string everywhere = ", 0 to " + std::to_string(edge_deg) + " deg/" + name;
    benchmark::RegisterBenchmark(("traced ray" + there).c_str(), traced, lens);
    benchmark::RegisterBenchmark(("chief ray" + there).c_str(), chief, lens);
    benchmark::RegisterBenchmark(("outline of 64" + there).c_str(), outline, lens, 64);
    benchmark::RegisterBenchmark(("outline of 256" + there).c_str(), outline, lens, 256);
    benchmark::RegisterBenchmark(("64 outlines" + everywhere).c_str(), fields, lens);
  };
  add("Gauss f2", "double_gauss_100mm_f2.0", 15, 22);
  add("fisheye", "fisheye_6.3mm_f2.8", 100, 110);
  Table table("in traced rays (minima)");
  benchmark::RunSpecifiedBenchmarks(&table);
  return 0;
}
