// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "petzval/camera/camera_ray.hpp"
#include "scene_side.hpp"

namespace petzval {

namespace camera_detail {
namespace {

/// Angles by which the chief rays of a film point and of two neighbours miss a point, as sines along two axes.
struct Misses {
  std::array<std::array<double, 2>, 3> by{};
  bool lost = false;
};

}  // namespace

void SceneSide::chief_rays(const RayModel& model, std::size_t count, const TwoPlaneRays<const double>& lines,
                           Wavelength wavelength, const RayArrays<double>& rays, RayFate* fates) const noexcept {
  if (!traced_) return model.to_scene(count, lines, {.all = wavelength}, rays, fates);
  for (std::size_t i = 0; i < count; ++i) {
    const auto end =
        unclipped(*traced_, space_, wavelength, {lines.film_x[i], lines.film_y[i], lines.pupil_x[i], lines.pupil_y[i]});
    const auto& [o, d] = end.ray;
    rays.x[i] = o.x, rays.y[i] = o.y, rays.z[i] = o.z;
    rays.dx[i] = d.x, rays.dy[i] = d.y, rays.dz[i] = d.z;
    fates[i] = end.fate;
  }
}

Projection SceneSide::project(const RayModel& model, const Vec3<double>& point, Wavelength wavelength,
                              double time) const noexcept {
  Projection result;
  if (!wavelengths_.covers(wavelength) || !entrance_.in_front(point)) return result;
  const ChiefRayTable& chiefs = nearest(wavelength).chiefs;
  const auto start = chiefs.about(point);
  if (!start) return result;

  // Iterate over points of the upright film, and intersect the final ray with the real film.
  const double film_step = 1e-3 * upright_radius_;
  const auto misses = [&](const FilmPoint& film, double hx, double hy) noexcept {
    std::array<std::array<double, 3>, 4> line;
    std::array<std::array<double, 3>, 6> ray;
    std::array<RayFate, 3> fates;
    for (int i : {0, 1, 2}) {
      const FilmPoint f{film.x + (i == 1 ? hx : 0), film.y + (i == 2 ? hy : 0)};
      const auto [x, y] = chiefs.pupil_point(f);
      line[0][i] = f.x, line[1][i] = f.y, line[2][i] = x, line[3][i] = y;
    }
    chief_rays(model, 3, {line[0].data(), line[1].data(), line[2].data(), line[3].data()}, wavelength,
               {ray[0].data(), ray[1].data(), ray[2].data(), ray[3].data(), ray[4].data(), ray[5].data()},
               fates.data());
    Misses found;
    Vec3<double> across{1, 0, 0}, up{0, 1, 0};
    for (int i : {0, 1, 2}) {
      found.lost |= fates[i] != RayFate::transmitted;
      const Vec3<double> direction{ray[3][i], ray[4][i], ray[5][i]};
      const Vec3<double> target_direction = glm::normalize(point - Vec3<double>{ray[0][i], ray[1][i], ray[2][i]});
      if (i == 0) {
        across = glm::normalize(glm::cross(
            target_direction, std::abs(target_direction.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
        up = glm::cross(target_direction, across);
      }
      const Vec3<double> turn = glm::cross(direction, target_direction);
      found.by[i] = {glm::dot(turn, across), glm::dot(turn, up)};
    }
    return found;
  };

  FilmPoint film = *start;
  const auto done = [&](AimStatus status) {
    const auto [x, y] = chiefs.pupil_point(film);
    const auto met = meet_film({film.x, film.y, x, y}, plane(time));
    if (!met) return result;
    const FilmPoint& at = met->point;
    result = {film_.contains(at) ? status : AimStatus::outside_film, at, film_.raster(at)};
    return result;
  };
  // Newton's iteration, until steps are as small as the precision of the model allows.
  double last = upright_radius_;
  const double settled = 1e-12 * last, good = 1e-5 * last;
  for (;;) {
    // Neighbours towards the axis, where rays are less likely to be lost.
    const double hx = std::copysign(film_step, -film.x), hy = std::copysign(film_step, -film.y);
    const auto [by, lost] = misses(film, hx, hy);
    if (lost) return done(AimStatus::vignetted);
    const double xx = (by[1][0] - by[0][0]) / hx, xy = (by[2][0] - by[0][0]) / hy;
    const double yx = (by[1][1] - by[0][1]) / hx, yy = (by[2][1] - by[0][1]) / hy;
    const double determinant = xx * yy - xy * yx;
    const double dx = (by[0][1] * xy - by[0][0] * yy) / determinant, dy = (by[0][0] * yx - by[0][1] * xx) / determinant;
    const double step = std::hypot(dx, dy);
    if (!(step < last)) {
      if (last < good) break;
      return result;
    }
    film = {film.x + dx, film.y + dy};
    last = step;
    if (step < settled) break;
  }
  const auto [x, y] = chiefs.pupil_point(film);
  Ray<double> ray;
  const bool within = model.to_scene(TwoPlaneRay{film.x, film.y, x, y}, wavelength, ray) == RayFate::transmitted &&
                      (model.clips_at_apertures() || model.pupils().contains(film, x, y, wavelength));
  return done(within ? AimStatus::converged : AimStatus::vignetted);
}

}  // namespace camera_detail
}  // namespace petzval
