// SPDX-License-Identifier: Apache-2.0
// With D the distance of the upright film from the plane of the pupil, both film points and their lines are told from
// the middle of that plane. A film point P stands lambda D from it, at its key K times lambda. Its line through q meets
// the upright film in X = q + (P - q) / lambda = K - (1 / lambda - 1) q, and 1 / lambda - 1 is linear in K: for the
// film's normal n it is g . K with g = (n_x, n_y) / (n_z D).
//
// The weight of a film sample is area cos_pupil cos_film / length^2. The line is lambda times as long as the upright
// one, at the same angle with the axis, cos_pupil = lambda |D| / length, and at the film n . (q - P) = n_z |D| (1 - g .
// q) for all its points. So it is the upright weight times n_z (1 - g . q) / lambda^3.
#include "petzval/camera/tilted_film.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "check_film.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "petzval/film/film.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/pupils.hpp"
#include "pupil/face.hpp"
#include "tilted_pinhole.hpp"

namespace petzval::inline v0 {
namespace {

camera_detail::TiltedPlane plane_of(const Film& film, const TwoPlanes& space) {
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

/// Distance from the plane of the pupil, in that of the upright film.
double distance_at(const camera_detail::TiltedPlane& plane, const FilmPoint& film) noexcept {
  return 1 + plane.depth_by_x * film.x + plane.depth_by_y * film.y;
}

using Jet = ceres::Jet<double, 2>;

/// A film point's key, by the film point.
struct Key {
  Jet x, y, lean;

  FilmPoint point() const noexcept { return {x.a, y.a}; }
};

Key differentiated_key(const camera_detail::TiltedPlane& plane, const FilmPoint& film) noexcept {
  const Jet x(film.x, 0), y(film.y, 1);
  const Jet distance = 1.0 + plane.depth_by_x * x + plane.depth_by_y * y;
  const Jet key_x = (plane.x_by_x * x + plane.x_by_y * y) / distance, key_y = plane.y_by_y * y / distance;
  return {key_x, key_y, plane.slope_x * key_x + plane.slope_y * key_y};
}

TwoPlaneRayDerivatives derivatives_of(const Jet& film_x, const Jet& film_y, const Jet& pupil_x,
                                      const Jet& pupil_y) noexcept {
  const auto part = [&](int k) { return TwoPlaneRay{film_x.v[k], film_y.v[k], pupil_x.v[k], pupil_y.v[k]}; };
  return {{film_x.a, film_y.a, pupil_x.a, pupil_y.a}, part(0), part(1)};
}

/// Throws Error for a corner of the film that comes near to the plane that its lines are told by.
void check_distance(const std::string& where, const FilmPoint& corner, double z, double film_z, double plane_z) {
  constexpr double nearest = 0.1;
  if ((z - plane_z) / (film_z - plane_z) >= nearest) return;
  throw Error(where + ": the corner (" + number(corner.x) + ", " + number(corner.y) + ") mm is at z = " + number(z) +
              " mm, wanted it at least a tenth of the film's distance from the pupil, " + "z = " + number(plane_z) +
              " mm");
}

/// A disc across the axis, by which lines are bounded.
struct Rim {
  double half = 0, z = 0;
};

/// Where the pupils of a model lie, at every wavelength, twice as wide as to first order: aberrations move and widen
/// them, and the film's own pupils are looked for among points beside the film too. Those without a place are left out.
std::vector<Rim> pupils_of(const Lens& lens, ModelKind model) {
  std::vector<Rim> rims;
  for (std::size_t w = 0; w < lens.wavelengths_nm().size() && has_pupils(lens); ++w) {
    const Pupils paraxial = pupils(lens, w);
    const Rim rim = model == ModelKind::thin ? Rim{paraxial.entrance.diameter, first_order(lens, w).rear_principal_z}
                                             : Rim{paraxial.exit.diameter, paraxial.exit.z};
    if (std::isfinite(rim.z) && std::isfinite(rim.half)) rims.push_back(rim);
  }
  return rims;
}

/// Of the film: a projection maps rectangles to what their corners go around.
FilmTilt lean_of(const TiltedFilm& tilted) {
  FilmTilt lean{.slope_x = tilted.plane().slope_x,
                .slope_y = tilted.plane().slope_y,
                .low = std::numeric_limits<double>::infinity(),
                .high = -std::numeric_limits<double>::infinity()};
  for (const FilmPoint& corner : tilted.film().corners()) {
    const FilmPoint key = tilted.key(corner);
    const double value = tilted.plane().slope_along(key);
    lean.low = std::min(lean.low, value);
    lean.high = std::max(lean.high, value);
    lean.radius = std::max(lean.radius, std::hypot(key.x, key.y));
  }
  return lean;
}

}  // namespace

double upright_radius(const Lens& given_lens, const Film& given_film, ModelKind model) {
  camera_detail::check_rectangle(given_lens.name() + ": film", given_film);
  if (!given_film.tilted()) return given_film.radius_mm();
  const auto [lens, film] = camera_detail::placed(given_lens, given_film);
  const double film_z = film.z();
  const double pupil_z = two_planes(lens).pupil_z;
  const std::vector<Rim> pupils = pupils_of(lens, model);
  const pupil_detail::Face face = pupil_detail::last_face(lens);
  const bool discs = model <= ModelKind::thick && model != ModelKind::thin_two_disc;
  // Aberrations move a pupil that lies behind the film by more than its size.
  const bool in_lens = !pupils.empty() && std::all_of(pupils.begin(), pupils.end(), [&](const Rim& rim) {
    return (rim.z - film_z) * (face.vertex_z - film_z) > 0;
  });
  double radius = 0;
  for (const FilmPoint& corner : film.corners()) {
    const Vec3<double> place = film.position(corner);
    const double height = std::hypot(place.x, place.y);
    const auto farthest = [&](const Rim& rim) {
      return height + (height + rim.half) * std::abs((film_z - place.z) / (rim.z - place.z));
    };
    check_distance(lens.name(), corner, place.z, film_z, pupil_z);
    radius = std::max(radius, farthest({0, pupil_z}));  // of keys
    double through_pupil = 0;
    for (const Rim& rim : pupils) {
      if (discs) check_distance(lens.name(), corner, place.z, film_z, rim.z);
      through_pupil = std::max(through_pupil, farthest(rim));
    }
    // Light comes through the last surface too, and aberrations have nothing to move there.
    const double through_last = std::max(farthest({face.half, face.z_min}), farthest({face.half, face.z_max}));
    const double reached = discs ? through_pupil : in_lens ? std::min(through_last, through_pupil) : through_last;
    radius = std::max(radius, reached);
  }
  return radius;
}

TiltedFilm::TiltedFilm(const Film& film, const FilmPupilTable& pupils)
    : film_(film), plane_(plane_of(film, pupils.space())), pupils_(pupils) {
  const std::string where = "tilted film";
  camera_detail::check_rectangle(where, film);
  film_.z_mm = pupils.space().film_z;
  for (const FilmPoint& corner : film.corners()) {
    check_distance(where, corner, film_.position(corner).z, film_.z(), pupils.space().pupil_z);
  }
  const FilmTilt lean = lean_of(*this);
  constexpr double rounding = 1e-9;
  if (!(lean.radius <= pupils.film_radius() * (1 + rounding))) {
    throw Error(where + ": the pupils are those of film points up to " + number(pupils.film_radius()) +
                " mm from the axis, wanted " + number(lean.radius) + " mm or more");
  }
  pupils_ = pupils.for_tilted_film(lean);
}

FilmPoint TiltedFilm::key(const FilmPoint& film) const noexcept {
  const double per_distance = 1 / distance_at(plane_, film);
  return {(plane_.x_by_x * film.x + plane_.x_by_y * film.y) * per_distance, plane_.y_by_y * film.y * per_distance};
}

TwoPlaneRay TiltedFilm::upright(const FilmPoint& key, double pupil_x, double pupil_y) const noexcept {
  const double lean = plane_.slope_along(key);
  return {key.x - lean * pupil_x, key.y - lean * pupil_y, pupil_x, pupil_y};
}

std::optional<FilmPoint> TiltedFilm::key_of(const TwoPlaneRay& line) const noexcept {
  const double front = 1 - plane_.slope_along({line.pupil_x, line.pupil_y});
  const double lean = plane_.slope_along({line.film_x, line.film_y}) / front;
  if (!(front > 0 && 1 + lean > 0)) return {};
  return FilmPoint{line.film_x + lean * line.pupil_x, line.film_y + lean * line.pupil_y};
}

FilmPoint TiltedFilm::point(const FilmPoint& key) const noexcept {
  const double distance = 1 / (1 + plane_.slope_along(key)), y = key.y * distance / plane_.y_by_y;
  return {(key.x * distance - plane_.x_by_y * y) / plane_.x_by_x, y};
}

double TiltedFilm::weight(const FilmPoint& key, double pupil_x, double pupil_y) const noexcept {
  const double near = 1 + plane_.slope_along(key), front = 1 - plane_.slope_along({pupil_x, pupil_y});
  return std::max(plane_.cosine * front * near * near * near, 0.0);
}

TwoPlaneRayDerivatives TiltedFilm::line(const FilmPoint& film, double u, double v,
                                        std::size_t wavelength) const noexcept {
  const Key key = differentiated_key(plane_, film);
  const PupilSample at = pupils_.sample(key.point(), u, v, wavelength);
  const auto [by_x, by_y] = pupils_.derivatives(key.point(), u, v, wavelength);
  Jet pupil_x(at.x), pupil_y(at.y);
  pupil_x.v = by_x[0] * key.x.v + by_y[0] * key.y.v;
  pupil_y.v = by_x[1] * key.x.v + by_y[1] * key.y.v;
  return derivatives_of(key.x - key.lean * pupil_x, key.y - key.lean * pupil_y, pupil_x, pupil_y);
}

TwoPlaneRayDerivatives camera_detail::pinhole_line(const TiltedFilm& tilted, const FilmPoint& film,
                                                   double shift) noexcept {
  const Key key = differentiated_key(tilted.plane(), film);
  const Jet x = key.x / (1.0 + key.lean * shift), y = key.y / (1.0 + key.lean * shift);
  return derivatives_of(x, y, shift * x, shift * y);
}

}  // namespace petzval::inline v0
