// SPDX-License-Identifier: Apache-2.0
// Large numbers of random rays, camera samples and blurred pixels. Counts the results, prints seed and case of each
// violated rule, and exits with status 1 if there is a violation.
//
//   flood [--rays 1e9] [--samples 1e8] [--gathers 1e7] [--seed 1] [--threads N]
//   flood --rays 1 --from 4711         only case 4711 of the rays
#include "flood.hpp"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>
#include <vector>

#include "petzval/core/parallel.hpp"
#include "support/cli.hpp"

namespace {

using namespace petzval;

struct Work {
  const char* name;
  const char* things;
  flood::Counts (*run)(flood::Case&);
  double wanted;
};

/// Runs cases from `first` until enough items are done. Returns false if a case violates a rule.
bool flooded(const Work& work, std::uint32_t seed, std::uint64_t first, int threads) {
  flood::Counts sum;
  std::vector<std::pair<std::uint64_t, std::string>> faults;
  std::mutex mutex;
  examples::Progress progress(work.name, 100);
  const auto cases = static_cast<std::size_t>(threads) * 8;
  int shown = 0;
  std::uint64_t next = first;
  while (static_cast<double>(sum.done) < work.wanted) {
    parallel_for(cases, 1, threads, [&](std::size_t begin, std::size_t) {
      const std::uint64_t number = next + begin;
      flood::Case at(seed, number);
      const flood::Counts counts = work.run(at);
      const std::scoped_lock lock(mutex);
      sum.add(counts);
      if (counts.fault) faults.emplace_back(number, *counts.fault);
    });
    next += cases;
    if (work.wanted <= 1) break;
    for (; shown < std::min(100.0, 100 * static_cast<double>(sum.done) / work.wanted); ++shown)
      progress.step(work.things);
  }
  std::printf("\n| %s, seed %u, cases %llu to %llu | %llu |\n|---|---|\n", work.things, seed,
              static_cast<unsigned long long>(first), static_cast<unsigned long long>(next - 1),
              static_cast<unsigned long long>(sum.done));
  for (const auto& [kind, count] : sum.kinds) {
    std::printf("| %s | %llu |\n", kind.c_str(), static_cast<unsigned long long>(count));
  }
  for (const auto& [name, error] : sum.worst) std::printf("| worst: %s | %.3g |\n", name.c_str(), error);
  std::printf("| faults | %zu |\n", faults.size());
  for (std::size_t i = 0; i < std::min<std::size_t>(faults.size(), 20); ++i) {
    std::printf("case %llu: violated rule: %s\n", static_cast<unsigned long long>(faults[i].first),
                faults[i].second.c_str());
  }
  std::fflush(stdout);
  return faults.empty();
}

}  // namespace

int main(int argc, char** argv) {
  double rays = 1e9, samples = 1e8, gathers = 1e7;
  std::uint32_t seed = 1, first = 0, threads = static_cast<std::uint32_t>(processor_threads());
  bool whole = true;
  examples::App app(
      "Traces, samples and blurs large numbers of random cases, and prints each case that violates a rule", "flood");
  const examples::Range number{0, 1e15, "a number from 0 to 1e15"};
  examples::add_number(app, "--rays", rays, number, "rays through random lenses");
  examples::add_number(app, "--samples", samples, number, "camera samples of all models");
  examples::add_number(app, "--gathers", gathers, number, "pixels blurred from random layers");
  examples::add_count(app, "--seed", seed, {0, 4294967295.0, "a whole number"}, "other cases");
  examples::add_count(app, "--from", first, {0, 4294967295.0, "a whole number"}, "the first case of each kind");
  examples::add_count(app, "--threads", threads, {1, 1024, "a whole number from 1 to 1024"}, "threads");
  const int status = examples::run(app, argc, argv, [&] {
    for (const Work& work : {Work{"Rays", "rays", flood::rays, rays},
                             {"Cameras", "samples", flood::samples, samples},
                             {"Pictures", "pixels", flood::gathers, gathers}}) {
      if (work.wanted > 0) whole = flooded(work, seed, first, static_cast<int>(threads)) && whole;
    }
  });
  return status != 0 ? status : whole ? 0 : 1;
}
