// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/instruction_set.hpp"
#include "petzval/core/error.hpp"

/// Prints the conditions of times: processor, compiler, date.
inline void print_conditions() {
  std::string processor = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    processor = line.substr(line.find(':') + 2);
    break;
  }
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "g++ " __VERSION__;
#endif
  const std::time_t now = std::time(nullptr);
  char date[16];
  std::strftime(date, sizeof date, "%Y-%m-%d", std::localtime(&now));
  std::printf("%s (%s), %s, %s\n", processor.c_str(),
              std::string(petzval::name(petzval::instruction_sets().back())).c_str(), compiler.c_str(), date);
}

/// Prints the conditions and reads the command line. Defaults that options of the caller override: the number of
/// interleaved rounds of all benchmarks, and the time (s) of each in a round.
inline void initialize(int argc, char** argv, int rounds = 15, double round_time = 0.02) {
  std::vector<std::string> defaults{"--benchmark_repetitions=" + std::to_string(rounds),
                                    "--benchmark_enable_random_interleaving=true",
                                    "--benchmark_min_time=" + std::to_string(round_time)};
  std::vector<char*> arguments{argv[0]};
  for (std::string& option : defaults) arguments.push_back(option.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) std::exit(1);
  print_conditions();
}

/// Removes an option of the program and its value from the command line. nullopt if the option is missing.
inline std::optional<std::string> take_option(std::vector<char*>& arguments, const std::string& flag) {
  const auto at = std::find(arguments.begin() + 1, arguments.end(), flag);
  if (at == arguments.end()) return {};
  if (at + 1 == arguments.end()) {
    throw petzval::Error(std::string(arguments[0]) + ": " + flag + ": has no value; must have one");
  }
  std::string value = *(at + 1);
  arguments.erase(at, at + 2);
  return value;
}

/// Runs a program and prints its errors in one line.
inline int guarded(int (*run)(std::vector<char*> arguments), int argc, char** argv) {
  try {
    return run({argv, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

/// Significant digits, without an exponent.
inline std::string digits(double value, int count = 4) {
  char text[32];
  const int places = std::max(0, count - 1 - static_cast<int>(std::floor(std::log10(value))));
  std::snprintf(text, sizeof text, "%.*f", places, value);
  return text;
}

/// Records the time per item of every round of every benchmark.
class Rounds : public benchmark::BenchmarkReporter {
 public:
  struct Line {
    std::string name;
    std::vector<double> seconds;  ///< sorted
    std::int64_t order;           ///< of registration

    double min() const { return seconds.front(); }
    double median() const { return seconds[seconds.size() / 2]; }
    double max() const { return seconds.back(); }
  };

  /// Benchmarks that ran, in the order of registration.
  const std::vector<Line>& lines() const { return lines_; }

  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const std::string name = run.run_name.function_name;
      auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name == name; });
      if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{name, {}, run.family_index});
      line->seconds.push_back(1 / run.counters.at("items_per_second"));
    }
  }

  void Finalize() override {
    std::sort(lines_.begin(), lines_.end(), [](const Line& a, const Line& b) { return a.order < b.order; });
    for (Line& line : lines_) std::sort(line.seconds.begin(), line.seconds.end());
  }

 private:
  std::vector<Line> lines_;
};

/// Prints one line per benchmark, in the order of registration: fastest, median and slowest round (us), and the ratio
/// to the first benchmark of the same group (the part of the name behind '/').
class Table : public Rounds {
 public:
  explicit Table(std::string ratio) : ratio_(std::move(ratio)) {}

  void Finalize() override {
    Rounds::Finalize();
    std::printf("%-34s %9s %9s %9s %10s   %s\n", "us per result", "min", "median", "max", "1000/s", ratio_.c_str());
    for (const Line& line : lines()) {
      const std::string group = line.name.substr(line.name.find('/') + 1);
      const auto first =
          std::find_if(lines().begin(), lines().end(), [&](const Line& l) { return l.name.ends_with("/" + group); });
      std::printf("%-34s %9s %9s %9s %10s   %s\n", line.name.c_str(), digits(1e6 * line.min()).c_str(),
                  digits(1e6 * line.median()).c_str(), digits(1e6 * line.max()).c_str(),
                  digits(1e-3 / line.min()).c_str(), digits(line.min() / first->min(), 3).c_str());
    }
  }

 private:
  std::string ratio_;
};
