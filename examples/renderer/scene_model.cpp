// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include <glm/glm.hpp>

#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/sobol.hpp"
#include "renderer/luminance.hpp"
#include "renderer/render.hpp"
#include "support/text.hpp"

namespace renderer {
namespace {

using examples::number;

/// Depth range of the visible surfaces, along the axis from the front vertex, mm; infinite for the sky.
std::array<double, 2> depths(const Scene& scene, const LensCamera& exact) {
  constexpr std::size_t count = 4096;
  LensCamera::Batch batch;
  batch.resize(count, false);
  for (std::size_t i = 0; i < count; ++i) {
    const auto film_uv = petzval::owen_sobol(static_cast<std::uint32_t>(i), 1);
    const auto pupil = petzval::owen_sobol(static_cast<std::uint32_t>(i), 2);
    batch.raster_x[i] = static_cast<float>(film_uv.x * exact.film().columns);
    batch.raster_y[i] = static_cast<float>(film_uv.y * exact.film().rows);
    batch.u[i] = static_cast<float>(pupil.x), batch.v[i] = static_cast<float>(pupil.y);
  }
  exact.sample(batch);
  double near = std::numeric_limits<double>::infinity(), far = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(batch.weights[i] > 0)) continue;
    const auto met = scene.meet(batch.rays[i].origin, batch.rays[i].direction);
    const double depth = met ? exact.depth(met->position) : std::numeric_limits<double>::infinity();
    // Points beside or behind the lens have no plane in front of it.
    if (depth > 0) near = std::min(near, depth);
    far = std::max(far, depth);
  }
  return {near, far};
}

/// The depths at which models are measured, or the exact lens with a reason why models cannot be measured.
std::variant<std::array<double, 2>, ModelForScene> measurable(const Scene& scene, const LensCamera& exact) {
  const petzval::Film& film = exact.film();
  const auto exact_lens = [](const char* why) { return ModelForScene{petzval::ModelKind::exact_float, {why}}; };
  if (film.tilted() || film.travel_mm != 0) {
    return exact_lens("the film is tilted: the exact lens, because models are measured on upright films");
  }
  const auto range = depths(scene, exact);
  if (std::isinf(range[0])) {
    return exact_lens("the picture shows only the sky: the exact lens, because there is no depth to measure at");
  }
  return range;
}

petzval::ModelChoice choice(const LensCamera& exact, const std::array<double, 2>& depths,
                            const petzval::ErrorBudget& budget, int threads) {
  return petzval::choose_model(exact.camera().lens(), {.near_mm = depths[0], .far_mm = depths[1], .film = exact.film()},
                               budget, threads);
}

std::string in_words(const std::array<double, 2>& depths) {
  return number(depths[0], 3) + " mm to " + (std::isinf(depths[1]) ? "infinity" : number(depths[1], 3) + " mm") +
         " from the front vertex";
}

/// Statistics of a small pilot picture.
struct Pilot {
  double noise = 0;  ///< RMS noise of one sample per pixel
  double slope = 0;  ///< RMS slope of the full-size picture, per pixel
  double contrast = 0, brightness = 0;
};

