// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>

#include "core/low_discrepancy.hpp"
#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "undistorted_box.hpp"

namespace petzval {
namespace {

/// Distance that stands for infinity, mm: the chief rays of a point are parallel within rounding.
constexpr double far_mm = 1e9;
/// Cosine of the widest field that a pinhole image includes, 89 degrees.
constexpr double least_cosine = 0.0175;

double subject_of(const Lens& lens, const Film& film, std::optional<double> subject_z_mm) {
  if (subject_z_mm) return *subject_z_mm;
  const FocusSolution found = solve_subject(lens, film.z());
  if (found.status == FocusStatus::afocal || found.status == FocusStatus::no_rays) {
    throw Error(lens.name() + ": distortion: no subject is in focus (" + std::string(name(found.status)) +
                "); subject_z_mm must be given");
  }
  return found.subject_z;
}

}  // namespace

LensDistortion::LensDistortion(const Camera& camera, std::optional<double> subject_z_mm) : camera_(camera) {
  const Lens& lens = camera.lens();
  const Film& film = camera.film();
  const std::string where = lens.name() + ": distortion: ";
  pinhole_.z_mm = pupils(lens).entrance.z;
  if (!std::isfinite(pinhole_.z_mm)) {
    throw Error(where + "the entrance pupil is at infinity; must be at a finite distance for a pinhole");
  }
  pinhole_.subject_z_mm = subject_of(lens, film, subject_z_mm);
  distance_ = std::min(pinhole_.z_mm - pinhole_.subject_z_mm, far_mm);
  if (!(distance_ > 0) || !(pinhole_.subject_z_mm < 0)) {
    throw Error(where + "the subject is at z = " + to_text(pinhole_.subject_z_mm) +
                " mm; must be in front of the lens and of its entrance pupil, at z = " + to_text(pinhole_.z_mm) +
                " mm");
  }

  const Vec2<double> pixel_mm{film.width_mm / film.columns, film.height_mm / film.rows};
  centre_ = film.raster(FilmPoint{});
  pinhole_.centre_mm = {(centre_.x - film.columns / 2.0) * pixel_mm.x, (centre_.y - film.rows / 2.0) * pixel_mm.y};

  // Angle at which third-order distortion changes the slope of the image by 1e-8. (Aspheres with odd terms change the
  // slope by 1 % within 0.01 rad.)
  constexpr double axis_step_rad = 1e-4;
  const auto on_axis = [&](double x, double y) {
    const auto shown = [&](double sign) {
      const double by = sign * axis_step_rad * distance_;
      const Projection at = camera_.project({by * x, by * y, pinhole_.z_mm - distance_});
      if (at.status == AimStatus::no_ray) throw Error(where + "the camera sees nothing about its axis");
      return at.raster;
    };
    return (shown(1) - shown(-1)) / (2 * axis_step_rad);
  };
  focal_length_px_ = {on_axis(1, 0).x, -on_axis(0, 1).y};
  if (!(focal_length_px_.x > 0 && focal_length_px_.y > 0)) {
    throw Error(where + "the picture is upside down; must be upright");
  }
  pinhole_.focal_length_mm = focal_length_px_ * pixel_mm;
}

std::optional<Vec2<double>> LensDistortion::distorted(const Vec2<double>& undistorted) const noexcept {
  const Vec2<double> tangent = (undistorted - centre_) / focal_length_px_;
  const Projection at = camera_.project({tangent.x * distance_, -tangent.y * distance_, pinhole_.z_mm - distance_});
  if (at.status == AimStatus::no_ray) return {};
  return at.raster;
}

Vec2<double> LensDistortion::pinhole_raster_of(const Vec3<double>& point) const noexcept {
  return centre_ + focal_length_px_ * Vec2<double>(point.x, -point.y) / distance_;
}

std::optional<CameraSample> LensDistortion::lit_sample(const FilmPoint& film) const noexcept {
  // Tries the centre of the pupil first, then positions all over the pupil, because obscurations and folds may leave
  // only a small part of it.
  const core_detail::Kronecker<2> sequence(1);
  CameraSample sample{.film = film, .pupil_u = 0, .pupil_v = 1e-3};
  for (std::uint32_t i = 0; i < 32; ++i) {
    if (camera_.sample(sample)) return sample;
    const auto sample_point = sequence(i);
    sample.pupil_u = sample_point[0], sample.pupil_v = sample_point[1];
  }
  return {};
}

std::optional<Vec2<double>> LensDistortion::undistorted(const Vec2<double>& distorted_at) const noexcept {
  // The ray of the film point meets the subject plane near the searched point. Rays of adjacent film points give the
  // derivatives.
  const Film& film = camera_.film();
  auto sample = lit_sample(film.point(distorted_at.x, distorted_at.y));
  if (!sample) return {};
  const auto near = [&](double x, double y) -> std::optional<Vec2<double>> {
    sample->film = film.point(x, y);
    const CameraRay ray = camera_.sample(*sample);
    if (!ray || ray.ray.direction.z > -least_cosine) return {};
    return pinhole_raster_of(core_detail::meet_plane(ray.ray, pinhole_.z_mm - distance_));
  };
  const auto start = near(distorted_at.x, distorted_at.y);
  if (!start) return {};
  const auto towards_middle = [](double from, double size) { return (from < size / 2 ? 0.005 : -0.005) * size; };
  const double hx = towards_middle(distorted_at.x, film.columns), hy = towards_middle(distorted_at.y, film.rows);
  const auto along_x = near(distorted_at.x + hx, distorted_at.y), along_y = near(distorted_at.x, distorted_at.y + hy);
  Vec2<double> by_x = along_x ? (*along_x - *start) / hx : Vec2<double>(1, 0);
  Vec2<double> by_y = along_y ? (*along_y - *start) / hy : Vec2<double>(0, 1);

  // The derivatives are accurate enough for a start. Each step corrects them along its direction (Broyden 1965).
  constexpr double converged_px = 1e-7, accepted_px = 5e-3;  // pixels
  Vec2<double> at = *start, step{0, 0}, last_miss{0, 0};
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 40; ++i) {
    const auto shown = distorted(at);
    if (!shown) return {};
    const Vec2<double> miss = distorted_at - *shown;
    const double length = std::hypot(miss.x, miss.y);
    if (length < converged_px) return at;
    if (!(length < last)) return last < accepted_px ? std::optional(at - step) : std::nullopt;
    if (i > 0) {
      const Vec2<double> moved = last_miss - miss, expected = moved.x * by_x + moved.y * by_y;
      if (const double along = glm::dot(step, expected); along != 0) {
        const Vec2<double> missed = (step - expected) / along;
        const Vec2<double> along_each{glm::dot(step, by_x), glm::dot(step, by_y)};
        by_x += missed * along_each.x, by_y += missed * along_each.y;
      }
    }
    last = length, last_miss = miss;
    step = miss.x * by_x + miss.y * by_y;
    at += step;
  }
  return last < accepted_px ? std::optional(at - step) : std::nullopt;
}

