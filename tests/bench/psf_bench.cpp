// SPDX-License-Identifier: Apache-2.0
// Time of the image of a point light on one thread: point_image as a whole, from the pupil to the size of the spot, and
// its three parts. The parts are making rays (sequence, pupil points, directions), tracing rays, and the histogram of
// 512 x 512 pixels.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "analysis/histogram.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/ray_bundle.hpp"
#include "table.hpp"

namespace {

constexpr std::uint32_t samples = petzval::PsfOptions{}.samples;

/// Rays that fit in the first-level cache, like in a bundle.
struct Block {
  static constexpr std::uint32_t size = 512;
  std::array<double, size> x, y, z, dx, dy, dz;

  petzval::RayArrays<double> out() { return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}; }
  petzval::RayArrays<const double> in() const {
    return {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()};
  }
};

struct Light {
  petzval::Lens lens;
  petzval::FieldPoint point;
  petzval::PupilSampler pupil{petzval::pupil_boundary(lens, point)};

  Light(const std::string& id, double field_deg)
      : lens(petzval::compile(petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/" + id + ".json"))),
        point{.field_rad = petzval::radians(field_deg), .z = -1000} {}

  void make_rays(std::uint32_t first, Block& block) const {
    std::array<double, Block::size> u, v;
    petzval::owen_sobol(first, 0, u, v);
    pupil(u, v, u, v);
    pupil.plane().rays(u, v, block.out());
  }
};

void picture(benchmark::State& state, const Light& light) {
  petzval::PsfOptions options{.samples = samples};
  for (auto _ : state) {
    ++options.seed;
    benchmark::DoNotOptimize(petzval::point_image(light.lens, light.point, options).mean_throughput);
  }
  state.SetItemsProcessed(state.iterations() * samples);
}

void rays(benchmark::State& state, const Light& light) {
  Block block;
  std::uint32_t first = 0;
  for (auto _ : state) {
    light.make_rays(first += Block::size, block);
    benchmark::DoNotOptimize(&block);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * Block::size);
}

void trace(benchmark::State& state, const Light& light) {
  std::vector<Block> blocks(16);
  for (std::uint32_t i = 0; i < blocks.size(); ++i) light.make_rays(i * Block::size, blocks[i]);
  Block traced;
  std::array<petzval::RayFate, Block::size> fates;
  std::size_t i = 0;
  for (auto _ : state) {
    petzval::trace<double>(light.lens, Block::size, blocks[i++ % blocks.size()].in(), traced.out(), fates.data(),
                           nullptr, {.arithmetic = petzval::Arithmetic::reproducible});
    benchmark::DoNotOptimize(&traced);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * Block::size);
}

void histogram(benchmark::State& state, const Light& light) {
  const petzval::RayBundle hits = petzval::trace_bundle(light.lens, light.pupil, samples);
  const petzval::SpotSize spot = petzval::spot_size(hits.x, hits.y);
  const petzval::analysis_detail::PixelGrid grid{spot.centroid, 2.1 * spot.max_radius / 512, 512};
  std::vector<std::uint64_t> counts(512 * 512, 0);
  for (auto _ : state) {
    petzval::analysis_detail::count_points(grid, hits.x, hits.y, counts);
    benchmark::DoNotOptimize(counts.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(hits.x.size()));
}

/// One line per light: the fastest times of point_image and of its parts, and their ratios.
void print(const std::vector<Rounds::Line>& lines) {
  std::printf("%-34s %9s %9s %9s %9s %9s   %s\n", "ns per ray of a PSF (minima)", "picture", "rays", "trace",
              "histogram", "million/s", "histogram / trace");
  for (const Rounds::Line& whole : lines) {
    if (!whole.name.starts_with("picture/")) continue;
    const std::string light = whole.name.substr(whole.name.find('/'));
    const auto nanoseconds = [&](const std::string& part) {
      const auto line = std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.name == part + light; });
      return line == lines.end() ? 0.0 : 1e9 * line->min();
    };
    const double all = nanoseconds("picture"), traced = nanoseconds("trace"), counted = nanoseconds("histogram");
    std::printf("%-34s %9.2f %9.2f %9.2f %9.2f %9.2f   %.3f\n", light.c_str() + 1, all, nanoseconds("rays"), traced,
                counted, 1e3 / all, counted / traced);
  }
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv);
  const auto add = [](const std::string& name, const char* id, double field) {
    const Light light(id, field);
    benchmark::RegisterBenchmark(("picture/" + name).c_str(), picture, light);
    benchmark::RegisterBenchmark(("rays/" + name).c_str(), rays, light);
    benchmark::RegisterBenchmark(("trace/" + name).c_str(), trace, light);
    benchmark::RegisterBenchmark(("histogram/" + name).c_str(), histogram, light);
  };
  add("double Gauss f2.0, axis", "double_gauss_100mm_f2.0", 0);
  add("double Gauss f2.0, 15 deg", "double_gauss_100mm_f2.0", 15);
  add("modern f0.95, aspheres, axis", "modern_58mm_f0.95", 0);
  Rounds rounds;
  benchmark::RunSpecifiedBenchmarks(&rounds);
  print(rounds.lines());
  return 0;
}
