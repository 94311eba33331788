// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/files.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"

namespace petzval {
namespace write_file_test {

namespace fs = std::filesystem;
using testing::expect_error;
using testing::expect_tokens;
using testing::message;
using testing::Token;

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

TEST_F(WriteFile, WritesEveryByteAndNoOtherFile) {
  const std::string bytes("a\0\r\n\xff", 5);
  for (const std::string& wanted : {bytes, std::string(), std::string(1 << 20, 'x')}) {
    write_file(wanted, file_);
    EXPECT_EQ(text(file_), wanted);
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, ReadersOfTheOldFileReachItsEnd) {
  write_file("old", file_);
  std::ifstream reader(file_, std::ios::binary);
  write_file("new!", file_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old");
  EXPECT_EQ(text(file_), "new!");
}

/// Message of a write in a child process, because limits and rights would persist in this process; empty if the write
/// succeeds.
std::string message_in_process(const std::function<void()>& prepare, const fs::path& file, const std::string& bytes) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    prepare();
    std::string text;
    try {
      write_file(bytes, file);
    } catch (const Error& error) {
      text = error.what();
    }
    const auto sent = write(ends[1], text.data(), text.size());
    _exit(sent == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string result;
  std::array<char, 256> some{};
  for (ssize_t count; (count = read(ends[0], some.data(), some.size())) > 0;) {
    result.append(some.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return result;
}

std::vector<Token> refusal(const fs::path& file, int reason) { return {file, std::generic_category().message(reason)}; }

TEST_F(WriteFile, FailureStatesTheReasonAndKeepsTheOldFile) {
  write_file("old", file_);
  // The process may write files of at most a thousand bytes.
  const auto limited = [] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  expect_tokens(message_in_process(limited, file_, std::string(4000, 'x')), refusal(file_, EFBIG));
  EXPECT_EQ(text(file_), "old");
  // A folder of another user, or without write permission.
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  const auto nobody = [] {
    if (getuid() == 0 && setuid(65534) != 0) _exit(2);
  };
  expect_tokens(message_in_process(nobody, file_, "new"), refusal(file_, EACCES));
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(text(file_), "old");

  expect_error([&] { write_file("new", folder_ / "none" / "a"); }, refusal(folder_ / "none" / "a", ENOENT));
  expect_error([&] { write_file("new", ""); }, {std::generic_category().message(ENOENT)});
  const fs::path inside = file_ / "a", taken = folder_ / "taken", long_name = folder_ / std::string(300, 'a');
  expect_error([&] { write_file("new", inside); }, refusal(inside, ENOTDIR));
  expect_error([&] { write_file("new", long_name); }, refusal(long_name, ENAMETOOLONG));
  fs::create_directory(taken);
  for (const fs::path& folder : {taken, fs::path("."), fs::path("/")}) {
    expect_error([&] { write_file("new", folder); }, {folder, "folder"});
  }
  expect_error([&] { read_floats(taken); }, {taken, "folder"});
  const fs::path circle = folder_ / "circle";
  fs::create_symlink("circle", circle);
  expect_error([&] { write_file("new", circle); }, refusal(circle, ELOOP));
  EXPECT_EQ(files(), 3u);  // a.txt, taken and circle
#if defined(__linux__)
  expect_error([&] { write_file("new", "/dev/full"); }, refusal("/dev/full", ENOSPC));
#endif
}

TEST_F(WriteFile, RefusesNamesWithZeros) {
  write_file("old", file_);
  fs::path longer = file_;
  longer += std::string("\0.bak", 5);
  expect_error([&] { write_file("new", longer); }, {file_, ".bak"});
  EXPECT_EQ(text(file_), "old");
}

TEST_F(WriteFile, KeepsTheMode) {
  const auto mode = [&] { return static_cast<int>(fs::status(file_).permissions()); };
  const mode_t mask = umask(027);
  write_file("new", file_);
  EXPECT_EQ(mode(), 0640);
  for (const int kept : {0600, 0444, 0666, 0751}) {
    fs::permissions(file_, fs::perms(kept));
    write_file("newer", file_);
    EXPECT_EQ(mode(), kept);
  }
  umask(mask);
}

TEST_F(WriteFile, LeavesOtherFilesAlone) {
  const fs::path part = folder_ / "a.txt.part", other = folder_ / "other";
  write_file("a user's own", part);
  write_file("new", file_);
  EXPECT_EQ(text(part), "a user's own");
  write_file("untouched", other);
  fs::remove(part);
  fs::create_symlink("other", part);
  // Links at the first names of the temporary file.
  const std::string first = ".petzval-" + std::to_string(getpid()) + '-';
  for (const char* i : {"0", "1"}) fs::create_symlink("other", folder_ / (first + i));
  write_file("newer", file_);
  EXPECT_EQ(text(file_), "newer");
  EXPECT_EQ(text(other), "untouched");
  EXPECT_TRUE(fs::is_symlink(part) && fs::is_symlink(folder_ / (first + "0")));
  EXPECT_EQ(files(), 5u);
}

/// Concurrent writers of one file, each with its own letter and length.
std::string own_text(int writer) {
  return std::string(100'000 + 37'000 * static_cast<std::size_t>(writer), 'a' + char(writer));
}
constexpr int writers = 4, rounds = 12;

bool whole(const std::string& text) { return !text.empty() && text == own_text(text[0] - 'a'); }

TEST_F(WriteFile, WritersInThreadsNeverTearAFile) {
  write_file(own_text(0), file_);
  std::vector<std::string> failures(writers);
  std::vector<std::thread> threads;
  for (int k = 0; k < writers; ++k) {
    threads.emplace_back([&, k] {
      for (int i = 0; i < rounds; ++i) {
        const std::string said = message([&] { write_file(own_text(k), file_); });
        if (said != "no error") failures[static_cast<std::size_t>(k)] += said;
        if (!whole(text(file_))) failures[static_cast<std::size_t>(k)] += "torn";
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
  EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, WritersInProcessesNeverTearAFile) {
  write_file(own_text(0), file_);
  std::vector<pid_t> children;
  for (int k = 0; k < writers; ++k) {
    children.push_back(fork());
    if (children.back() != 0) continue;
    for (int i = 0; i < rounds; ++i) {
      if (message([&] { write_file(own_text(k), file_); }) != "no error" || !whole(text(file_))) _exit(1);
    }
    _exit(0);
  }
  for (const pid_t child : children) {
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(files(), 1u);
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

/// Values of the test program of the authors.
TEST(Checksum, IsFnv1a) {
  EXPECT_EQ(checksum(""), "cbf29ce484222325");
  EXPECT_EQ(checksum("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(checksum("foobar"), "85944171f73967e8");
}

}  // namespace write_file_test
}  // namespace petzval
