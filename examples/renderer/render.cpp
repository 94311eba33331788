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

/// Samples of a round in a picture with a given number of samples.
std::uint32_t samples_of_round(std::uint32_t samples, std::size_t round) noexcept {
  constexpr auto rounds = static_cast<std::uint32_t>(PictureSums::rounds);
  return samples / rounds + (round < samples % rounds ? 1 : 0);
}

constexpr std::uint32_t most_of_unit = 16;

/// The next samples of a tile towards a target, of film samples or light paths.
SampleRange next_of(const PictureSums& sums, std::size_t tile, PictureSums::Of of,
                    std::optional<std::uint32_t> samples) {
  SampleRange range;
  for (std::uint32_t round = 0; round < PictureSums::rounds; ++round) {
    const std::uint32_t has = sums.samples(tile, round, of);
    const std::uint32_t target =
        samples ? samples_of_round(*samples, round) : std::numeric_limits<std::uint32_t>::max();
    if (has >= target || (range.count > 0 && has >= range.first)) continue;
    range = {round, has, samples ? std::min(target - has, most_of_unit) : 1};
  }
  return range;
}

}  // namespace

SampleRange Effort::next(const PictureSums& sums, std::size_t tile) const noexcept {
  using Of = PictureSums::Of;
  if (!noise) return next_of(sums, tile, Of::film, samples);
  SampleRange film = next_of(sums, tile, Of::film, sums.target(tile, Of::film));
  SampleRange light = next_of(sums, tile, Of::light, sums.target(tile, Of::light));
  if (film == light) return film;
  film.light = false, light.film = false;
  return film.count > 0 ? film : light;
}

std::size_t Effort::units_left(const PictureSums& sums, std::size_t tile) const noexcept {
  std::size_t units = 0;
  for (std::size_t round = 0; samples && !noise && round < PictureSums::rounds; ++round) {
    const std::uint32_t has = sums.samples(tile, round), target = samples_of_round(*samples, round);
    if (has < target) units += (target - has + most_of_unit - 1) / most_of_unit;
  }
  return units;
}

bool Effort::plan(const UnitTracer& tracer, PictureSums& sums) const {
  using Of = PictureSums::Of;
  constexpr double first = 2.0 * PictureSums::rounds, most_growth = 2, light_part = 2.0 / 3;
  // Variance above the estimate by one standard deviation, with 15 degrees of freedom.
  constexpr double margin = 1 + 0.365;
  const double limit = *samples;
  const auto whole_rounds = [&](double wanted) {
    constexpr double rounds = PictureSums::rounds;
    return static_cast<std::uint32_t>(std::min(std::ceil(wanted / rounds) * rounds, limit));
  };
  std::vector<double> film(sums.tiles());
  double light = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    film[t] = static_cast<double>(sums.samples(t, Of::film));
    light = std::min(light, static_cast<double>(sums.samples(t, Of::light)));
  }
  const bool begun = std::all_of(film.begin(), film.end(), [&](double own) { return own >= std::min(first, limit); });
  std::vector<PictureSums::Noise> found = sums.noise();
  std::vector<double> allowed(sums.tiles()), wanted(sums.tiles(), first);
  double light_wanted = first;
  if (begun) {
    // A tile that has missed rare light seems clean. Its variance per sample is at least a part of the variance of its
    // neighbours.
    std::vector<double> of_sample;
    for (std::size_t t = 0; t < sums.tiles(); ++t) of_sample.push_back(found[t].film * film[t]);
    const auto columns = static_cast<int>(sums.tile_columns()), rows = static_cast<int>(sums.tile_rows());
    double light_growth = 0;
    for (std::size_t t = 0; t < sums.tiles(); ++t) {
      const int column = static_cast<int>(t) % columns, row = static_cast<int>(t) / columns;
      double around = 0;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns - 1); ++x) {
          around += of_sample[static_cast<std::size_t>(y * columns + x)] / 9;
        }
      }
      found[t].film = margin * std::max(found[t].film, around / 4 / film[t]);
      found[t].light *= margin;
      const double error = *noise * std::max(found[t].mean, floor);
      allowed[t] = error * error;
      if (found[t].film + found[t].light <= allowed[t]) continue;
      const double part = tracer.from_film() ? light_part : 1;
      light_growth = std::max(light_growth, std::min(found[t].light / (part * allowed[t]), most_growth));
    }
    light_wanted = light * std::max(light_growth, 1.0);
    for (std::size_t t = 0; t < sums.tiles(); ++t) {
      wanted[t] = film[t];
      if (found[t].film + found[t].light <= allowed[t]) continue;
      const double left =
          allowed[t] - std::min(found[t].light * light / std::max(light_wanted, 1.0), light_part * allowed[t]);
      wanted[t] *= std::clamp(found[t].film / left, 1.0, most_growth);
    }
  }
  bool more = false;
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    const std::uint32_t light_target = tracer.from_light() ? whole_rounds(light_wanted) : 0;
    sums.set_target(t, Of::light, light_target);
    sums.set_target(t, Of::film, tracer.from_film() ? whole_rounds(wanted[t]) : light_target);
    more = more || next(sums, t).count > 0;
  }
  return more;
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
  if (effort.samples && !effort.noise) progress.emplace("tiles", units);
  bool reached = false;
  while (!late() && !stop()) {
    // A pass: the tiles with the fewest samples, or all tiles that lack samples towards the noise.
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::size_t> missing;
    for (const std::size_t tile : tiles) {
      if (!lacks(tile)) continue;
      if (effort.noise) {
        missing.push_back(tile);
        continue;
      }
      if (sums.samples(tile) > least) continue;
      if (sums.samples(tile) < least) missing.clear();
      least = sums.samples(tile);
      missing.push_back(tile);
    }
    if (missing.empty()) {
      reached = !effort.noise || !effort.plan(tracer, sums);
      if (reached) break;
      continue;
    }
    petzval::parallel_for(missing.size(), 1, threads, [&](std::size_t i, std::size_t) {
      if (stop()) return;
      const auto unit_begin = Clock::now();
      const PixelBlock block = sums.block(missing[i]);
      SampleRange range;
      {
        const std::lock_guard guard(keeping);
        range = effort.next(sums, missing[i]);
      }
      Splats film, light;
      double lens_seconds = 0;
      tracer.trace(block, range, film, light, lens_seconds);
      const double busy_seconds = seconds_since(unit_begin);
      const std::lock_guard guard(keeping);
      if (range.film) sums.add(missing[i], range.round, range.count, film.all());
      if (range.light && tracer.from_light())
        sums.add(missing[i], range.round, range.count, light.all(), PictureSums::Of::light);
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
  report.finished = effort.noise ? reached : !effort.samples || std::none_of(tiles.begin(), tiles.end(), lacks);
  report.interrupted = stop() && !(effort.samples && report.finished);
  save();
  return report;
}

}  // namespace renderer
