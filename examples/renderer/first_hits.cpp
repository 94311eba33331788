// SPDX-License-Identifier: Apache-2.0
#include "renderer/first_hits.hpp"

#include <array>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

#include "petzval/core/parallel.hpp"
#include "renderer/albedo.hpp"
#include "renderer/unit_tracer.hpp"

namespace renderer {

void FirstHit::add(const std::optional<SurfacePoint>& point, const glm::vec3& direction, float weight,
                   const LensCamera& lens) noexcept {
  const auto w = static_cast<double>(weight);
  all += w;
  if (!point) return;
  met += w;
  albedo += w * glm::dvec3(reflectance(point->object->material, point->position, point->uv));
  normal += w * glm::dvec3(glm::dot(point->normal, direction) > 0 ? -point->shading : point->shading);
  depth += w * lens.depth(point->position);
}

PictureSums::Channels first_hits(const UnitTracer& tracer, const PictureSums& sums,
                                 const std::vector<std::size_t>& tiles, int threads) {
  constexpr std::uint32_t samples_of_round = 2;
  const std::vector<float> none(static_cast<std::size_t>(sums.width()) * static_cast<std::size_t>(sums.height()));
  PictureSums::Channels channels;
  std::array<std::vector<float>*, 3> albedos{}, normals{};
  for (std::size_t c = 0; c < 3; ++c) {
    albedos[c] = &channels.emplace(std::string("albedo.") + "RGB"[c], none).first->second;
    normals[c] = &channels.emplace(std::string("normal.") + "XYZ"[c], none).first->second;
  }
  std::vector<float>& depths = channels.emplace("depth.Z", none).first->second;
  petzval::parallel_for(tiles.size(), 1, threads, [&](std::size_t t, std::size_t) {
    const PixelBlock block = sums.block(tiles[t]);
    std::vector<FirstHit> hits(static_cast<std::size_t>(block.width * block.height));
    for (std::uint32_t round = 0; round < PictureSums::rounds; ++round) {
      for (std::uint32_t sample = 0; sample < samples_of_round; ++sample) {
        tracer.add_first_hits(block, round, sample, hits);
      }
    }
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto& [albedo, normal, depth, met, all] = hits[i];
      const std::size_t x = static_cast<std::size_t>(block.x) + i % static_cast<std::size_t>(block.width),
                        y = static_cast<std::size_t>(block.y) + i / static_cast<std::size_t>(block.width);
      const std::size_t pixel = y * static_cast<std::size_t>(sums.width()) + x;
      depths[pixel] = met > 0 ? static_cast<float>(depth / met) : std::numeric_limits<float>::infinity();
      if (!(met > 0)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        (*albedos[c])[pixel] = static_cast<float>(albedo[static_cast<int>(c)] / all);
        (*normals[c])[pixel] = static_cast<float>(normal[static_cast<int>(c)] / all);
      }
    }
  });
  return channels;
}

}  // namespace renderer
