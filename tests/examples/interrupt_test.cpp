// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM: status, files and folders of interrupted commands, and the line of progress on a terminal.
#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Interrupts : public Programs {
 protected:
  void TearDown() override {
    if (child_ > 0) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
    Programs::TearDown();
  }

  /// Waits up to a minute.
  static bool wait_for(const std::function<bool()>& condition) {
    for (int k = 0; k < 6000; ++k, std::this_thread::sleep_for(10ms)) {
      if (condition()) return true;
    }
    return false;
  }

  /// Starts petzval. In the child, `before` runs first.
  void start(
      Arguments arguments, const std::function<void()>& before = [] {}) {
    arguments.insert(arguments.begin(), std::string(PETZVAL_TEST_PROGRAMS) + "/petzval");
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    const std::string out = path("said"), err = path("err");
    child_ = fork();
    if (child_ != 0) return;
    for (const auto& [file, descriptor] : {std::pair(out, STDOUT_FILENO), {err, STDERR_FILENO}}) {
      dup2(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), descriptor);
    }
    before();
    execv(words[0], words.data());
    _exit(127);
  }

  /// True if the child waits for signals: it blocks SIGINT for its other threads.
  bool listens() const {
    std::ifstream status("/proc/" + std::to_string(child_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("SigBlk:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
    }
    return false;
  }

  /// Sends a signal and returns the exit status; -1 for a process that was killed, or that had ended before.
  int interrupted(int signal) {
    EXPECT_TRUE(wait_for([&] {
      return listens() || waitid(P_PID, static_cast<id_t>(child_), &info_, WEXITED | WNOHANG | WNOWAIT) != 0 ||
             info_.si_pid != 0;
    }));
    int status = 0;
    if (waitpid(child_, &status, WNOHANG) != 0) return child_ = 0, -1;
    std::this_thread::sleep_for(100ms);
    kill(child_, signal);
    EXPECT_TRUE(wait_for([&] { return waitpid(child_, &status, WNOHANG) == child_; }));
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// No empty folders, no unfinished files, and whole pictures and reports in the folder of the test.
  void expect_whole_files(const std::string& of) const {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_directory()) {
        EXPECT_FALSE(fs::is_empty(entry.path())) << of << ": " << entry.path();
        continue;
      }
      EXPECT_FALSE(entry.path().filename().string().starts_with(".petzval-")) << of << ": " << entry.path();
      if (entry.path().extension() != ".json") continue;
      EXPECT_FALSE(read_json(entry.path()).is_null()) << of << ": " << entry.path();
    }
  }

  pid_t child_ = 0;
  siginfo_t info_{};
};

TEST_F(Interrupts, EveryLongCommandEndsWithTheSameStatus) {
  const std::string lens = "double_gauss_52mm_f1.8", rays = "67108864";
  std::vector<Arguments> commands{
      {"psf", lens, "--at", "5m", "--focus", "1m", "--rays", rays, "--out", path("psf")},
      {"psf-set", lens, "--fields", "0,10", "--at", "1m,5m", "--rays", rays, "--out", path("set")},
      {"colour", lens, "--at", "5m", "--rays", rays, "--out", path("colour")},
      {"expressive", lens, "--rays", rays, "--out", path("expressive")},
      {"spots", lens, "--fields", "0,10", "--rays", rays, "--out", path("spots")},
      {"models", lens, "--focus", "3m", "--out", path("models")},
      {"choose", lens, "--near", "1m", "--far", "inf", "--budget", "0.01"},
      {"report", lens, "--wavelengths", "visible:1", "--out", path("report")}};
#ifdef PETZVAL_TEST_HAS_blur
  commands.push_back({"blur", lens, "--scene", "town", "--focus", "5m", "--rays", "4096", "--out", path("blur")});
  commands.push_back({"render", lens, "--scene", "chess", "--focus", "1m", "--spp", "4096", "--out", path("render")});
#endif
  int signal = SIGTERM;
  for (const Arguments& command : commands) {
    signal = signal == SIGINT ? SIGTERM : SIGINT;
    start(command);
    EXPECT_EQ(interrupted(signal), 130) << command.front() << ": " << read(path("err"));
    EXPECT_NE(read(path("err")).find("interrupted"), std::string::npos) << command.front();
    expect_whole_files(command.front());
  }
}

