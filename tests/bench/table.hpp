// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

/// Options of the caller win over the defaults set here: 15 rounds of all benchmarks, interleaved.
inline void initialize(int argc, char** argv) {
  std::vector<std::string> defaults{"--benchmark_repetitions=15", "--benchmark_enable_random_interleaving=true",
                                    "--benchmark_min_time=0.02"};
  std::vector<char*> arguments{argv[0]};
  for (std::string& option : defaults) arguments.push_back(option.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
}

/// Prints one line per benchmark, in the order of registration: fastest, median and slowest round, and how often the
/// fastest fits into that of the first benchmark of the same group (the part of the name behind '/').
class Table : public benchmark::BenchmarkReporter {
 public:
  explicit Table(std::string unit) : unit_(std::move(unit)) {}

  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const std::string name = run.run_name.function_name;
      auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name == name; });
      if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{name, {}, run.family_index});
      line->ns.push_back(1e9 / run.counters.at("items_per_second"));
    }
  }

  void Finalize() override {
    std::printf("%-34s %9s %9s %9s %10s   %s\n", ("ns per " + unit_).c_str(), "min", "median", "max", "million/s",
                "times as fast (minima)");
    std::sort(lines_.begin(), lines_.end(), [](const Line& a, const Line& b) { return a.order < b.order; });
    for (Line& line : lines_) std::sort(line.ns.begin(), line.ns.end());
    for (const Line& line : lines_) {
      const std::string group = line.name.substr(line.name.find('/') + 1);
      const auto first =
          std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name.ends_with("/" + group); });
      std::printf("%-34s %9.1f %9.1f %9.1f %10.2f   %.2f\n", line.name.c_str(), line.ns.front(),
                  line.ns[line.ns.size() / 2], line.ns.back(), 1e3 / line.ns.front(),
                  first->ns.front() / line.ns.front());
    }
  }

 private:
  struct Line {
    std::string name;
    std::vector<double> ns;
    std::int64_t order;
  };
  std::string unit_;
  std::vector<Line> lines_;
};
