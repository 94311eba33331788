// SPDX-License-Identifier: Apache-2.0
#include "renderer/unit_tracer.hpp"

#include "petzval/core/sobol.hpp"

namespace renderer {
namespace {

/// Seeds of numbers drawn before a path begins. The path itself uses the unmodified seed.
enum class Dimension : std::uint64_t { film = 1, pupil = 2 };

/// Point of the unit square for a sample of a pixel: the Owen-Sobol sequence of its round.
petzval::Vec2<double> drawn(std::uint64_t seed, Dimension what, std::uint32_t pixel, std::uint32_t round,
                            std::uint32_t sample) {
  const auto key = mixed(mixed(mixed(seed + static_cast<std::uint64_t>(what)) + pixel) + round);
  return petzval::owen_sobol(sample, static_cast<std::uint32_t>(key));
}

}  // namespace

std::optional<Integrator> integrator_named(std::string_view name) noexcept {
  if (name == "path") return Integrator::path;
  if (name == "light") return Integrator::light;
  if (name == "bidirectional") return Integrator::bidirectional;
  return {};
}

void UnitTracer::trace(const PixelBlock& block, const SampleRange& samples, Splats& splats,
                       double& lens_seconds) const {
  // A ray is the same in two batches only up to rounding. Batches of one sample per pixel make the bits independent of
  // the division of samples among calls.
  for (std::uint32_t i = 0; i < samples.count; ++i) {
    trace_once(block, samples.round, samples.first + i, splats, lens_seconds);
  }
}

void UnitTracer::trace_once(const PixelBlock& block, std::uint32_t round, std::uint32_t sample, Splats& splats,
                            double& lens_seconds) const {
  const auto columns = static_cast<std::uint32_t>(lens_.film().columns);
  const auto pixels = static_cast<std::size_t>(block.width) * static_cast<std::size_t>(block.height);
  const auto pixel_at = [&](std::size_t i) {
    const auto x =
        static_cast<std::uint32_t>(block.x) + static_cast<std::uint32_t>(i % static_cast<std::size_t>(block.width));
    const auto y =
        static_cast<std::uint32_t>(block.y) + static_cast<std::uint32_t>(i / static_cast<std::size_t>(block.width));
    return y * columns + x;
  };
  std::vector<Random> random;
  std::vector<PathColours> colours;
  random.reserve(pixels), colours.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    random.emplace_back(seed_, pixel_at(i), std::uint64_t{sample} * PictureSums::rounds + round);
    colours.push_back(colours_.draw(random.back()()));
  }
  LensCamera::Batch batch;
  std::vector<std::vector<petzval::Importance>> seen;  // importances of the batch's rays, by lane
  if (integrator_ != Integrator::light) {
    batch.resize(pixels, !colours.front().one_wavelength);
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::uint32_t pixel = pixel_at(i);
      const auto film_uv = drawn(seed_, Dimension::film, pixel, round, sample);
      const auto pupil = drawn(seed_, Dimension::pupil, pixel, round, sample);
      batch.raster_x[i] = static_cast<float>(pixel % columns + film_uv.x);
      batch.raster_y[i] = static_cast<float>(pixel / columns + film_uv.y);
      batch.u[i] = static_cast<float>(pupil.x), batch.v[i] = static_cast<float>(pupil.y);
    }
    for (std::size_t i = 0; i < batch.nm.size(); ++i) {
      batch.nm[i] = colours[i].nm[static_cast<std::size_t>(colours[i].hero)];
    }
    const Stopwatch watch(lens_seconds);
    lens_.sample(batch);
    const bool one = colours.front().one_wavelength;
    if (!lens_.pinhole() && (integrator_ == Integrator::bidirectional || !one)) {
      seen.resize(one ? 1 : static_cast<std::size_t>(colours.front().lanes));
      std::vector<float> nm(batch.nm.size());
      for (std::size_t lane = 0; lane < seen.size(); ++lane) {
        for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = colours[i].nm[lane];
        seen[lane].resize(pixels);
        lens_.importance(batch, nm, seen[lane]);
      }
    }
  }
  LensConnections connections(scene_, lens_, integrator_ == Integrator::bidirectional);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (integrator_ == Integrator::light) {
      trace_light(scene_, colours[i], random[i], connections);
      continue;
    }
    const LensView view(lens_, colours[i], lens_seconds);
    const FilmSample film = view.film_sample(batch, i, pixel_at(i), seen);
    if (integrator_ == Integrator::path) trace_path(scene_, view, film, random[i], splats);
    if (integrator_ == Integrator::bidirectional) {
      trace_both(scene_, view, film, random[i], connections, splats);
    }
  }
  connections.finish(splats, lens_seconds);
}

}  // namespace renderer
