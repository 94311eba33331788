// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <unistd.h>

#include <cmath>
#include <iostream>
#include <mutex>
#include <streambuf>
#include <string_view>
#include <thread>
#include <utility>

#include "text.hpp"

namespace examples {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Line {
  std::mutex keeping;
  std::string command, step;
  double left_s = -1;  ///< when the step began; negative: unknown
  Clock::time_point start, step_start;
  bool wanted = false, shown = false;
};

/// Never destroyed: the thread that draws lives until the process ends.
Line& line = *new Line;

void write_to_terminal(std::string_view text) { static_cast<void>(!::write(STDERR_FILENO, text.data(), text.size())); }

void clear() {
  if (std::exchange(line.shown, false)) write_to_terminal("\r\033[K");
}

std::string duration(double seconds) {
  return seconds < 100 ? number(std::ceil(seconds)) + " s" : number(std::ceil(seconds / 60)) + " min";
}

void draw() {
  if (!line.wanted || seconds_since(line.start) < 2) return;
  const double in_step = seconds_since(line.step_start);
  std::string text = line.step.empty() ? line.command : line.step;
  text += line.left_s > in_step ? ", " + duration(line.left_s - in_step) + " left" : ", " + duration(in_step);
  write_to_terminal("\r\033[K" + text);
  line.shown = true;
}

/// Clears the line before other output to the same terminal.
class Clearing : public std::streambuf {
 public:
  explicit Clearing(std::streambuf* to) : to_(to) {}

 protected:
  int overflow(int c) override {
    begin();
    return c == traits_type::eof() ? 0 : to_->sputc(static_cast<char>(c));
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    begin();
    return to_->sputn(text, size);
  }
  int sync() override { return to_->pubsync(); }

 private:
  static void begin() {
    const std::lock_guard guard(line.keeping);
    clear();
  }
  std::streambuf* to_;
};

}  // namespace

void show_progress(const std::string& command) {
  if (isatty(STDERR_FILENO) != 1) return;
  const std::lock_guard guard(line.keeping);
  line.command = command, line.start = line.step_start = Clock::now(), line.wanted = true;
  // These buffers live as long as the streams.
  std::cerr.rdbuf(new Clearing(std::cerr.rdbuf()));
  if (isatty(STDOUT_FILENO) == 1) std::cout.rdbuf(new Clearing(std::cout.rdbuf()));
  std::thread([] {
    for (;; std::this_thread::sleep_for(std::chrono::milliseconds(500))) {
      const std::lock_guard drawing(line.keeping);
      draw();
    }
  }).detach();
}

void hide_progress() {
  const std::lock_guard guard(line.keeping);
  line.wanted = false;
  clear();
}

Progress::Progress(std::string title, std::size_t steps) : title_(std::move(title)), steps_(steps) {}

Progress::~Progress() {
  const std::lock_guard guard(line.keeping);
  clear();
  line.step.clear(), line.left_s = -1, line.step_start = line.start;
}

void Progress::step(const std::string& what) {
  const std::size_t done = begun_++;
  const std::lock_guard guard(line.keeping);
  line.step = title_ + ' ' + std::to_string(begun_) + '/' + std::to_string(steps_) + ": " + what;
  line.step_start = Clock::now();
  line.left_s = done == 0 ? -1 : seconds_since(start_) / static_cast<double>(done) * static_cast<double>(steps_ - done);
}

}  // namespace examples
