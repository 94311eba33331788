// SPDX-License-Identifier: Apache-2.0
#include "renderer/unit_tracer.hpp"

#include <algorithm>
#include <span>

#include "petzval/core/sobol.hpp"

namespace renderer {
namespace {

/// Seeds of what is drawn before a path begins; its own numbers have the seed itself.
enum class Drawn : std::uint64_t { film = 1, pupil = 2 };

/// Places of the unit square for the samples of a pixel, spread evenly among those of a unit.
void spread(std::uint64_t seed, Drawn what, std::uint32_t pixel, std::uint32_t first, std::span<double> u,
            std::span<double> v) {
  const auto key = mixed(mixed(mixed(seed + static_cast<std::uint64_t>(what)) + pixel) + first);
  petzval::owen_sobol(0, static_cast<std::uint32_t>(key), u, v);
}

}  // namespace

std::optional<Integrator> integrator_named(std::string_view name) noexcept {
  if (name == "path") return Integrator::path;
  if (name == "light") return Integrator::light;
  if (name == "bidirectional") return Integrator::bidirectional;
  return {};
}

void UnitTracer::trace(const PixelBlock& block, std::uint32_t first, std::uint32_t count, Splats& splats,
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
  const std::size_t paths = pixels * count;
  std::vector<Random> random;
  std::vector<PathColours> colours;
  random.reserve(paths), colours.reserve(paths);
  for (std::size_t i = 0; i < paths; ++i) {
    random.emplace_back(seed_, pixel_at(i / count), first + static_cast<std::uint32_t>(i % count));
    colours.push_back(colours_.draw(random.back()()));
  }
  LensCamera::Batch batch;
  std::vector<std::vector<petzval::Importance>> seen;  // of the batch's rays, by lane
  if (integrator_ != Integrator::light) {
    batch.resize(paths, !colours.front().one_wavelength);
    std::vector<double> u(count), v(count);
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::uint32_t pixel = pixel_at(p);
      const std::size_t begin = p * count;
      spread(seed_, Drawn::film, pixel, first, u, v);
      for (std::size_t i = 0; i < count; ++i) {
        batch.raster_x[begin + i] = static_cast<float>(pixel % columns + u[i]);
        batch.raster_y[begin + i] = static_cast<float>(pixel / columns + v[i]);
      }
      spread(seed_, Drawn::pupil, pixel, first, u, v);
      std::copy(u.begin(), u.end(), batch.u.begin() + static_cast<std::ptrdiff_t>(begin));
      std::copy(v.begin(), v.end(), batch.v.begin() + static_cast<std::ptrdiff_t>(begin));
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
        seen[lane].resize(paths);
        lens_.importance(batch, nm, seen[lane]);
      }
    }
  }
  LensConnections connections(scene_, lens_, integrator_ == Integrator::bidirectional);
  for (std::size_t i = 0; i < paths; ++i) {
    if (integrator_ == Integrator::light) {
      trace_light(scene_, colours[i], random[i], connections);
      continue;
    }
    const LensView view(lens_, colours[i], lens_seconds);
    const FilmSample sample = view.film_sample(batch, i, pixel_at(i / count), seen);
    if (integrator_ == Integrator::path) trace_path(scene_, view, sample, random[i], splats);
    if (integrator_ == Integrator::bidirectional) {
      trace_both(scene_, view, sample, random[i], connections, splats);
    }
  }
  connections.finish(splats, lens_seconds);
}

}  // namespace renderer
