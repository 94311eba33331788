// SPDX-License-Identifier: Apache-2.0
#include "renderer/unit_tracer.hpp"

#include "petzval/core/sobol.hpp"

namespace renderer {
namespace {

/// Seeds of numbers drawn before a path begins. The path itself uses the unmodified seed.
enum class Dimension : std::uint64_t { film = 1, pupil = 2 };

/// Point of the unit square for a sample of a pixel: the Owen-Sobol sequence of its round.
petzval::Vec2<double> drawn_point(std::uint64_t seed, Dimension what, std::uint32_t pixel, std::uint32_t round,
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

void UnitTracer::trace(const PixelBlock& block, const SampleRange& samples, Splats& film, Splats& light,
                       double& lens_seconds) const {
  // A ray is the same in two batches only up to rounding. Batches of one sample per pixel make the bits independent of
  // the division of samples among calls.
  for (std::uint32_t i = 0; i < samples.count; ++i) {
    trace_once(block, samples, samples.first + i, film, light, lens_seconds);
  }
}

UnitTracer::Drawn UnitTracer::draw(const PixelBlock& block, std::uint32_t round, std::uint32_t sample) const {
  const auto columns = static_cast<std::uint32_t>(lens_.film().columns);
  Drawn drawn;
  for (int y = block.y; y < block.y + block.height; ++y) {
    for (int x = block.x; x < block.x + block.width; ++x) {
      drawn.pixels.push_back(static_cast<std::uint32_t>(y) * columns + static_cast<std::uint32_t>(x));
      drawn.random.emplace_back(seed_, drawn.pixels.back(), std::uint64_t{sample} * PictureSums::rounds + round);
      drawn.colours.push_back(colours_.draw(drawn.random.back()()));
    }
  }
  return drawn;
}

LensCamera::Batch UnitTracer::batch_of(const Drawn& drawn, std::uint32_t round, std::uint32_t sample) const {
  const auto columns = static_cast<std::uint32_t>(lens_.film().columns);
  LensCamera::Batch batch;
  batch.resize(drawn.pixels.size(), !drawn.colours.front().one_wavelength);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::uint32_t pixel = drawn.pixels[i];
    const auto film_uv = drawn_point(seed_, Dimension::film, pixel, round, sample);
    const auto pupil = drawn_point(seed_, Dimension::pupil, pixel, round, sample);
    batch.raster_x[i] = static_cast<float>(pixel % columns + film_uv.x);
    batch.raster_y[i] = static_cast<float>(pixel / columns + film_uv.y);
    batch.u[i] = static_cast<float>(pupil.x), batch.v[i] = static_cast<float>(pupil.y);
  }
  for (std::size_t i = 0; i < batch.nm.size(); ++i) {
    batch.nm[i] = drawn.colours[i].nm[static_cast<std::size_t>(drawn.colours[i].hero)];
  }
  return batch;
}

void UnitTracer::add_first_hits(const PixelBlock& block, std::uint32_t round, std::uint32_t sample,
                                std::span<FirstHit> sums) const {
  LensCamera::Batch batch = batch_of(draw(block, round, sample), round, sample);
  lens_.sample(batch);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (!(batch.weights[i] > 0)) continue;
    const auto& [origin, direction] = batch.rays[i];
    sums[i].add(scene_.meet(origin, direction), direction, batch.weights[i], lens_);
  }
}

void UnitTracer::trace_once(const PixelBlock& block, const SampleRange& samples, std::uint32_t sample,
                            Splats& film_splats, Splats& light_splats, double& lens_seconds) const {
  Drawn drawn = draw(block, samples.round, sample);
  auto& [pixel_at, random, colours] = drawn;
  const std::size_t pixels = pixel_at.size();
  const bool from_film = this->from_film() && samples.film, from_light = this->from_light() && samples.light;
  LensCamera::Batch batch;
  std::vector<std::vector<petzval::Importance>> seen;  // importances of the batch's rays, by lane
  if (from_film) {
    batch = batch_of(drawn, samples.round, sample);
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
      if (from_light) trace_light(scene_, colours[i], random[i], connections);
      continue;
    }
    const LensView view(lens_, colours[i], lens_seconds);
    FilmSample film;
    if (from_film) film = view.film_sample(batch, i, pixel_at[i], seen);
    if (integrator_ == Integrator::path && from_film) trace_path(scene_, view, film, random[i], film_splats);
    if (integrator_ == Integrator::bidirectional) {
      trace_both(scene_, view, from_film ? &film : nullptr, random[i], from_light ? &connections : nullptr,
                 film_splats);
    }
  }
  connections.finish(light_splats, lens_seconds);
}

}  // namespace renderer
