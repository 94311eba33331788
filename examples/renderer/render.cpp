// SPDX-License-Identifier: Apache-2.0
#include "renderer/render.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>

#include "petzval/core/parallel.hpp"
#include "support/cli.hpp"

namespace renderer {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Seconds between checkpoints, and how many times as long as one takes.
constexpr double save_every = 20, save_share = 20;

}  // namespace

std::uint32_t Effort::passes() const noexcept {
  if (!samples) return std::numeric_limits<std::uint32_t>::max();
  // As many as there are rounds to compare, or more: a unit has 16 samples of a pixel at most.
  constexpr std::uint32_t most = 16;
  const auto rounds = static_cast<std::uint32_t>(PictureSums::rounds);
  return std::max(std::min(*samples, rounds), *samples / most + (*samples % most != 0));
}

std::uint32_t Effort::first_sample(std::uint32_t pass) const noexcept {
  if (!samples) return pass;
  return static_cast<std::uint32_t>(std::uint64_t{*samples} * pass / passes());
}

std::uint32_t Effort::samples_in(std::uint32_t pass) const noexcept {
  return first_sample(pass + 1) - first_sample(pass);
}

RenderReport render(const UnitTracer& tracer, PictureSums& sums, const std::vector<std::size_t>& tiles,
                    const Effort& effort, int threads, const std::function<void()>& save) {
  const auto begin = Clock::now();
  auto saved = begin;
  double save_takes = 0;
  RenderReport report;
  std::mutex keeping;
  const auto late = [&] { return effort.seconds && seconds_since(begin) >= *effort.seconds; };
  std::uint32_t pass = effort.passes();
  std::size_t units = 0;
  for (const std::size_t tile : tiles) {
    pass = std::min(pass, sums.passes(tile));
    if (effort.samples) units += effort.passes() - std::min(effort.passes(), sums.passes(tile));
  }
  std::optional<examples::Progress> progress;
  if (effort.samples) progress.emplace("tiles", units);
  for (; pass < effort.passes() && !tiles.empty() && !late(); ++pass) {
    std::vector<std::size_t> missing;
    for (const std::size_t tile : tiles) {
      if (sums.passes(tile) == pass) missing.push_back(tile);
    }
    petzval::parallel_for(missing.size(), 1, threads, [&](std::size_t i, std::size_t) {
      const auto unit_begin = Clock::now();
      const PixelBlock block = sums.block(missing[i]);
      const std::uint32_t count = effort.samples_in(pass);
      Splats splats;
      double lens_seconds = 0;
      tracer.trace(block, effort.first_sample(pass), count, splats, lens_seconds);
      const double busy_seconds = seconds_since(unit_begin);
      const std::lock_guard guard(keeping);
      sums.add(missing[i], count, splats.all());
      report.paths += std::uint64_t{count} * static_cast<std::uint64_t>(block.width * block.height);
      report.lens_seconds += lens_seconds;
      report.busy_seconds += busy_seconds;
      if (progress) progress->step("pass " + std::to_string(pass + 1) + " of " + std::to_string(effort.passes()));
      if (seconds_since(saved) < std::max(save_every, save_share * save_takes)) return;
      const auto save_begin = Clock::now();
      save();
      saved = Clock::now();
      save_takes = std::chrono::duration<double>(saved - save_begin).count();
    });
  }
  report.seconds = seconds_since(begin);
  report.finished = !effort.samples || std::all_of(tiles.begin(), tiles.end(), [&](std::size_t tile) {
    return sums.passes(tile) == effort.passes();
  });
  save();
  return report;
}

}  // namespace renderer
