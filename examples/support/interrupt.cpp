// SPDX-License-Identifier: Apache-2.0
#include "interrupt.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "progress.hpp"

namespace examples {
namespace {

namespace fs = std::filesystem;

struct State {
  std::mutex keeping;
  std::string note;
  std::vector<fs::path> folders, made;
  bool stops_itself = false;
  std::atomic<bool> asked = false;
  std::recursive_timed_mutex writing;
};

/// Never destroyed: the thread of the signals lives until the process ends.
State& state = *new State;

[[noreturn]] void end() {
  const bool waited = state.writing.try_lock_for(std::chrono::milliseconds(800));
  static_cast<void>(waited);  // writing to a full pipe may take forever
  const std::lock_guard guard(state.keeping);
  std::error_code ignored;
  const std::string unfinished = ".petzval-" + std::to_string(getpid()) + '-';  // see write_file()
  for (const fs::path& folder : state.folders) {
    for (fs::directory_iterator entry(folder, ignored), last; !ignored && entry != last; entry.increment(ignored)) {
      if (entry->path().filename().string().starts_with(unfinished)) fs::remove(entry->path(), ignored);
    }
  }
  std::ranges::sort(state.made, std::ranges::greater(), [](const fs::path& made) { return made.native().size(); });
  for (const fs::path& folder : state.made) rmdir(folder.c_str());  // fails unless the folder is empty
  hide_progress();
  // std::cerr would first flush std::cout, which may block. A full pipe takes no note.
  pollfd error{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  if (poll(&error, 1, 0) == 1) static_cast<void>(!write(STDERR_FILENO, state.note.data(), state.note.size()));
  std::_Exit(interrupted_status);
}

}  // namespace

void end_on_signals(const std::string& note) {
  state.note = note + '\n';
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  try {
    std::thread([signals] {
      for (int signal = 0; sigwait(&signals, &signal) == 0;) {
        const std::lock_guard guard(state.keeping);
        if (!state.stops_itself || state.asked) break;
        state.asked = true;
      }
      end();
    }).detach();
  } catch (const std::system_error&) {  // no more threads: signals kill the program
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
}

Interrupt::Interrupt() {
  const std::lock_guard guard(state.keeping);
  state.stops_itself = true;
}

Interrupt::~Interrupt() {
  const std::lock_guard guard(state.keeping);
  if (!state.asked) state.stops_itself = false;
}

bool Interrupt::asked() noexcept { return state.asked; }

void end_if_asked() {
  if (Interrupt::asked()) end();
}

Together::Together() { state.writing.lock(); }
Together::~Together() { state.writing.unlock(); }

void clean_on_signals(const fs::path& folder, bool made) {
  const std::lock_guard guard(state.keeping);
  state.folders.push_back(folder);
  if (made) state.made.push_back(folder);
}

}  // namespace examples
