// SPDX-License-Identifier: Apache-2.0
// Failing allocations and full disks while files are written, and failing allocations while files are read.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "allocations.hpp"
#include "writers.hpp"

namespace petzval {
namespace writing_test {

namespace fs = std::filesystem;
using testing::bits;
using testing::bytes_of;
using testing::expect_error;
using testing::message;
using testing::Writer;

/// OpenEXR 3.1 does not survive failing allocations: constructors leak their members, and the destructor of an unopened
/// deep image dereferences null.
bool by_openexr(const std::string& name) { return name.ends_with(".exr"); }

/// A folder for the test.
class Writing : public ::testing::Test {
 protected:
  Writing() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Writing() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("petzval_writing_" + std::to_string(getpid()));
};

/// Allocates nothing.
void write_old(const fs::path& file) {
  std::FILE* const out = std::fopen(file.c_str(), "w");
  std::fputs("old", out);
  std::fclose(out);
}

TEST_F(Writing, WithoutMemoryKeepsTheOldFileOrWritesTheNewFile) {
  for (const Writer& writer : testing::writers()) {
    if (by_openexr(writer.name)) continue;
    SCOPED_TRACE(writer.name);
    const fs::path file = folder_ / writer.name;
    writer.write(file);
    const std::string whole = bytes_of(file);
    testing::expect_all_or_nothing([&] {
      write_old(file);
      try {
        writer.write(file);
      } catch (...) {
        if (const std::string found = bytes_of(file); found != "old" && found != whole) return "half: " + found;
        throw;
      }
      return bytes_of(file);
    });
    EXPECT_EQ(testing::names_in(folder_), std::vector{writer.name});
    fs::remove(file);
  }
}

TEST_F(Writing, WithoutMemoryReadsCompletelyOrFails) {
  std::map<std::string, fs::path> files;
  for (const Writer& writer : testing::writers()) {
    files[writer.name] = folder_ / writer.name;
    writer.write(files[writer.name]);
  }
  const auto pixels = [](const RgbImage& image) { return bits(std::span<const float>(image.pixels)); };
  const std::vector<std::pair<std::string, std::function<std::string(const fs::path&)>>> readers{
      {"lens.json", [](const auto& file) { return format_prescription(read_prescription(file)); }},
      {"image.png", [&](const auto& file) { return pixels(read_png(file)); }},
      {"image.png", [](const auto& file) { return bits(std::span<const float>(read_iris_map(file).values)); }},
      {"image.pfm", [&](const auto& file) { return pixels(read_pfm(file)); }},
      {"tables.f32", [](const auto& file) { return bits(std::span<const float>(read_floats(file))); }}};
  for (const auto& [name, read] : readers) {
    SCOPED_TRACE(name);
    const auto& file = files[name];
    const auto& reader = read;
    testing::expect_all_or_nothing([&] { return reader(file); });
  }
}

/// Exit status of a process that runs this work; 0 if the work returns true.
int status_of_process(const std::function<bool()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work() ? 0 : 1);
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

TEST_F(Writing, FullDiskIsReportedAndKeepsTheOldFile) {
  for (const Writer& writer : testing::writers()) {
    SCOPED_TRACE(writer.name);
    const fs::path file = folder_ / writer.name;
    write_file("old", file);
    // The process may write files of at most 256 bytes, so that writes fail midway.
    const auto refused = [&] {
      signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{256, 256};
      setrlimit(RLIMIT_FSIZE, &limit);
      return message([&] { writer.write(file); }).starts_with(file.string());
    };
    EXPECT_EQ(status_of_process(refused), 0);
    EXPECT_EQ(bytes_of(file), "old");
    EXPECT_EQ(testing::names_in(folder_), std::vector{writer.name});
    fs::remove(file);
    if (fs::exists("/dev/full")) expect_error([&] { writer.write("/dev/full"); }, {"/dev/full"});
  }
}

}  // namespace writing_test
}  // namespace petzval
