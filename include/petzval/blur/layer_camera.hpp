// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

class Camera;

/// The pinhole camera that layers are rendered with: it stands in the middle of the entrance pupil and looks along the
/// axis of the lens.
///
/// Its space: x to the right, y up, depth along the axis, mm from the pinhole. A scene point is seen at the raster
/// position axis + focal_px (x, -y) / depth of the picture, whose upper left corner is (0, 0). So a straight ray of the
/// scene, whatever lens it comes from, is a straight line in raster positions and inverse depth.
struct PETZVAL_API LayerCamera {
  int columns = 0, rows = 0;  ///< of the picture
  double focal_px = 0;        ///< (rows / 2) / tan(half the vertical angle)
  Vec2<double> axis{0, 0};    ///< raster position of the axis, mostly the middle of the picture
  int overscan = 0;           ///< pixels by which layers reach beyond the picture on each side

  int layer_columns() const noexcept { return columns + 2 * overscan; }
  int layer_rows() const noexcept { return rows + 2 * overscan; }
  /// The raster position in the picture of a point of that space, in front of the pinhole.
  Vec2<double> raster(const Vec3<double>& point) const noexcept {
    return axis + Vec2<double>{point.x, -point.y} * (focal_px / point.z);
  }
};

/// A camera with its axis in the middle of the picture. Throws Error for a picture without pixels or of more than 32768
/// columns or rows, and for an angle outside (0, 120 degrees]: planes of pixels do not show fisheyes.
PETZVAL_API LayerCamera layer_camera(int columns, int rows, double vertical_angle_rad);

/// The camera whose layers a lens camera blurs: raster positions are those of its film, as far as the lens has no
/// distortion. Its pinhole lies at layer_origin_z(camera). Throws Error for a picture as above, and where the rays of
/// the film's corners are farther than 60 degrees from the axis.
PETZVAL_API LayerCamera layer_camera(const Camera& camera);

/// z of the pinhole of layer_camera(camera), lens frame: the middle of the entrance pupil. Throws Error for a lens
/// whose entrance pupil is at infinity.
PETZVAL_API double layer_origin_z(const Camera& camera);

}  // namespace petzval
