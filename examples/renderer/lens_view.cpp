// SPDX-License-Identifier: Apache-2.0
#include "renderer/lens_view.hpp"

#include <algorithm>

namespace renderer {

petzval::Wavelength LensView::wavelength(int lane) const noexcept {
  if (colours_.one_wavelength) return {};
  return petzval::Wavelength::nm(double{colours_.nm[static_cast<std::size_t>(lane)]});
}

std::uint32_t LensView::pixel_of(const petzval::Importance& seen) const noexcept {
  const petzval::Film& film = lens_.film();
  const auto clamped_index = [](double raster, int count) {
    return static_cast<std::uint32_t>(std::clamp(static_cast<int>(raster), 0, count - 1));
  };
  return clamped_index(seen.raster.y, film.rows) * static_cast<std::uint32_t>(film.columns) +
         clamped_index(seen.raster.x, film.columns);
}

bool LensView::same_tile(std::uint32_t a, std::uint32_t b) const noexcept {
  const auto columns = static_cast<std::uint32_t>(lens_.film().columns);
  constexpr auto side = static_cast<std::uint32_t>(PictureSums::tile_pixels);
  return a % columns / side == b % columns / side && a / columns / side == b / columns / side;
}

void LensView::add(SeenRay& ray, int lane, const petzval::Importance& seen, double by_connection) const noexcept {
  const auto all = colours_.one_wavelength ? colours_.lanes : 1;
  for (int i = lane; i < lane + all; ++i) {
    if (!seen) continue;
    ray.we[i] = static_cast<float>(seen.we);
    ray.pixels[static_cast<std::size_t>(i)] = pixel_of(seen);
  }
  const double lane_fraction = static_cast<double>(all) / colours_.lanes;
  ray.by_film += lane_fraction * (seen ? seen.pdf_position * seen.pdf_direction : 0);
  ray.by_connection += lane_fraction * by_connection;
}

SeenRay LensView::at_all_lanes(const LensCamera::Connection& hero, const glm::vec3* point) const noexcept {
  SeenRay result{.direction = hero.direction, .on_front = hero.on_front};
  if (!(hero.pdf > 0)) return result;
  if (colours_.one_wavelength) {
    add(result, 0, hero.importance, hero.pdf);
    return result;
  }
  if (lens_.pinhole()) {  // a pinhole connects only the hero; other lanes connect when they are the hero
    add(result, colours_.hero, hero.importance, hero.pdf);
    result.we *= static_cast<float>(colours_.lanes);
    result.by_film *= colours_.lanes, result.by_connection *= colours_.lanes;
    return result;
  }
  for (int lane = 0; lane < colours_.lanes; ++lane) {
    if (lane == colours_.hero) {
      add(result, lane, hero.importance, hero.pdf);
    } else {
      add(result, lane, lens_.importance(hero.on_front, hero.direction, wavelength(lane)),
          point ? lens_.pdf_connection(*point, hero.direction, wavelength(lane))
                : lens_.pdf_distant_connection({hero.on_front, hero.direction}, wavelength(lane)));
    }
  }
  return result;
}

LensView::Densities LensView::densities(const FilmSample& sample, const SurfacePoint* from) const noexcept {
  const Stopwatch watch(seconds_);
  if (lens_.pinhole()) {
    const auto point = from ? &from->position : nullptr;
    const SeenRay seen = at_all_lanes(from ? lens_.connect(*point, sample.u, sample.v, hero())
                                           : lens_.connect_distant(-sample.ray.direction, sample.u, sample.v, hero()),
                                      point);
    return {seen.by_film, seen.by_connection};
  }
  Densities result{.by_film = sample.by_film};
  const int calls = colours_.one_wavelength ? 1 : colours_.lanes;
  for (int lane = 0; lane < calls; ++lane) {
    const glm::vec3 direction = -sample.ray.direction;
    result.by_connection += (from ? lens_.pdf_connection(from->position, direction, wavelength(lane))
                                  : lens_.pdf_distant_connection({sample.ray.origin, direction}, wavelength(lane))) /
                            calls;
  }
  return result;
}

FilmSample LensView::film_sample(const LensCamera::Batch& batch, std::size_t index, std::uint32_t pixel,
                                 std::span<const std::vector<petzval::Importance>> seen) const noexcept {
  FilmSample result{.ray = batch.rays[index], .u = batch.u[index], .v = batch.v[index]};
  const float weight = batch.weights[index];
  if (!(weight > 0)) return result;
  SeenRay ray;
  for (std::size_t lane = 0; lane < seen.size(); ++lane) add(ray, static_cast<int>(lane), seen[lane][index], 0);
  result.by_film = ray.by_film;
  if (colours_.one_wavelength || lens_.pinhole()) {
    const int first = colours_.one_wavelength ? 0 : colours_.hero, count = colours_.one_wavelength ? colours_.lanes : 1;
    for (int lane = first; lane < first + count; ++lane) {
      result.weight[lane] = colours_.one_wavelength ? weight : weight * static_cast<float>(colours_.lanes);
      result.pixels[static_cast<std::size_t>(lane)] = pixel;
    }
  } else {
    // Tiles have different numbers of samples: a lane counts only in the tile of the sample, and its density is that of
    // the lanes in this tile, each of which could be the hero.
    double density = 0;
    for (int lane = 0; lane < colours_.lanes; ++lane) {
      std::uint32_t& own = ray.pixels[static_cast<std::size_t>(lane)];
      if (own != no_pixel && !same_tile(own, pixel)) own = no_pixel;
      const petzval::Importance& importance = seen[static_cast<std::size_t>(lane)][index];
      if (own != no_pixel) density += importance.pdf_position * importance.pdf_direction / colours_.lanes;
    }
    for (int lane = 0; density > 0 && lane < colours_.lanes; ++lane) {
      if (ray.pixels[static_cast<std::size_t>(lane)] == no_pixel) continue;
      result.weight[lane] = ray.we[lane] / static_cast<float>(density);
    }
    result.pixels = ray.pixels;
  }
  return result;
}

}  // namespace renderer
