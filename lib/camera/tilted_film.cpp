// SPDX-License-Identifier: Apache-2.0
// Let D be the distance of the upright film from the pupil plane, whose centre is the origin. A film point P has the
// distance lambda D from that plane and lies at lambda times its virtual point V. Its ray through q meets the upright
// film at X = q + (P - q) / lambda = V - (1 / lambda - 1) q. 1 / lambda is linear in V: if the film crosses the axis at
// (1 + travel) D with the normal n, it is (1 + g . V) / (1 + travel) with g = (n_x, n_y) / (n_z D).
//
// The weight of a film sample is area cos_pupil cos_film / length^2. The ray is lambda times as long as the upright
// ray, at the same angle to the axis, cos_pupil = lambda |D| / length, and for every point of the film n . (q - P) =
// n_z |D| (1 + travel - g . q). The weight is therefore the upright weight times n_z (1 + travel - g . q) / lambda^3.
#include "tilted_film.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "camera_steps.hpp"
#include "check_film.hpp"
#include "core/check_rectangle.hpp"
#include "core/text.hpp"
#include "make_model.hpp"
#include "petzval/core/error.hpp"
#include "pupil/surface_box.hpp"

namespace petzval {
namespace camera_detail {
namespace {

TiltedPlane plane_of(const Film& film, const TwoPlanes& space) {
  const Vec3<double> right = film.right(), up = film.up(), normal = film.normal();
  const double distance = -space.depth();
  return {.x_by_x = right.x,
          .x_by_y = up.x,
          .y_by_y = up.y,
          .depth_by_x = right.z / distance,
          .depth_by_y = up.z / distance,
          .slope_x = normal.x / (normal.z * distance),
          .slope_y = normal.y / (normal.z * distance),
          .cosine = normal.z};
}

/// @throws Error  if a corner of the film is close to the pupil plane
void check_distance(const std::string& where, const FilmPoint& corner, double z, double film_z, double plane_z) {
  constexpr double nearest = 0.1;
  if ((z - plane_z) / (film_z - plane_z) >= nearest) return;
  throw Error(where + ": the corner (" + to_text(corner.x) + ", " + to_text(corner.y) + ") mm is at z = " + to_text(z) +
              " mm; must be at least a tenth of the film's distance away from the pupil plane, " +
              "z = " + to_text(plane_z) + " mm");
}

/// A disc across the axis that limits rays.
struct Rim {
  double half = 0, z = 0;
};

/// Pupils of a model at every wavelength, with twice the first-order width: aberrations move and widen them, and the
/// search for the pupils of the film also covers points outside the film. Pupils at infinity are left out.
std::vector<Rim> pupils_of(const LensFacts& facts, ModelKind model) {
  std::vector<Rim> rims;
  const Lens& lens = facts.lens();
  for (const Meridian section : {Meridian::y, Meridian::x}) {
    if (section == Meridian::x && !has_cylinders(lens)) continue;
    for (std::size_t w = 0; w < facts.wavelengths() && facts.has_pupils(); ++w) {
      const Pupils paraxial = pupils(lens, w, section);
      const Rim rim = model == ModelKind::thin
                          ? Rim{paraxial.entrance.diameter, first_order(lens, w, section).rear_principal_z}
                          : Rim{paraxial.exit.diameter, paraxial.exit.z};
      if (std::isfinite(rim.z) && std::isfinite(rim.half)) rims.push_back(rim);
    }
  }
  return rims;
}

/// A projection maps a rectangle into the hull of its mapped corners, and a travelling film moves its virtual points
/// along straight lines: the corners at both times suffice.
FilmTilt tilt_of(const TiltedFilm& tilted) {
  const TiltedPlane first = tilted.plane(0), last = tilted.plane(1);
  FilmTilt tilt{.slope_x = first.slope_x,
                .slope_y = first.slope_y,
                .min_excess = std::numeric_limits<double>::infinity(),
                .max_excess = -std::numeric_limits<double>::infinity(),
                .travel = last.travel};
  for (const TiltedPlane& plane : {first, last}) {
    for (const FilmPoint& corner : tilted.film().corners()) {
      const FilmPoint point = plane.virtual_point(corner);
      const double excess = plane.distance_excess(point);
      tilt.min_excess = std::min(tilt.min_excess, excess);
      tilt.max_excess = std::max(tilt.max_excess, excess);
      tilt.radius = std::max(tilt.radius, std::hypot(point.x, point.y));
    }
  }
  return tilt;
}

}  // namespace

double upright_radius(const LensFacts& facts, const Film& film, ModelKind model) {
  if (!tilted_or_moving(film)) return film.radius_mm();
  const Lens& lens = facts.lens();
  const double film_z = film.z();
  const double pupil_z = two_planes(lens).pupil_z;
  const std::vector<Rim> pupils = pupils_of(facts, model);
  const pupil_detail::SurfaceBox box = pupil_detail::last_surface_box(lens);
  const bool discs = model.is_first_order() && model != ModelKind::thin_two_disc;
  // Behind the film, aberrations move a pupil by more than its size.
  const bool in_lens = !pupils.empty() && std::all_of(pupils.begin(), pupils.end(), [&](const Rim& rim) {
    return (rim.z - film_z) * (box.vertex_z - film_z) > 0;
  });
  double radius = 0;
  const auto reach = [&](const FilmPoint& corner, const Vec3<double>& position) {
    const double height = std::hypot(position.x, position.y);
    const auto farthest = [&](const Rim& rim) {
      return height + (height + rim.half) * std::abs((film_z - position.z) / (rim.z - position.z));
    };
    check_distance(lens.name(), corner, position.z, film_z, pupil_z);
    radius = std::max(radius, farthest({0, pupil_z}));  // for virtual points
    double through_pupil = 0;
    for (const Rim& rim : pupils) {
      if (discs) check_distance(lens.name(), corner, position.z, film_z, rim.z);
      through_pupil = std::max(through_pupil, farthest(rim));
    }
    // Rays also pass the last surface, whose position does not depend on aberrations.
    const double through_last = std::max(farthest({box.half, box.z_min}), farthest({box.half, box.z_max}));
    const double reached = discs ? through_pupil : in_lens ? std::min(through_last, through_pupil) : through_last;
    radius = std::max(radius, reached);
  };
  for (const double time : {0.0, 1.0}) {
    const Film still = film.at(time);
    for (const FilmPoint& corner : still.corners()) reach(corner, still.position(corner));
  }
  return radius;
}

TiltedFilm::TiltedFilm(const Film& film, const FilmPupilTable& pupils, int threads)
    : film_(film),
      first_(plane_of(film, pupils.space())),
      travel_(-film.travel_mm / pupils.space().depth()),
      pupils_(pupils) {
  const std::string where = "tilted film";
  core_detail::check_rectangle(where, film);
  film_.z_mm = pupils.space().film_z;
  for (const double time : {0.0, 1.0}) {
    const Film still = film_.at(time);
    for (const FilmPoint& corner : still.corners()) {
      check_distance(where, corner, still.position(corner).z, film_.z(), pupils.space().pupil_z);
    }
  }
  const FilmTilt tilt = tilt_of(*this);
  constexpr double rounding = 1e-9;
  if (!(tilt.radius <= pupils.film_radius() * (1 + rounding))) {
    throw Error(where + ": film radius of the pupils = " + to_text(pupils.film_radius()) + " mm; must be at least " +
                to_text(tilt.radius) + " mm");
  }
  pupils_ = pupils.for_tilted_film(tilt, threads);
}

FilmPoint TiltedPlane::virtual_point(const FilmPoint& film) const noexcept {
  const auto [x, y] = virtual_of(*this, film.x, film.y);
  return {x, y};
}

FilmPoint TiltedPlane::point(const FilmPoint& point) const noexcept {
  const double distance = 1 / (1 + distance_excess(point)), y = point.y * distance / y_by_y;
  return {(point.x * distance - x_by_y * y) / x_by_x, y};
}

double TiltedPlane::distance_excess(const FilmPoint& point) const noexcept {
  return camera_detail::distance_excess(*this, point.x, point.y);
}

kernel::Dual TiltedPlane::distance_excess_at(const FilmPoint& film) const noexcept {
  const auto [x, y] = virtual_of(*this, kernel::Dual(film.x, 0), kernel::Dual(film.y, 1));
  return camera_detail::distance_excess(*this, x, y);
}

TwoPlaneRay TiltedPlane::upright(const FilmPoint& point, const FilmPoint& position) const noexcept {
  return upright_of(distance_excess(point), point.x, point.y, position.x, position.y);
}

std::optional<FilmPoint> TiltedPlane::virtual_point_of(const TwoPlaneRay& ray) const noexcept {
  const double front = 1 + travel - (slope_x * ray.pupil_x + slope_y * ray.pupil_y);
  const double excess = (slope_x * ray.film_x + slope_y * ray.film_y - travel) / front;
  if (!(front > 0 && 1 + excess > 0)) return {};
  return FilmPoint{ray.film_x + excess * ray.pupil_x, ray.film_y + excess * ray.pupil_y};
}

double TiltedPlane::weight(const FilmPoint& point, const FilmPoint& position) const noexcept {
  return std::max(facing_of(*this, distance_excess(point), position.x, position.y), 0.0);
}

TiltedPlane TiltedFilm::plane(double time) const noexcept {
  TiltedPlane result = first_;
  if (time > 0) result.travel = travel_ * std::min(time, 1.0);
  return result;
}

}  // namespace camera_detail

double upright_radius(const Lens& lens, const Film& film, ModelKind model) {
  core_detail::check_rectangle(lens.name() + ": film", film);
  if (!camera_detail::tilted_or_moving(film)) return film.radius_mm();
  const auto [placed_lens, placed_film] = camera_detail::placed(lens, film);
  return camera_detail::upright_radius(placed_lens, placed_film, model);
}

}  // namespace petzval
