// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/read_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include "../message.hpp"

namespace petzval {
namespace {

namespace fs = std::filesystem;
using testing::message;

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

void expect_contains(const std::string& text, std::initializer_list<std::string> parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << text << "; wanted " << part;
}

TEST_F(ReadFile, GivesEveryByteUpToTheLimit) {
  for (const std::string& bytes : {std::string("a\0\r\n\xff", 5), std::string(), std::string(200'000, 'x')}) {
    std::ofstream(file_, std::ios::binary) << bytes;
    EXPECT_EQ(read_file(file_), bytes);
    EXPECT_EQ(read_file(file_, "a file", bytes.size()), bytes);
    if (bytes.empty()) continue;
    expect_contains(message([&] { read_file(file_, "a file", bytes.size() - 1); }),
                    {file_.string(), std::to_string(bytes.size()) + " bytes", std::to_string(bytes.size() - 1)});
  }
}

TEST_F(ReadFile, LargeFile_IsRefusedBySize) {
  std::ofstream(file_) << "x";
  fs::resize_file(file_, largest_file_bytes + 1);  // a sparse file
  expect_contains(message([&] { read_file(file_); }), {file_.string(), "268435457 bytes", "268435456 bytes (256 MiB)"});
}

TEST_F(ReadFile, EndlessFile_IsRefusedAtTheLimit) {
  for (const char* device : {"/dev/zero", "/dev/full"}) {
    expect_contains(message([&] { read_file(device, "a file", 100'000); }), {device, "100000 bytes"});
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
  expect_contains(message([&] { read_file(pipe, "a file", 100'000); }), {pipe.string(), "100000 bytes"});
  writer.join();
}

TEST_F(ReadFile, MissingFile_IsRefusedWithTheReasonOfTheSystem) {
  fs::create_symlink(folder_ / "loop", folder_ / "loop");
  const std::pair<fs::path, int> cases[] = {
      {file_, ENOENT}, {folder_ / std::string(300, 'n'), ENAMETOOLONG}, {folder_ / "loop", ELOOP}};
  for (const auto& [file, reason] : cases) {
    expect_contains(message([&, &missing = file] { read_file(missing, "a lens file"); }),
                    {file.string() + ": ", std::strerror(reason), "a lens file"});
  }
}

}  // namespace
}  // namespace petzval
