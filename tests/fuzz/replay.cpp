// SPDX-License-Identifier: Apache-2.0
// Runs fuzz targets without a fuzzer, for the tests of every build:
//
//     fuzz_replay TARGET              its seeds, truncated and changed, equal on every machine;
//                                     failing inputs are kept in crash-TARGET
//     fuzz_replay TARGET FILE...      inputs kept by a fuzzer
//     fuzz_replay TARGET --random N SEED   N inputs: random bytes, changes of seeds and of slow inputs;
//                                     the slowest is kept in slowest-TARGET, failing ones in crash-TARGET
//     fuzz_replay --list              a line with target, libFuzzer program and largest input each
//     fuzz_replay --write-seeds DIR   the seeds of each target in its own folder
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/error.hpp"
#include "targets.hpp"

namespace {

using petzval::fuzz::Target;

/// The current input, for the crash handler.
const std::string* current = nullptr;
std::string kept_in;

/// Keeps the input in a file like fuzzers.
void keep_input(int signal) {
  std::signal(signal, SIG_DFL);
  if (current != nullptr) std::ofstream(kept_in, std::ios::binary) << *current;
  std::cerr << "the input is in " << kept_in << '\n';
}

void run(const Target& target, const std::string& input) {
  current = &input;
  target.function(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

/// Makes one to four changes: a byte, or a piece that is removed, repeated or taken from another input.
std::string changed(std::string text, const std::vector<std::string>& seeds, std::mt19937& engine) {
  static constexpr std::string_view hard = "0123456789.-+eE\t\n ;\"/[]{}:,xN";
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : engine() % n; };
  for (std::size_t i = 1 + below(4); i > 0; --i) {
    const std::size_t at = below(text.size()), length = below(12);
    const std::string& other = seeds[below(seeds.size())];
    switch (below(5)) {
      case 0: text[at] = hard[below(hard.size())]; break;
      case 1: text[at] = static_cast<char>(below(256)); break;
      case 2: text.erase(at, length); break;
      case 3: text.insert(at, text.substr(below(text.size()), length)); break;
      default: text.insert(at, other.substr(below(other.size()), length)); break;
    }
    if (text.empty()) text = " ";
  }
  return text;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw petzval::Error(file.string() + ": cannot be read; must be an input");
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Includes earlier failures, in seeds/failed.
std::vector<std::string> seeds_of(const Target& target) {
  std::vector<std::string> seeds = target.seeds();
  const auto folder = std::filesystem::path(PETZVAL_FUZZ_SEEDS) / "failed" / target.name;
  if (!std::filesystem::exists(folder)) return seeds;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  std::ranges::transform(files, std::back_inserter(seeds), bytes_of);
  return seeds;
}

void run_fixed(const Target& target) {
  const std::vector<std::string> seeds = seeds_of(target);
  std::mt19937 engine(7);  // equal numbers with every compiler
  run(target, "");
  for (const std::string& seed : seeds) run(target, seed);
  for (int i = 0; i < target.changed_seeds; ++i) {
    const std::string& seed = seeds[engine() % seeds.size()];
    run(target, i % 4 == 0 ? seed.substr(0, engine() % seed.size()) : changed(seed, seeds, engine));
  }
}

/// A quarter of the bytes are 0, which gives simple numbers.
std::string random_text(std::size_t largest, std::mt19937& engine) {
  std::string text(std::min<std::size_t>(40 + engine() % 300, largest), '\0');
  for (char& byte : text) {
    if (engine() % 4 > 0) byte = static_cast<char>(engine() & 255);
  }
  return text;
}

void run_random(const Target& target, unsigned long count, unsigned long seed) {
  constexpr double long_time = 5e-3;  // s
  constexpr std::size_t most = 400;
  std::vector<std::string> pool = seeds_of(target);
  std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
  double slowest = 0, total = 0;
  for (unsigned long i = 0; i < count; ++i) {
    std::string text =
        engine() % 3 == 0 ? random_text(target.largest, engine) : changed(pool[engine() % pool.size()], pool, engine);
    text.resize(std::min(text.size(), target.largest));
    const auto start = std::chrono::steady_clock::now();
    run(target, text);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    total += took;
    if (took > slowest) {
      slowest = took;
      std::ofstream("slowest-" + std::string(target.name), std::ios::binary) << text;
    }
    if (took < long_time) continue;
    if (pool.size() < most) {
      pool.push_back(text);
    } else {
      pool[engine() % most] = text;
    }
  }
  std::cout << target.name << ": " << count << " inputs in " << total << " s, the slowest in " << slowest << " s\n";
}

void write_seeds(const std::filesystem::path& folder) {
  for (const Target& target : petzval::fuzz::targets()) {
    const auto place = folder / target.name;
    std::filesystem::create_directories(place);
    int number = 0;
    for (const std::string& seed : seeds_of(target))
      std::ofstream(place / std::to_string(++number), std::ios::binary) << seed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto targets = petzval::fuzz::targets();
  if (words == std::vector<std::string>{"--list"}) {
    for (const Target& target : targets)
      std::cout << target.name << ' ' << target.program << ' ' << target.largest << '\n';
    return 0;
  }
  if (words.size() == 2 && words[0] == "--write-seeds") return write_seeds(words[1]), 0;
  const auto target = words.empty() ? targets.end() : std::ranges::find(targets, words[0], &Target::name);
  if (target == targets.end()) {
    std::cerr << "fuzz_replay: arguments must be a target of --list, --list or --write-seeds DIR\n";
    return 2;
  }
  const bool random = words.size() == 4 && words[1] == "--random";
  if (words.size() == 1 || random) {
    kept_in = "crash-" + words[0];
    for (const int signal : {SIGABRT, SIGSEGV}) std::signal(signal, keep_input);
    random ? run_random(*target, std::stoul(words[2]), std::stoul(words[3])) : run_fixed(*target);
    return 0;
  }
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!std::filesystem::exists(words[i])) return std::cerr << "fuzz_replay: " << words[i] << " does not exist\n", 2;
    run(*target, bytes_of(words[i]));
  }
  return 0;
}
