// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/files.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include "../expect_error.hpp"

namespace petzval {
namespace read_file_test {

namespace fs = std::filesystem;
using testing::expect_error;

class ReadFile : public ::testing::Test {
 protected:
  ReadFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ReadFile() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("petzval_read_file_" + std::to_string(getpid()));
  fs::path file_ = folder_ / "a.txt";
};

TEST_F(ReadFile, GivesEveryByteUpToTheLimit) {
  for (const std::string& bytes : {std::string("a\0\r\n\xff", 5), std::string(), std::string(200'000, 'x')}) {
    std::ofstream(file_, std::ios::binary) << bytes;
    EXPECT_EQ(read_file(file_), bytes);
    EXPECT_EQ(read_file(file_, "a file", bytes.size()), bytes);
    if (bytes.empty()) continue;
    expect_error([&] { read_file(file_, "a file", bytes.size() - 1); }, {file_, bytes.size(), bytes.size() - 1});
  }
}

TEST_F(ReadFile, LargeFile_IsRefusedBySize) {
  std::ofstream(file_) << "x";
  fs::resize_file(file_, largest_file_bytes + 1);  // a sparse file
  expect_error([&] { read_file(file_); }, {file_, 268435457, 268435456});
}

TEST_F(ReadFile, EndlessFile_IsRefusedAtTheLimit) {
  for (const char* device : {"/dev/zero", "/dev/full"}) {
    expect_error([&] { read_file(device, "a file", 100'000); }, {device, 100000});
  }
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::signal(SIGPIPE, SIG_IGN);
  std::thread writer([&] {
    std::ofstream out(pipe);
    const std::string block(4096, '1');
    while (out << block << std::flush) {
    }
  });
  expect_error([&] { read_file(pipe, "a file", 100'000); }, {pipe, 100000});
  writer.join();
}

TEST_F(ReadFile, MissingFile_IsRefusedWithTheReasonOfTheSystem) {
  fs::create_symlink(folder_ / "loop", folder_ / "loop");
  const std::pair<fs::path, int> cases[] = {
      {file_, ENOENT}, {folder_ / std::string(300, 'n'), ENAMETOOLONG}, {folder_ / "loop", ELOOP}};
  for (const auto& [file, reason] : cases) {
    expect_error([&missing = file] { read_file(missing, "a lens file"); },
                 {file, std::strerror(reason), "a lens file"});
  }
}

}  // namespace read_file_test
}  // namespace petzval
