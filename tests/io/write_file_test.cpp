// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/write_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <string>

#include "../message.hpp"

namespace petzval {
namespace {

namespace fs = std::filesystem;
using testing::message;

/// A temporary folder for the test.
class WriteFile : public ::testing::Test {
 protected:
  WriteFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WriteFile() override { fs::remove_all(folder_); }

  static std::string text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {})); }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("petzval_write_file_" + std::to_string(getpid()));
  fs::path file_ = folder_ / "a.txt";
};

TEST_F(WriteFile, WritesEveryByteAndNothingBeside) {
  const std::string bytes("a\0\r\n\xff", 5);
  for (const std::string& wanted : {bytes, std::string(), std::string(1 << 20, 'x')}) {
    write_file(wanted, file_);
    EXPECT_EQ(text(file_), wanted);
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, WhoReadsTheOldFileReadsItToItsEnd) {
  write_file("old", file_);
  std::ifstream reader(file_, std::ios::binary);
  write_file("new!", file_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old");
  EXPECT_EQ(text(file_), "new!");
}

TEST_F(WriteFile, AFailureLeavesTheOldFile) {
  write_file("old", file_);
  fs::create_directory(folder_ / "a.txt.part");  // the new one cannot be written
  EXPECT_EQ(message([&] { write_file("new", file_); }),
            file_.string() + ": cannot be written, wanted an existing, writable folder with space");
  EXPECT_EQ(text(file_), "old");
  EXPECT_TRUE(fs::is_directory(folder_ / "a.txt.part"));
  fs::create_directories(folder_ / "taken" / "inside");
  EXPECT_NE(message([&] { write_file("new", folder_ / "taken"); }).find("taken: cannot be written ("),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "taken.part"));
}

TEST_F(WriteFile, FollowsLinks) {
  write_file("old", file_);
  fs::create_directory(folder_ / "inside");
  const fs::path link = folder_ / "inside" / "link", nowhere = folder_ / "inside" / "nowhere";
  fs::create_symlink("../a.txt", link);
  fs::create_symlink("../b.txt", nowhere);
  write_file("new", link);
  write_file("more", nowhere);
  EXPECT_TRUE(fs::is_symlink(link) && fs::is_symlink(nowhere));
  EXPECT_EQ(text(file_), "new");
  EXPECT_EQ(text(folder_ / "b.txt"), "more");
}

TEST_F(WriteFile, WritesIntoAPipe) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file("bytes", pipe);
  std::array<char, 8> bytes{};
  EXPECT_EQ(read(reader, bytes.data(), bytes.size()), 5);
  EXPECT_STREQ(bytes.data(), "bytes");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

}  // namespace
}  // namespace petzval
