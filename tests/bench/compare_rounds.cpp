// SPDX-License-Identifier: Apache-2.0
// How times changed between two builds that ran by turns. For tests/bench/compare.sh:
//
//   compare_rounds COMMIT FOLDER ROUNDS
//
// Reads old1.json, new1.json, old2.json, ... of Google Benchmark from the folder. Prints for every benchmark of both
// the fastest time of all rounds, their ratio, and the smallest and largest ratio of one round: how far to trust it.
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

/// The fastest time of each benchmark in a file, ns per item, and their order there.
struct Times {
  std::map<std::string, double> fastest;
  std::vector<std::string> order;
};

Times read_times(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw petzval::Error(file + ": cannot be opened, wanted the results of a round");
  Times times;
  const nlohmann::json results = nlohmann::json::parse(in);
  for (const nlohmann::json& run : results.at("benchmarks")) {
    if (run.at("run_type") != "iteration" || !run.contains("items_per_second")) continue;
    const std::string name = run.at("run_name");
    const double ns = 1e9 / run.at("items_per_second").get<double>();
    const auto [at, added] = times.fastest.emplace(name, ns);
    if (added) times.order.push_back(name);
    at->second = std::min(at->second, ns);
  }
  // Rounds come in random order.
  std::sort(times.order.begin(), times.order.end());
  return times;
}

struct Change {
  double before = 1e300, after = 1e300;  ///< ns per item
  double least = 1e300, most = 0;        ///< ratio of one round
};

int run(std::vector<char*> arguments) {
  if (arguments.size() != 4) throw petzval::Error("compare_rounds: wanted COMMIT FOLDER ROUNDS");
  const std::string commit = arguments[1], folder = arguments[2];
  const int rounds = std::stoi(arguments[3]);

  std::map<std::string, Change> changes;
  std::vector<std::string> order, alone;
  for (int round = 1; round <= rounds; ++round) {
    const std::string file = std::to_string(round) + ".json";
    const Times before = read_times(folder + "/old" + file), after = read_times(folder + "/new" + file);
    if (round == 1) order = after.order;
    for (const auto& [name, ns] : after.fastest) {
      const auto same = before.fastest.find(name);
      if (same == before.fastest.end()) {
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
  std::printf("%d rounds by turns; ns: the fastest; one round: the smallest and the largest ratio of minima\n\n",
              rounds);
  std::printf("%-72s %10s %10s %7s   %s\n", "", (commit + " ns").c_str(), "now, ns", "ratio", "one round");
  std::vector<double> ratios;
  for (const std::string& name : order) {
    const auto at = changes.find(name);
    if (at == changes.end()) continue;
    const Change& c = at->second;
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
