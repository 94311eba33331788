// SPDX-License-Identifier: Apache-2.0
// Compares the times of two builds that ran alternately. For tests/bench/compare.sh:
//
//   compare_rounds COMMIT FOLDER ROUNDS
//
// Reads old1.json, new1.json, old2.json, ... of Google Benchmark from the folder. Prints for every benchmark of both
// the fastest time of all rounds, the ratio of both times, and the smallest and largest ratio of a round as its
// uncertainty.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "table.hpp"

namespace {

/// The fastest time of each benchmark in a file, ns per item.
std::map<std::string, double> fastest_times(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw petzval::Error(file + ": cannot be opened; must be the results of a round");
  const nlohmann::json results = nlohmann::json::parse(in);
  std::map<std::string, double> fastest;
  for (const nlohmann::json& run : results.at("benchmarks")) {
    if (run.at("run_type") != "iteration" || !run.contains("items_per_second")) continue;
    const double ns = 1e9 / run.at("items_per_second").get<double>();
    double& least = fastest.emplace(run.at("run_name"), ns).first->second;
    least = std::min(least, ns);
  }
  return fastest;
}

struct Change {
  double before = 1e300, after = 1e300;  ///< ns per item
  double least = 1e300, most = 0;        ///< ratio of one round
};

int run(std::vector<char*> arguments) {
  if (arguments.size() != 4) throw petzval::Error("compare_rounds: arguments must be COMMIT FOLDER ROUNDS");
  const std::string commit = arguments[1], folder = arguments[2];
  const int rounds = std::stoi(arguments[3]);

  std::map<std::string, Change> changes;
  std::vector<std::string> alone;
  for (int round = 1; round <= rounds; ++round) {
    const std::string file = std::to_string(round) + ".json";
    const auto before = fastest_times(folder + "/old" + file), after = fastest_times(folder + "/new" + file);
    for (const auto& [name, ns] : after) {
      const auto same = before.find(name);
      if (same == before.end()) {
        if (round == 1) alone.push_back(name);
        continue;
      }
      Change& change = changes[name];
      change.before = std::min(change.before, same->second);
      change.after = std::min(change.after, ns);
      change.least = std::min(change.least, ns / same->second);
      change.most = std::max(change.most, ns / same->second);
    }
  }
  if (changes.empty()) throw petzval::Error("compare_rounds: " + commit + " and this tree have no benchmark in common");

  print_conditions();
  std::printf("%d alternating rounds; ns: fastest round; one round: smallest and largest ratio within a round\n\n",
              rounds);
  std::printf("%-72s %10s %10s %7s   %s\n", "", (commit + " ns").c_str(), "now, ns", "ratio", "one round");
  std::vector<double> ratios;
  for (const auto& [name, c] : changes) {
    ratios.push_back(c.after / c.before);
    std::printf("%-72s %10s %10s %7.3f   %.3f to %.3f\n", name.c_str(), digits(c.before).c_str(),
                digits(c.after).c_str(), ratios.back(), c.least, c.most);
  }
  std::sort(ratios.begin(), ratios.end());
  std::printf("\n%zu benchmarks, ratios %.3f to %.3f, median %.3f\n", ratios.size(), ratios.front(), ratios.back(),
              ratios[ratios.size() / 2]);
  for (const std::string& name : alone) std::printf("new: %s\n", name.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return guarded(run, argc, argv); }
