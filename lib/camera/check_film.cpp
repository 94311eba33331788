// SPDX-License-Identifier: Apache-2.0
#include "check_film.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "core/check_rectangle.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/film.hpp"
#include "pupil/surface_box.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

namespace {

/// Checks points on the edge of the film and points next to the rim of the last surface.
/// @throws Error  if the film reaches into the last surface
void check_outside_surface(const Lens& lens, const Film& film) {
  const pupil_detail::SurfaceBox box = pupil_detail::last_surface_box(lens);
  const std::size_t last = lens.surface_count() - 1;
  const double side = film.z() > box.vertex_z ? 1 : -1;
  const auto check = [&](const FilmPoint& point) {
    const Vec3<double> position = film.position(point);
    if (!(std::hypot(position.x, position.y) <= box.half)) return;
    const double surface_z = box.vertex_z + sag(lens, last, position.x, position.y);
    if (!((position.z - surface_z) * side <= 0)) return;
    throw Error(lens.name() + ": film: point (" + to_text(point.x) + ", " + to_text(point.y) +
                ") mm is at z = " + to_text(position.z) + " mm; must be " + (side > 0 ? "beyond " : "before ") +
                to_text(surface_z) + " mm, z of the last surface");
  };
  constexpr int steps = 32;
  const auto [lower_left, lower_right, upper_left, upper_right] = film.corners();
  const std::array around{lower_left, lower_right, upper_right, upper_left};
  for (std::size_t k = 0; k < around.size(); ++k) {
    const FilmPoint &from = around[k], &to = around[(k + 1) % around.size()];
    for (int i = 0; i < steps; ++i) {
      const double fraction = static_cast<double>(i) / steps;
      const FilmPoint edge{from.x + fraction * (to.x - from.x), from.y + fraction * (to.y - from.y)};
      check(edge);
      const double rim_ratio = std::hypot(edge.x, edge.y) / (box.half * (1 - 1e-9));
      const FilmPoint under_rim{edge.x / rim_ratio, edge.y / rim_ratio};
      if (rim_ratio > 1 && film.contains(under_rim)) check(under_rim);
    }
  }
}

/// @throws Error  if a corner of a tilted film is not behind the end of the last surface
void check_tilted(const Lens& lens, const Film& film) {
  const pupil_detail::SurfaceBox box = pupil_detail::last_surface_box(lens);
  const double film_z = film.z();
  // End of the last surface on the side of the film; its vertex if the surface extends past the upright film.
  const double side = film_z > box.vertex_z ? 1 : -1, edge = side > 0 ? box.z_max : box.z_min;
  const double end = (film_z - edge) * side > 0 ? edge : box.vertex_z;
  for (const FilmPoint& corner : film.corners()) {
    const double z = film.position(corner).z;
    if ((z - end) * side > 0) continue;
    throw Error(lens.name() + ": film: tilt_rad = " + to_text(film.tilt_rad) +
                ", swing_rad = " + to_text(film.swing_rad) + " rad: corner (" + to_text(corner.x) + ", " +
                to_text(corner.y) + ") mm is at z = " + to_text(z) + " mm; must be " +
                (side > 0 ? "beyond " : "before ") + to_text(end) + " mm, the end of the last surface");
  }
}

}  // namespace

FilmBehindLens placed(const Lens& lens, const Film& film) {
  // A prescription may place its film anywhere, even at a virtual image.
  FilmBehindLens result{with_film(lens, film.z_mm.value_or(lens.film_z())), film};
  result.film.z_mm = result.lens.film_z();
  return result;
}

void check_film(const Lens& lens, const Film& film) {
  core_detail::check_rectangle(lens.name() + ": film", film);
  check_outside_surface(lens, film);
  if (film.tilted()) check_tilted(lens, film);
  if (film.travel_mm == 0) return;
  try {
    check_film(lens, placed(lens, film.at(1)).film);
  } catch (const Error& error) {
    throw Error(std::string(error.what()) + "; the film is there after a travel of " + to_text(film.travel_mm) + " mm");
  }
}

void check_upright_film(const Lens& lens, const Film& film) {
  check_film(lens, film);
  if (film.travel_mm != 0) {
    throw Error(lens.name() + ": film: travel = " + to_text(film.travel_mm) + " mm; must be 0");
  }
  if (!film.tilted()) return;
  throw Error(lens.name() + ": film: tilt_rad = " + to_text(film.tilt_rad) +
              ", swing_rad = " + to_text(film.swing_rad) + " rad; both must be 0");
}

}  // namespace petzval::camera_detail
