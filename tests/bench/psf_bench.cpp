// SPDX-License-Identifier: Apache-2.0
// What a picture of a point light costs, one thread: rays of point_image, from finding and sampling the pupil to
// counting hits on the film.
#include <benchmark/benchmark.h>

#include <string>

#include "petzval/io/prescription_json.hpp"
#include "petzval/psf/psf.hpp"
#include "table.hpp"

namespace {

void point(benchmark::State& state, const std::string& id, double field_deg) {
  const petzval::Lens lens =
      petzval::compile(petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/" + id + ".json"));
  petzval::PsfOptions options{.samples = 1u << 16};
  double rays = 0;
  for (auto _ : state) {
    ++options.seed;
    const auto image = petzval::point_image(lens, {.field_rad = petzval::radians(field_deg), .z = -1000}, options);
    benchmark::DoNotOptimize(image.psf.counts.data());
    rays += static_cast<double>(image.psf.sent.front());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(rays));
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv);
  const auto add = [](const char* name, const char* id, double field) {
    benchmark::RegisterBenchmark(name, point, id, field);
  };
  add("double Gauss f2.0, 11 surfaces/axis", "double_gauss_100mm_f2.0", 0);
  add("double Gauss f2.0, 11 surfaces/15 deg", "double_gauss_100mm_f2.0", 15);
  add("modern f0.95, 30 surfaces/aspheres", "modern_58mm_f0.95", 0);
  Table table("ray of a PSF");
  benchmark::RunSpecifiedBenchmarks(&table);
  return 0;
}
