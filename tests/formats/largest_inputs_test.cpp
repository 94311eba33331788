// SPDX-License-Identifier: Apache-2.0
// Memory for reading the largest accepted inputs, each in its own process.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "../report.hpp"
#include "petzval/core/error.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval {
namespace largest_inputs_test {

constexpr double megabyte = 1 << 20;

Prescription ten_thousand_surfaces() {
  Prescription p;
  p.name = "ten thousand surfaces";
  for (int i = 0; i < 5000; ++i) {
    p.surfaces.push_back({.radius = 1000.0 + i, .thickness = 1, .medium = {.nd = 1.5}, .semi_diameter = 10});
    p.surfaces.push_back({.radius = -1000.5 - i, .thickness = 1, .semi_diameter = 10});
  }
  p.surfaces[0] = {.radius = 0, .thickness = 1, .semi_diameter = 10, .stop = true};
  return p;
}

/// A piece of text repeated `count` times, between two others.
std::string repeated(const std::string& first, const std::string& piece, std::size_t count, const std::string& last) {
  std::string text = first;
  text.reserve(first.size() + count * piece.size() + last.size());
  for (std::size_t i = 0; i < count; ++i) text += piece;
  return text + last;
}

/// A line of /proc/self/status in MB; negative if the line is missing.
double status_megabytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key + ":")) return std::stod(line.substr(key.size() + 1)) / 1024;
  }
  return -1;
}

/// Peak memory of reading minus the text, in MB.
double peak_of(const std::string& text, const std::function<void(const std::string&)>& read) noexcept {
  int ends[2];
  if (pipe(ends) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
    const double before = status_megabytes("VmHWM");
    try {
      read(text);
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
    const double taken = status_megabytes("VmHWM") - before;
    const bool told = write(ends[1], &taken, sizeof taken) == sizeof taken;
    _exit(told && !::testing::Test::HasFailure() ? 0 : 1);
  }
  close(ends[1]);
  double taken = -1;
  const bool whole = ::read(ends[0], &taken, sizeof taken) == sizeof taken;
  close(ends[0]);
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return whole ? taken : -1;
}

void expect_frugal(const std::string& what, const std::string& text,
                   const std::function<void(const std::string&)>& read) {
  SCOPED_TRACE(what);
  const double taken = peak_of(text, read);
  EXPECT_GE(taken, 0);
  EXPECT_LE(taken, 512);
  testing_report::put(what, "text", static_cast<double>(text.size()) / megabyte, "512 MB");
  testing_report::put(what, "memory", taken, "512 MB");
}

class LargestInputs : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "ThreadSanitizer takes memory of its own, several times that of the library";
#endif
    if (status_megabytes("VmHWM") < 0) GTEST_SKIP() << "needs /proc/self/status";
  }
};

TEST_F(LargestInputs, OfLenses) {
  const auto lens = [](const std::string& text) { parse_lens(text, "x"); };
  const auto refused = [](const std::string& text) { EXPECT_THROW(parse_lens(text, "x"), Error); };
  const Prescription p = ten_thousand_surfaces();
  expect_frugal("10,000 surfaces, petzval-lens", format_prescription(p), lens);
  expect_frugal("the same, compiled", format_prescription(p), [](const auto& text) { compile(parse_lens(text, "x")); });
  expect_frugal("10,000 surfaces, .zmx", format_zemax(p).text, lens);
  expect_frugal("10,000 surfaces, .seq", format_codev(p).text, lens);
  expect_frugal("10,000 surfaces, table", format_table(p).text, lens);
  expect_frugal(
      "10,000 surfaces, .len",
      repeated("// OSLO 7.0\nLEN NEW \"x\" 100 9\nAIR\nTH 1e20\nAP 1e19\n",
               "NXT\nGLA 1.5\nRD 50\nTH 1\nAP 5\nNXT\nAIR\nRD -50\nTH 1\nAP 5\n", 4999, "NXT\nWV 0.58756\nEND 9999\n"),
      lens);
  expect_frugal("a million unknown commands, .zmx",
                format_zemax(p).text + repeated("", "  WHAT 1 2 3 4 5\n", 1'000'000, ""), lens);
  // The most entries that fit 16 MiB.
  const std::size_t entries = ((16 << 20) - 400) / 3;
  const std::string brackets = repeated("[[]", ",[]", entries, "]");
  expect_frugal("16 MiB of brackets, petzval-lens", R"({"surfaces": )" + brackets + "}", refused);
  expect_frugal("16 MiB of objects, petzval-lens", R"({"surfaces": )" + repeated("[{}", ",{}", entries, "]") + "}",
                refused);
  expect_frugal("16 MiB of brackets, lentil", R"({"1": {"optical-elements-patent": )" + brackets + "}}", refused);
  expect_frugal("16 MiB of brackets, optiland",
                R"({"surface_group": {"surfaces": [{"type": "ObjectSurface"}]}, "x": )" + brackets + "}", refused);
}

TEST_F(LargestInputs, OfGlasses) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / ("petzval_largest_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto read_whole = [](const auto& file) { read_glasses(file); };
  const auto refuse = [](const auto& file) { EXPECT_THROW(read_glasses(file), Error); };
  const auto expect = [&](const std::string& what, const std::string& name, const std::string& text, const auto& read) {
    const auto file = folder / name;
    std::ofstream(file, std::ios::binary) << text;
    expect_frugal(what, text, [&](const std::string&) { read(file); });
  };
  std::string agf;
  for (int i = 0; i < 100'000; ++i) {
    agf += "NM G" + std::to_string(i) +
           " 2 0 1.5168 64.17 0 1 0\nCD 1.03961212 0.00600069867 0.231792344 0.0200179144 " +
           "1.01046945 103.560653 0 0 0 0\nLD 0.3 2.5\n";
  }
  expect("100,000 glasses, .agf", "a.agf", agf, read_whole);
  const std::string page = "DATA:\n  - type: tabulated n\n    data: |\n";
  std::string table = page;
  for (int i = 0; table.size() + 40 < 8 << 20; ++i) table += "        0." + std::to_string(4'000'000 + i) + " 1.53\n";
  expect("8 MiB of a table, refractiveindex.info", "a.yml", table, read_whole);
  const std::string anchor = "- &a\n";
  expect("8 MiB of anchors, refractiveindex.info", "b.yml",
         repeated("DATA:\n", anchor, ((8 << 20) - 6) / anchor.size(), ""), refuse);
  std::filesystem::remove_all(folder);
}

}  // namespace largest_inputs_test
}  // namespace petzval