double LensDistortion::widest_field_rad() const noexcept {
  constexpr int grid_points = 17;
  const Film& film = camera_.film();
  double widest = 0;
  for (int row = 0; row < grid_points; ++row) {
    for (int column = 0; column < grid_points; ++column) {
      const double x = static_cast<double>(column) / (grid_points - 1),
                   y = static_cast<double>(row) / (grid_points - 1);
      const auto sample = lit_sample(film.point(x * film.columns, y * film.rows));
      if (!sample) continue;
      widest = std::max(widest, std::acos(std::clamp(-camera_.sample(*sample).ray.direction.z, -1.0, 1.0)));
    }
  }
  return widest;
}

std::optional<RasterBox> undistorted_box(const LensDistortion& distortion) {
  constexpr int grid_points = 65;
  const Film& film = distortion.camera().film();
  std::optional<RasterBox> box;
  for (int row = 0; row < grid_points; ++row) {
    for (int column = 0; column < grid_points; ++column) {
      const double x = static_cast<double>(column) / (grid_points - 1),
                   y = static_cast<double>(row) / (grid_points - 1);
      const auto seen = distortion.undistorted({x * film.columns, y * film.rows});
      if (!seen) continue;
      if (!box) box = {*seen, *seen};
      box->least = {std::min(box->least.x, seen->x), std::min(box->least.y, seen->y)};
      box->largest = {std::max(box->largest.x, seen->x), std::max(box->largest.y, seen->y)};
    }
  }
  return box;
}

double overscan(const LensDistortion& distortion) {
  const Film& film = distortion.camera().film();
  const std::string where = distortion.camera().lens().name() + ": overscan: ";
  const Vec2<double> centre = distortion.centre(), size{film.columns, film.rows};
  if (!(centre.x > 0 && centre.x < size.x && centre.y > 0 && centre.y < size.y)) {
    throw Error(where + "the film is shifted by (" + to_text(film.shift_x_mm) + ", " + to_text(film.shift_y_mm) +
                ") mm; the axis must lie within the picture");
  }
  const auto box = undistorted_box(distortion);
  if (!box) throw Error(where + "no light reaches the film");
  double widest = 1;
  for (int axis : {0, 1}) {
    widest = std::max({widest, (centre[axis] - box->least[axis]) / centre[axis],
                       (box->largest[axis] - centre[axis]) / (size[axis] - centre[axis])});
  }
  return widest;
}

}  // namespace petzval
