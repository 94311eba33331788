// SPDX-License-Identifier: Apache-2.0
// The scalar kernel against a textbook tracer, film to scene, on the Tronnier double Gauss f/2.0 (11 surfaces).
//
// Rays: `mix` from film points all over the frame towards the rear element, as a renderer that knows no pupil shoots
// them; `pass` those of them that get out. All of them every round, rounds of all benchmarks interleaved.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "../trace/extended.hpp"
#include "petzval/io/prescription_json.hpp"
#include "petzval/trace/batch.hpp"
#include "petzval/trace/sequential.hpp"
#include "petzval/trace/trace.hpp"
#include "table.hpp"
#include "textbook_tracer.hpp"

namespace {

using petzval::Ray;
using petzval::TraceOptions;
using petzval::Travel;

constexpr TraceOptions backwards{.travel = Travel::to_scene};

/// The same rays in the forms that the tracers take; exact in float.
struct Rays {
  std::vector<TextbookTracer::Ray> textbook;
  std::vector<Ray<float>> single;
  std::vector<Ray<double>> twice;

  void add(const Ray<float>& r) {
    textbook.push_back({r.origin, r.direction});
    single.push_back(r);
    twice.push_back({petzval::Vec3<double>(r.origin), petzval::Vec3<double>(r.direction)});
  }
  template <class T>
  const std::vector<Ray<T>>& of() const {
    if constexpr (std::is_same_v<T, float>)
      return single;
    else
      return twice;
  }
};

struct Setup {
  petzval::Lens lens = petzval::compile(
      petzval::read_prescription(std::string(PETZVAL_BENCH_DATA) + "/lenses/double_gauss_100mm_f2.0.json"));
  TextbookTracer textbook{lens};
  Rays mix, pass;

  Setup() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const auto& rear = lens.surfaces().back();
    const auto rim = static_cast<float>(rear.semi_diameter), z = static_cast<float>(rear.vertex_z);
    const auto film_z = static_cast<float>(lens.film_z());
    while (mix.single.size() < 8192 || pass.single.size() < 8192) {
      const float x = uniform(random), y = uniform(random);
      if (x * x + y * y > 1) continue;
      const petzval::Vec3<float> film{33.6f * uniform(random), 22.4f * uniform(random), film_z},
          at{rim * x, rim * y, z};
      const petzval::Vec3<double> d(at - film);
      const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
      const Ray<float> ray{film, petzval::Vec3<float>(d / length)};
      if (mix.single.size() < 8192) mix.add(ray);
      if (pass.single.size() < 8192 && petzval::trace(lens, ray, backwards).transmitted()) pass.add(ray);
    }
  }
};

const Setup& setup() {
  static const Setup s;
  return s;
}

void textbook(benchmark::State& state, const Rays& rays) {
  const TextbookTracer& tracer = setup().textbook;
  for (auto _ : state) {
    for (const auto& ray : rays.textbook) {
      TextbookTracer::Ray out;
      benchmark::DoNotOptimize(tracer.trace(ray, out));
      benchmark::DoNotOptimize(out);
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.textbook.size()));
}

template <class T>
void one_by_one(benchmark::State& state, const Rays& rays) {
  const petzval::Lens& lens = setup().lens;
  for (auto _ : state) {
    for (const auto& ray : rays.of<T>()) {
      const auto out = petzval::trace(lens, ray, backwards);
      benchmark::DoNotOptimize(&out);
      benchmark::ClobberMemory();
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.of<T>().size()));
}

template <class T>
void batch(benchmark::State& state, const Rays& rays) {
  const petzval::Lens& lens = setup().lens;
  const std::size_t count = rays.of<T>().size();
  std::array<std::vector<T>, 12> a;
  for (auto& v : a) v.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      a[k][i] = rays.of<T>()[i].origin[static_cast<int>(k)];
      a[k + 3][i] = rays.of<T>()[i].direction[static_cast<int>(k)];
    }
  }
  std::vector<petzval::RayFate> fates(count);
  std::vector<int> surfaces(count);
  for (auto _ : state) {
    petzval::trace<T>(lens, count, {a[0].data(), a[1].data(), a[2].data(), a[3].data(), a[4].data(), a[5].data()},
                      {a[6].data(), a[7].data(), a[8].data(), a[9].data(), a[10].data(), a[11].data()}, fates.data(),
                      surfaces.data(), {.travel = Travel::to_scene});
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

/// Direction errors of rays that both get out, against the kernel over long double on the same rays.
template <class Traced>
void print_error(const char* name, const Traced& traced) {
  const auto tables = testing_lenses::extended(setup().lens.view<double>());
  double sum = 0, most = 0;
  int count = 0;
  for (std::size_t i = 0; i < setup().pass.twice.size(); ++i) {
    const auto& ray = setup().pass.twice[i];
    using L = petzval::kernel::Vec<long double>;
    const auto exact = trace(tables.view(), L{ray.origin.x, ray.origin.y, ray.origin.z},
                             L{ray.direction.x, ray.direction.y, ray.direction.z}, {.travel = Travel::to_scene});
    petzval::Vec3<double> d;
    if (exact.fate != petzval::RayFate::transmitted || !traced(i, d)) continue;
    const long double x = d.x - exact.direction.x, y = d.y - exact.direction.y, z = d.z - exact.direction.z;
    const auto off = static_cast<double>(std::sqrt(x * x + y * y + z * z));
    sum += off * off;
    most = std::max(most, off);
    ++count;
  }
  std::printf("%-34s %.2e  %.2e   (%d rays)\n", name, std::sqrt(sum / count), most, count);
}

template <class T>
void print_kernel_error(const char* name) {
  print_error(name, [](std::size_t i, petzval::Vec3<double>& d) {
    const auto out = petzval::trace(setup().lens, setup().pass.of<T>()[i], backwards);
    d = petzval::Vec3<double>(out.ray.direction);
    return out.transmitted();
  });
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv);
  const auto add = [](const std::string& group, const Rays& rays) {
    const auto one = [&](const std::string& name, auto* run) {
      benchmark::RegisterBenchmark((name + "/" + group).c_str(), run, rays);
    };
    one("textbook float", textbook);
    one("petzval float, ray by ray", one_by_one<float>);
    one("petzval double, ray by ray", one_by_one<double>);
    one("petzval float, batch", batch<float>);
    one("petzval double, batch", batch<double>);
  };
  add("pass", setup().pass);
  add("mix", setup().mix);
  Table table("ray, 11 surfaces");
  benchmark::RunSpecifiedBenchmarks(&table);

  std::printf("\n%-34s %-9s %-9s\n", "direction error (rad)", "rms", "max");
  print_error("textbook float", [](std::size_t i, petzval::Vec3<double>& d) {
    TextbookTracer::Ray out;
    const bool passed = setup().textbook.trace(setup().pass.textbook[i], out);
    d = petzval::Vec3<double>(out.direction);
    return passed;
  });
  print_kernel_error<float>("petzval float");
  print_kernel_error<double>("petzval double");
  return 0;
}