/// A command that waits for a file that nobody writes.
TEST_F(Interrupts, CommandThatWaitsForAFileEnds) {
  ASSERT_EQ(mkfifo(path("lens.json").c_str(), 0666), 0);
  start({"report", path("lens.json")});
  EXPECT_EQ(interrupted(SIGINT), 130);
}

/// A command whose output nobody reads.
TEST_F(Interrupts, CommandThatWritesToAFullPipeEnds) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_GE(fcntl(ends[1], F_SETPIPE_SZ, 4096), 4096);
  const int size = fcntl(ends[1], F_GETPIPE_SZ);
  start({"lenses", "--json"}, [&] { dup2(ends[1], STDOUT_FILENO); });
  int bytes = 0;
  EXPECT_TRUE(wait_for([&] { return ioctl(ends[0], FIONREAD, &bytes) == 0 && bytes == size; }));
  EXPECT_EQ(interrupted(SIGINT), 130);
  EXPECT_NE(read(path("err")).find("interrupted"), std::string::npos);
  close(ends[0]), close(ends[1]);
}

TEST_F(Interrupts, UnfinishedFilesAndNewEmptyFoldersAreRemoved) {
  const std::string others = path("old/.petzval-1-0");
  fs::create_directories(path("old"));
  write("old/.petzval-1-0", "of another process");
  ASSERT_EQ(mkfifo(path("lens.json").c_str(), 0666), 0);
  start({"report", path("lens.json"), "--out", path("old")}, [&] {
    const std::string own = path("old/.petzval-" + std::to_string(getpid()) + "-7");
    close(open(own.c_str(), O_WRONLY | O_CREAT, 0666));
  });
  EXPECT_EQ(interrupted(SIGINT), 130);
  EXPECT_EQ(std::distance(fs::directory_iterator(path("old")), fs::directory_iterator()), 1);
  EXPECT_TRUE(fs::exists(others));

  fs::create_directories(path("empty"));
  for (const char* out : {"empty", "new/folder"}) {
    start({"psf", "double_gauss_52mm_f1.8", "--at", "5m", "--focus", "1m", "--rays", "67108864", "--out", path(out)});
    ASSERT_TRUE(wait_for([&] { return fs::exists(path(out)); }));
    EXPECT_EQ(interrupted(SIGINT), 130);
  }
  EXPECT_TRUE(fs::exists(path("empty")));
  EXPECT_FALSE(fs::exists(path("new")));
}

#ifdef PETZVAL_TEST_HAS_blur
TEST_F(Interrupts, FinishedFramesAreKept) {
  start({"blur", "--thin-lens", "50", "--f-number", "2", "--scene", "knot", "--size", "96x64", "--rays", "16",
         "--supersample", "1", "--frames", "100000", "--focus", "1m", "--out", path("frames")});
  ASSERT_TRUE(wait_for([&] { return fs::exists(path("frames/blur_0003.png")); })) << read(path("err"));
  EXPECT_EQ(interrupted(SIGINT), 130);
  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(path("frames"))) {
    fs::path other = entry.path();
    other.replace_extension(other.extension() == ".png" ? ".exr" : ".png");
    EXPECT_TRUE(fs::exists(other)) << other;
    ++pictures;
  }
  EXPECT_GE(pictures, 6u);
}
#endif

TEST_F(Interrupts, TerminalsShowProgress) {
  ASSERT_EQ(mkfifo(path("lens.json").c_str(), 0666), 0);
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal) + unlockpt(terminal), 0);
  const std::string name = ptsname(terminal);
  start({"report", path("lens.json")}, [&] { dup2(open(name.c_str(), O_RDWR | O_NOCTTY), STDERR_FILENO); });
  std::string shown;
  char buffer[256];
  while (shown.find(" s") == std::string::npos) {
    const ssize_t count = ::read(terminal, buffer, sizeof buffer);
    if (count > 0) shown.append(buffer, static_cast<std::size_t>(count));
  }
  EXPECT_NE(shown.find("petzval report, "), std::string::npos) << shown;
  EXPECT_EQ(interrupted(SIGINT), 130);
  close(terminal);
}

}  // namespace
