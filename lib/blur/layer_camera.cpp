// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/layers.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "check_sides.hpp"
#include "core/text.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace {

using blur_detail::check_sides;

constexpr double steepest = radians(60);  // largest angle of rays from the axis

}  // namespace

LayerCamera layer_camera(int columns, int rows, double vertical_angle_rad) {
  check_sides("layer camera: picture", columns, rows);
  if (!(vertical_angle_rad > 0 && vertical_angle_rad <= radians(120))) {
    throw Error("layer camera: vertical angle = " + to_text(degrees(vertical_angle_rad)) +
                " degrees; must be above 0 and at most 120 for a planar picture");
  }
  return {.columns = columns,
          .rows = rows,
          .focal_px = 0.5 * rows / std::tan(0.5 * vertical_angle_rad),
          .axis = {0.5 * columns, 0.5 * rows}};
}

LayerCamera layer_camera(const Camera& camera) {
  const Film& film = camera.film();
  check_sides("layer camera: picture", film.columns, film.rows);
  const double origin = layer_origin_z(camera);

  // Slope, per pixel, of the scene point that the ideal lens images to a film point near the axis.
  const IdealLens ideal = thick_lens(camera.lens());
  const double height = film.height_mm / film.rows;
  const ScenePoint seen = ideal.scene_of({0, -height, film.z()});
  const double slope =
      seen.at_infinity ? seen.position.y / -seen.position.z : seen.position.y / (origin - seen.position.z);
  const LayerCamera layers{.columns = film.columns,
                           .rows = film.rows,
                           .focal_px = std::abs(1 / slope),
                           .axis = film.raster(FilmPoint{0, 0})};

  constexpr int grid_points = 9;  // along each side; positions without light are skipped
  for (int i = 0; i < grid_points * grid_points; ++i) {
    const double column = film.columns * (i % grid_points) / (grid_points - 1.0),
                 row = film.rows * (i / grid_points) / (grid_points - 1.0);
    const CameraRay ray = camera.sample({.film = film.point(column, row)});
    if (!ray || -ray.ray.direction.z >= std::cos(steepest)) continue;
    throw Error("layer camera: the ray of column " + to_text(column) + ", row " + to_text(row) + " runs " +
                to_text(degrees(std::acos(std::clamp(-ray.ray.direction.z, -1.0, 1.0)))) +
                " degrees from the axis; must be at most " + to_text(degrees(steepest)) + " for a planar picture");
  }
  return layers;
}

double layer_origin_z(const Camera& camera) {
  const double z = pupils(camera.lens()).entrance.z;
  if (!std::isfinite(z))
    throw Error("layer camera: the entrance pupil of the lens is at infinity; must be at a finite distance");
  return z;
}

}  // namespace petzval
