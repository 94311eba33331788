// SPDX-License-Identifier: Apache-2.0
#include "film_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "petzval/paraxial/first_order.hpp"
#include "pupil/pupil_plane.hpp"
#include "pupil/surface_box.hpp"
#include "trace/clearances.hpp"

namespace petzval::pupil_table_detail {

pupil_detail::PositionClearances traced_lines(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points,
                                              std::size_t wavelength) {
  const double towards = towards_scene(lens, space);
  return
      [&lens, space, towards, wavelength, points = std::move(points), memory = std::array<std::vector<double>, 6>{}](
          std::size_t count, const std::uint32_t* which, const double* x, const double* y, double* clearances) mutable {
        // Blocks fit into the cache.
        constexpr std::size_t block = 1024;
        for (auto& a : memory) a.resize(std::min(count, block));
        const auto at = [&](std::size_t k) { return memory[k].data(); };
        const double depth = space.depth();
        for (std::size_t begin = 0; begin < count; begin += block) {
          const std::size_t size = std::min(block, count - begin);
          for (std::size_t i = 0; i < size; ++i) {
            const FilmPoint& film = points[which[begin + i]];
            const double px = x[begin + i], py = y[begin + i], dx = px - film.x, dy = py - film.y;
            const double per_length = towards / std::sqrt(dx * dx + dy * dy + depth * depth);
            memory[0][i] = px, memory[1][i] = py, memory[2][i] = space.pupil_z;
            memory[3][i] = dx * per_length, memory[4][i] = dy * per_length, memory[5][i] = depth * per_length;
          }
          trace_detail::clearances<double>(lens, size, {at(0), at(1), at(2), at(3), at(4), at(5)}, clearances + begin,
                                           {.travel = Travel::to_scene, .wavelengths = {wavelength}});
        }
      };
}

std::vector<pupil_detail::PupilGuess> first_order_guesses(const Lens& lens, const TwoPlanes& space,
                                                          std::span<const FilmPoint> points, std::size_t wavelength) {
  const Pupils paraxial = petzval::pupils(lens, wavelength);
  const std::size_t last = lens.surface_count() - 1;
  const double last_z = lens.surfaces()[last].vertex_z;
  const pupil_detail::SurfaceBox box = pupil_detail::surface_box(lens, last, paraxial.entrance);
  const auto seen = [&](double film, double at, double z) {  // projects to the pupil plane
    return film + (at - film) * space.depth() / (z - space.film_z);
  };
  double radius = std::isfinite(paraxial.exit.z) && paraxial.exit.z != space.film_z
                      ? std::abs(seen(0, paraxial.exit.diameter / 2, paraxial.exit.z))
                      : 0;
  const bool somewhere = radius > 0;
  if (!somewhere) radius = std::abs(seen(0, box.half, last_z)) / 8;
  const auto surfaces = lens.surfaces();
  const bool ring = std::any_of(surfaces.begin(), surfaces.end(),
                                [](const LensSurface& s) { return s.obscuration_semi_diameter > 0; });
  std::vector<pupil_detail::PupilGuess> result;
  for (const FilmPoint& p : points) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double z : {box.z_min, box.z_max, last_z}) {
      // A face at the film would be seen at any angle; a face beyond the film counts as close to the film.
      const double least = 0.02 * std::abs(space.film_z - last_z);
      const double from_film = z - space.film_z;
      const double at = space.film_z + std::copysign(std::max(std::abs(from_film), least), last_z - space.film_z);
      for (const double edge : {-box.half, box.half}) {
        low = std::min(low, seen(p.y, edge, at));
        high = std::max(high, seen(p.y, edge, at));
      }
    }
    const double across = lens.rotationally_symmetric() ? 0 : seen(p.x, 0, last_z), margin = 0.05 * (high - low);
    const double y = seen(p.y, 0, somewhere ? paraxial.exit.z : last_z);
    constexpr double radii = 16;
    result.push_back({across, low - margin, high + margin, radius, y, radii * radius, ring});
  }
  return result;
}

}  // namespace petzval::pupil_table_detail
