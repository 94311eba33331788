// SPDX-License-Identifier: Apache-2.0
#include "renderer/ghosts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_access.hpp>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "renderer/frame.hpp"
#include "renderer/luminance.hpp"
#include "renderer/random.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/picture_files.hpp"

namespace renderer {
namespace {

using petzval::Vec3;

/// The area of the beam of a light on the first surface, and the part of it that no object stops, relative to the area
/// within the rim.
std::array<double, 2> beam(const Scene& scene, const LensCamera& camera, const LightPoint& from,
                           const petzval::ScenePoint& light) {
  constexpr std::uint32_t count = 16;
  const petzval::Lens& lens = camera.camera().lens();
  const double rim = lens.surfaces()[0].semi_diameter, step = 1e-4 * rim;
  std::array<double, 2> result{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec2 sample(petzval::owen_sobol(i, 0));
    const glm::dvec2 at = rim * glm::dvec2(on_disc(sample.x, sample.y));
    const Vec3<double> point{at.x, at.y, petzval::sag(lens, 0, at.x, at.y)};
    const Vec3<double> next = point + step * glm::normalize(light.position - (light.at_infinity ? 0.0 : 1.0) * point);
    // The height above the surface after a step towards the light is the area of the beam for an area of the disc.
    const double area = (petzval::sag(lens, 0, next.x, next.y) - next.z) / step / count;
    if (!(area > 0)) continue;
    const glm::vec3 front = camera.to_world(point);
    result[0] += area;
    if (from.surface ? scene.sees(*from.surface, front) : scene.sees_sky(front, -from.travel)) result[1] += area;
  }
  return result;
}

/// Light of all ghosts for lights of equal irradiance at multiples of 10 degrees from the axis, at least 1 % of the
/// most.
std::array<double, 13> responses(const petzval::Lens& lens, int threads) {
  std::array<double, 13> result{};
  for (std::size_t k = 0; k < result.size(); ++k) {
    const double angle = petzval::radians(10.0 * static_cast<double>(k)), across = std::sin(angle) / std::sqrt(2.0);
    try {
      const petzval::Ghosts ghosts = petzval::ghost_pairs(lens, {{across, across, -std::cos(angle)}, true},
                                                          {.max_pairs = 200, .tolerance = 0.1, .threads = threads});
      for (const petzval::GhostPair& pair : ghosts.pairs) result[k] += pair.energy * ghosts.entering_mm2;
    } catch (const petzval::Error&) {  // no light enters from the side
      if (k == 0) throw;
    }
  }
  const double most = *std::ranges::max_element(result);
  for (double& value : result) value = std::max({value, 0.01 * most, 1e-30});
  return result;
}

}  // namespace

std::vector<GhostLight> ghost_lights(const Scene& scene, const LensCamera& lens, std::uint32_t count,
                                     std::uint32_t seed, int threads) {
  const std::uint32_t candidates = 64 * count;
  Random random(seed, candidates, 0);
  const float first = random();
  const auto response = responses(lens.camera().lens(), threads);
  std::vector<GhostLight> lights, kept;
  std::vector<double> ends{0};
  for (std::uint32_t i = 0; i < candidates; ++i) {
    const glm::vec2 at(petzval::owen_sobol(i, seed));
    const LightPoint from =
        scene.sample_light((static_cast<float>(i) + first) / static_cast<float>(candidates), at.x, at.y);
    if (!from) continue;
    petzval::ScenePoint point{.position = lens.turn_to_lens(-from.travel), .at_infinity = true};
    double irradiance = 1 / (from.pdf * candidates);
    if (from.surface) {
      const glm::dvec3 to = lens.front() - from.surface->position;
      point = {.position = lens.to_lens(from.surface->position), .at_infinity = false};
      irradiance *= glm::dot(glm::dvec3(from.surface->normal), to) / std::pow(glm::length(to), 3);
    }
    const auto [area, free] = beam(scene, lens, from, point);
    if (!(free > 0 && irradiance > 0) || area < 1e-3) continue;  // grazing
    const double at_10 =
        petzval::degrees(std::atan2(std::hypot(point.position.x, point.position.y), -point.position.z)) / 10;
    const auto k = std::min(static_cast<std::size_t>(at_10), response.size() - 2);
    const double value =
        luminance(from.radiance) * std::lerp(response[k], response[k + 1], std::min(at_10 - double(k), 1.0));
    lights.push_back({point, from.radiance / static_cast<float>(value)});
    ends.push_back(ends.back() + value * irradiance * free / area);
  }
  for (std::uint32_t k = 0; k < count && !lights.empty(); ++k) {
    const double at = (k + double{random()}) / count * ends.back();
    kept.push_back(
        lights[static_cast<std::size_t>(std::upper_bound(ends.begin() + 1, ends.end() - 1, at) - ends.begin() - 1)]);
    kept.back().irradiance *= static_cast<float>(ends.back() / count);
  }
  return kept;
}

PictureSums::Channels ghosts(const petzval::Camera& camera, const std::vector<GhostLight>& lights,
                             const PathColourSource& colours, double scale, int threads) {
  constexpr int draws = 1024;
  const auto compiled = colours.compiled_nm();
  std::vector<glm::mat3> mixes(compiled.size(), glm::mat3(0));  // RGB of the light to RGB of the picture
  for (int i = 0; i < draws; ++i) {
    const PathColours path = colours.draw((static_cast<float>(i) + 0.5f) / draws);
    for (int lane = 0; lane < path.lanes; ++lane) {
      const auto nearest = std::ranges::min_element(
          compiled, {}, [&](double nm) { return std::abs(nm - double{path.nm[static_cast<std::size_t>(lane)]}); });
      mixes[static_cast<std::size_t>(nearest - compiled.begin())] +=
          glm::outerProduct(path.to_rgb[lane], glm::row(path.from_rgb, lane)) * static_cast<float>(scale / draws);
    }
  }
  petzval::RgbImage sum(camera.film().columns, camera.film().rows);
  examples::Progress progress("ghosts", lights.size());
  for (const GhostLight& light : lights) {
    progress.step("of a light");
    std::vector<std::array<double, 3>> weights;
    for (const glm::mat3& mix : mixes) {
      const glm::dvec3 rgb(mix * light.irradiance);
      weights.push_back({rgb.r, rgb.g, rgb.b});
    }
    const auto image =
        examples::ghost_picture(camera.lens(), light.point, camera.film(), weights, {.threads = threads});
    std::ranges::transform(sum.pixels, image.pixels, sum.pixels.begin(), std::plus());
  }
  PictureSums::Channels result;
  examples::add_channels(result, "ghosts.", sum);
  return result;
}

}  // namespace renderer
