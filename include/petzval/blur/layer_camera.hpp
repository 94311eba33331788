// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

class Camera;

/// The pinhole camera with which layers are rendered, in the middle of the entrance pupil and along the lens axis.
///
/// Camera space: x to the right, y up, depth along the axis, in mm from the pinhole. A scene point appears at the
/// raster position axis + focal_px (x, -y) / depth; (0, 0) is the upper left corner of the image. A straight ray in the
/// scene, of any lens, is therefore a straight line in raster position and inverse depth.
struct PETZVAL_API LayerCamera {
  int columns = 0, rows = 0;  ///< size of the image, pixels
  double focal_px = 0;        ///< (rows / 2) / tan(half the vertical angle)
  Vec2<double> axis{0, 0};    ///< raster position of the axis, usually the middle of the image
  int overscan = 0;           ///< pixels by which layers extend beyond the image on each side

  int layer_columns() const noexcept { return columns + 2 * overscan; }
  int layer_rows() const noexcept { return rows + 2 * overscan; }
  /// Raster position in the image of a point (camera space, mm) in front of the pinhole.
  Vec2<double> raster(const Vec3<double>& point) const noexcept {
    return axis + Vec2<double>{point.x, -point.y} * (focal_px / point.z);
  }
};

/// A layer camera with its axis in the middle of the image.
///
/// @throws Error unless columns and rows are 1 to 32768 and the angle is in (0, 120 degrees]; a flat image cannot show
///               the field of a fisheye
PETZVAL_API LayerCamera layer_camera(int columns, int rows, double vertical_angle_rad);

/// The layer camera for the blur of a lens camera, with the pinhole at layer_origin_z(camera).
///
/// Raster positions equal raster positions on the film, except for the distortion of the lens.
///
/// @throws Error if columns or rows of the film are not 1 to 32768, the entrance pupil is at infinity, or a ray of the
///               film is more than 60 degrees from the axis
PETZVAL_API LayerCamera layer_camera(const Camera& camera);

/// z of the pinhole of layer_camera(camera): the middle of the entrance pupil (lens frame, mm).
///
/// @throws Error if the entrance pupil is at infinity
PETZVAL_API double layer_origin_z(const Camera& camera);

}  // namespace petzval
