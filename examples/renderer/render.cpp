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

/// Least time between checkpoints: in seconds, and in multiples of the time for saving.
constexpr double min_save_interval_s = 20, save_time_ratio = 20;

}  // namespace

namespace {

/// Samples of a round in a picture with a given number of samples.
std::uint32_t samples_of_round(std::uint32_t samples, std::size_t round) noexcept {
  constexpr auto rounds = static_cast<std::uint32_t>(PictureSums::rounds);
  return samples / rounds + (round < samples % rounds ? 1 : 0);
}

constexpr std::uint32_t most_of_unit = 16;

}  // namespace

SampleRange Effort::next(const PictureSums& sums, std::size_t tile) const noexcept {
  SampleRange range;
  for (std::uint32_t round = 0; round < PictureSums::rounds; ++round) {
    const std::uint32_t has = sums.samples(tile, round);
    const std::uint32_t target =
        samples ? samples_of_round(*samples, round) : std::numeric_limits<std::uint32_t>::max();
    if (has >= target || (range.count > 0 && has >= range.first)) continue;
    range = {round, has, samples ? std::min(target - has, most_of_unit) : 1};
  }
  return range;
}

std::size_t Effort::units_left(const PictureSums& sums, std::size_t tile) const noexcept {
  std::size_t units = 0;
  for (std::size_t round = 0; samples && round < PictureSums::rounds; ++round) {
    const std::uint32_t has = sums.samples(tile, round), target = samples_of_round(*samples, round);
    if (has < target) units += (target - has + most_of_unit - 1) / most_of_unit;
  }
  return units;
}

RenderReport render(const UnitTracer& tracer, PictureSums& sums, const std::vector<std::size_t>& tiles,
                    const Effort& effort, int threads, const std::function<void()>& save,
                    const std::function<bool()>& stop) {
  const auto begin = Clock::now();
  auto saved = begin;
  double save_takes = 0;
  RenderReport report;
  std::mutex keeping;
  const auto late = [&] { return effort.seconds && seconds_since(begin) >= *effort.seconds; };
  const auto lacks = [&](std::size_t tile) { return effort.next(sums, tile).count > 0; };
  std::size_t units = 0;
  for (const std::size_t tile : tiles) units += effort.units_left(sums, tile);
  std::optional<examples::Progress> progress;
  if (effort.samples) progress.emplace("tiles", units);
  while (!late() && !stop()) {
    // A pass: the tiles with the fewest samples.
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::size_t> missing;
    for (const std::size_t tile : tiles) {
      if (!lacks(tile) || sums.samples(tile) > least) continue;
      if (sums.samples(tile) < least) missing.clear();
      least = sums.samples(tile);
      missing.push_back(tile);
    }
    if (missing.empty()) break;
    petzval::parallel_for(missing.size(), 1, threads, [&](std::size_t i, std::size_t) {
      if (stop()) return;
      const auto unit_begin = Clock::now();
      const PixelBlock block = sums.block(missing[i]);
      SampleRange range;
      {
        const std::lock_guard guard(keeping);
        range = effort.next(sums, missing[i]);
      }
      Splats splats;
      double lens_seconds = 0;
      tracer.trace(block, range, splats, lens_seconds);
      const double busy_seconds = seconds_since(unit_begin);
      const std::lock_guard guard(keeping);
      sums.add(missing[i], range.round, range.count, splats.all());
      report.paths += std::uint64_t{range.count} * static_cast<std::uint64_t>(block.width * block.height);
      report.lens_seconds += lens_seconds;
      report.busy_seconds += busy_seconds;
      if (progress) {
        progress->step(std::to_string(least + range.count) + " of " + std::to_string(*effort.samples) + " samples");
      }
      if (seconds_since(saved) < std::max(min_save_interval_s, save_time_ratio * save_takes)) return;
      const auto save_begin = Clock::now();
      save();
      saved = Clock::now();
      save_takes = std::chrono::duration<double>(saved - save_begin).count();
    });
  }
  report.seconds = seconds_since(begin);
  report.finished = !effort.samples || std::none_of(tiles.begin(), tiles.end(), lacks);
  report.interrupted = stop() && !(effort.samples && report.finished);
  save();
  return report;
}

}  // namespace renderer
