// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

/// Options of the caller win over the defaults set here: rounds of all benchmarks, interleaved.
inline void initialize(int argc, char** argv, int rounds = 15) {
  std::vector<std::string> defaults{"--benchmark_repetitions=" + std::to_string(rounds),
                                    "--benchmark_enable_random_interleaving=true", "--benchmark_min_time=0.02"};
  std::vector<char*> arguments{argv[0]};
  for (std::string& option : defaults) arguments.push_back(option.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
}

/// What the last column of a table compares with the first benchmark of the same group.
enum class Compare {
  speed,  ///< how often the fastest round fits into the first's; times in nanoseconds
  cost    ///< how often the first's fits into the fastest round; times in microseconds
};

/// Prints one line per benchmark, in the order of registration: fastest, median and slowest round, and the comparison
/// with the first benchmark of the same group (the part of the name behind '/').
class Table : public benchmark::BenchmarkReporter {
 public:
  /// unit: what a time is for; comparison: the heading of the last column.
  explicit Table(std::string unit, Compare compare = Compare::speed, std::string comparison = "times as fast (minima)")
      : unit_(std::move(unit)), compare_(compare), comparison_(std::move(comparison)) {}

  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const std::string name = run.run_name.function_name;
      auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name == name; });
      if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{name, {}, run.family_index});
      line->times.push_back((cost() ? 1e6 : 1e9) / run.counters.at("items_per_second"));
    }
  }

  void Finalize() override {
    std::printf("%-34s %9s %9s %9s %10s   %s\n", ((cost() ? "us per " : "ns per ") + unit_).c_str(), "min", "median",
                "max", cost() ? "1000/s" : "million/s", comparison_.c_str());
    std::sort(lines_.begin(), lines_.end(), [](const Line& a, const Line& b) { return a.order < b.order; });
    for (Line& line : lines_) std::sort(line.times.begin(), line.times.end());
    for (const Line& line : lines_) {
      const std::string group = line.name.substr(line.name.find('/') + 1);
      const auto first =
          std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name.ends_with("/" + group); });
      const double best = line.times.front(), times = first->times.front() / best;
      std::printf("%-34s %9s %9s %9s %10s   %s\n", line.name.c_str(), digits(best).c_str(),
                  digits(line.times[line.times.size() / 2]).c_str(), digits(line.times.back()).c_str(),
                  digits(1e3 / best).c_str(), digits(cost() ? 1 / times : times, 3).c_str());
    }
  }

 private:
  struct Line {
    std::string name;
    std::vector<double> times;
    std::int64_t order;
  };
  /// Significant digits, without an exponent.
  static std::string digits(double value, int count = 4) {
    char text[32];
    const int places = std::max(0, count - 1 - static_cast<int>(std::floor(std::log10(value))));
    std::snprintf(text, sizeof text, "%.*f", places, value);
    return text;
  }
  bool cost() const { return compare_ == Compare::cost; }

  std::string unit_;
  Compare compare_;
  std::string comparison_;
  std::vector<Line> lines_;
};
