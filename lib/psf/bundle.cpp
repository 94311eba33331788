// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/bundle.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <utility>

#include "film.hpp"
#include "petzval/core/error.hpp"
#include "petzval/psf/sobol.hpp"
#include "ray_batch.hpp"

namespace petzval {

FilmHits trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples, std::uint32_t seed,
                      int threads) {
  if (threads < 1) throw Error("trace_bundle: threads is " + std::to_string(threads) + ", wanted 1 or more");
  FilmHits hits;
  hits.sent = samples;
  hits.sampled_area = pupil.area();
  if (pupil.empty() || samples == 0) return hits;

  // Chunks of fixed size, each with its own hits, joined in their order: which thread did one leaves no trace.
  constexpr std::uint32_t chunk_size = 4096;
  const std::uint32_t chunks = (samples - 1) / chunk_size + 1;
  struct Chunk {
    std::vector<double> x, y;
  };
  std::vector<Chunk> found(chunks);
  const detail::Film film(lens);
  const auto work = [&](std::uint32_t first, std::uint32_t stride) {
    detail::RayBatch batch(chunk_size);
    for (std::uint32_t c = first; c < chunks; c += stride) {
      batch.clear();
      const std::uint32_t begin = c * chunk_size;
      for (std::uint32_t i = 0; i < std::min(chunk_size, samples - begin); ++i) {
        const auto [u, v] = owen_sobol(begin + i, seed);
        const auto [x, y] = pupil(u, v);
        batch.push(pupil.plane().ray(x, y));
      }
      batch.trace(lens, pupil.wavelength());
      Chunk chunk;
      for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto hit = batch.transmitted(i) ? film.meet(batch[i]) : std::nullopt;
        if (!hit) continue;
        chunk.x.push_back((*hit)[0]);
        chunk.y.push_back((*hit)[1]);
      }
      found[c] = std::move(chunk);
    }
  };
  const auto workers = std::min(static_cast<std::uint32_t>(threads), chunks);
  if (workers == 1) {
    work(0, 1);
  } else {
    std::vector<std::jthread> team;
    for (std::uint32_t t = 0; t < workers; ++t) team.emplace_back(work, t, workers);
  }

  for (const Chunk& chunk : found) {
    hits.x.insert(hits.x.end(), chunk.x.begin(), chunk.x.end());
    hits.y.insert(hits.y.end(), chunk.y.begin(), chunk.y.end());
  }
  return hits;
}

}  // namespace petzval