Pilot pilot_of(const Scene& scene, const LensCamera& exact, const PathColourSource& colours, Integrator integrator) {
  constexpr int pixels = 96 * 64, samples = 16;
  petzval::Film film = exact.film();
  const double scale = std::min(1.0, std::sqrt(pixels / (static_cast<double>(film.columns) * film.rows)));
  film.columns = std::max(1, static_cast<int>(std::lround(film.columns * scale)));
  film.rows = std::max(1, static_cast<int>(std::lround(film.rows * scale)));
  const LensCamera lens(petzval::Camera(exact.camera().lens(), film,
                                        {.model = petzval::ModelKind::exact_float,
                                         .normalisation = petzval::Normalisation::unity_on_axis}),
                        scene.description().pose);
  std::array<std::vector<double>, 2> halves;
  for (std::size_t half = 0; half < 2; ++half) {
    PictureSums sums(film.columns, film.rows);
    std::vector<std::size_t> tiles(sums.tiles());
    for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t] = t;
    const UnitTracer tracer(scene, lens, colours, integrator, 0x9e37 + half);
    for (const std::size_t tile : tiles) {
      Splats splats, light;
      double seconds = 0;
      tracer.trace(sums.block(tile), {.count = samples}, splats, light, seconds);
      sums.add(tile, 0, samples, splats.all());
      sums.add(tile, 0, samples, light.all(), PictureSums::Of::light);
    }
    const petzval::RgbImage image = sums.picture();
    for (std::size_t p = 0; p < image.pixels.size(); p += 3) {
      const float* const rgb = &image.pixels[p];
      halves[half].push_back(std::min(1.0, static_cast<double>(luminance({rgb[0], rgb[1], rgb[2]}))));
    }
  }
  Pilot result;
  const auto& [a, b] = halves;
  const auto columns = static_cast<std::size_t>(film.columns);
  double noise = 0, slope = 0, product = 0, mean = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    noise += (a[p] - b[p]) * (a[p] - b[p]) / 2;
    product += a[p] * b[p];
    mean += (a[p] + b[p]) / 2;
    if (p % columns + 1 < columns) slope += (a[p + 1] - a[p]) * (b[p + 1] - b[p]);
    if (p + columns < a.size()) slope += (a[p + columns] - a[p]) * (b[p + columns] - b[p]);
  }
  const auto count = static_cast<double>(a.size());
  mean /= count;
  result.noise = std::sqrt(noise / count * samples);
  result.slope = std::sqrt(std::max(0.0, slope / count) * scale);  // edges per length are independent of the size
  result.contrast = std::sqrt(std::max(0.0, product / count - mean * mean));
  result.brightness = std::sqrt(std::max(0.0, product / count));
  return result;
}

}  // namespace

ModelForScene model_within(const Scene& scene, const LensCamera& exact, double budget_px, int threads) {
  const auto measured_at = measurable(scene, exact);
  if (const auto* const exact_lens = std::get_if<ModelForScene>(&measured_at)) return *exact_lens;
  const auto& range = std::get<0>(measured_at);
  const petzval::ModelChoice made =
      choice(exact, range, {.max_px = budget_px, .exposure = 0.01, .pupil_shape = 0.02}, threads);
  ModelForScene result{made.model, {"rays within " + number(budget_px) + " px at " + in_words(range)}};
  result.why.insert(result.why.end(), made.reasons.begin(), made.reasons.end());
  return result;
}

ModelForScene model_below_noise(const Scene& scene, const LensCamera& exact, const PathColourSource& colours,
                                Integrator integrator, std::uint32_t samples, int threads) {
  const auto measured_at = measurable(scene, exact);
  if (const auto* const exact_lens = std::get_if<ModelForScene>(&measured_at)) return *exact_lens;
  const auto& range = std::get<0>(measured_at);
  const Pilot pilot = pilot_of(scene, exact, colours, integrator);
  const double noise = pilot.noise / std::sqrt(static_cast<double>(samples));
  const petzval::ModelChoice measured = choice(exact, range, {.max_px = 0, .pupil_shape = 0}, threads);
  const petzval::ModelCandidate* best = nullptr;
  double best_bias = 0;
  std::vector<std::string> refused;
  for (const petzval::ModelCandidate& c : measured.table) {
    if (!c.available) continue;
    const double moved = c.error.all.rms_px * pilot.slope / std::sqrt(2.0);
    const double bias =
        std::hypot(moved, std::min(c.error.pupil_shape, 1.0) * pilot.contrast, c.error.exposure * pilot.brightness);
    if (!(bias <= noise / 10)) {
      if (!best) refused.push_back(std::string(petzval::name(c.model)) + ": bias " + number(bias, 2));
      continue;
    }
    if (best && !(c.cost < 0.9 * best->cost)) continue;
    best = &c, best_bias = bias;
  }
  ModelForScene result;
  result.why.push_back("noise of " + std::to_string(samples) + " samples: " + number(noise, 2) +
                       " of white; the bias may be at most " + number(noise / 10, 2) + "; depths " + in_words(range));
  if (best) {
    result.model = best->model;
    result.why.push_back(std::string(petzval::name(best->model)) + ": bias " + number(best_bias, 2) + ", cost " +
                         number(best->cost, 2) + " (" + number(best->ns_per_ray, 2) + " ns per ray)");
  } else {
    result.model = petzval::ModelKind::exact_double;
    result.why.push_back("exact_double: all other models have too much bias");
  }
  if (!refused.empty()) {
    std::string line = "rejected: ";
    for (const std::string& r : refused) line += (&r == refused.data() ? "" : "; ") + r;
    result.why.push_back(line);
  }
  return result;
}

}  // namespace renderer
