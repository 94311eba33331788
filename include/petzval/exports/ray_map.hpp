// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "petzval/camera/camera_ray.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

class Camera;

/// The numbers that describe a ray of a RayMap.
enum class RayMapLayout : std::uint8_t {
  /// x, y, slope_x, slope_y, weight: the ray passes (x, y, plane_z_mm) in the direction (slope_x, slope_y, -1).
  planes,
  /// x, y, z, dx, dy, dz, weight: the ray passes (x, y, z), its point next to (0, 0, plane_z_mm), in the direction (dx,
  /// dy, dz), which is a unit vector before interpolation.
  directions,
};

/// Options of ray_map().
struct RayMapOptions {
  int lens_samples = 16;  ///< 1 to 256; 1: chief rays
  bool half = false;      ///< values are rounded to 16-bit floats; `planes` then stores slopes as differences
  int threads = 1;
};

/// Rays of a camera at the centres of all pixels, for a fixed set of lens samples, as images for textures and shaders.
///
/// Interpolate bilinearly between four lit pixels; a lost ray has weight 0 and other values 0. Lens frame, mm, rays
/// towards the scene, primary wavelength, as the shutter opens. The mean of weight * radiance over the lens samples is
/// the irradiance of the film point, as for CameraRay. Rays pass their planes inside the lens: objects nearer than
/// front_z_mm are not part of the scene.
struct RayMap {
  /// A lens sample: CameraSample::pupil_u and pupil_v, and its point in the pupil plane for the middle of the picture.
  struct LensSample {
    double u = 0, v = 0;
    Vec2<double> pupil_mm{0, 0};
  };

  RayMapLayout layout = RayMapLayout::planes;
  int columns = 0, rows = 0;
  bool half = false;
  bool chief_rays =
      false;  ///< true: the only sample of each pixel is its chief ray; its weight is the weight of the whole pupil
  double plane_z_mm =
      0;  ///< the entrance pupil; the first vertex if the distance of the pupil from the first vertex is more than 1 m
  double front_z_mm = 0;  ///< smallest z at which a ray of the map leaves the lens
  double pupil_z_mm = 0;  ///< plane of LensSample::pupil_mm, in image space
  /// `planes`: slope = value + slope_per_pixel * (raster - picture centre), in x and in y. 0 unless `half`.
  Vec2<double> slope_per_pixel{0, 0};
  std::vector<LensSample> lens_samples{};
  std::vector<float> values{};  ///< [lens sample][channel][row][column]

  /// Errors of interpolated rays, also by rounding, against exact rays at the middles between four pixels and at random
  /// positions: the angle from the centre of plane_z_mm between the points of both rays at the distance in focus,
  /// divided by the angle between neighbouring pixels there.
  double rms_px = 0, largest_px = 0;
  double left_out = 0;  ///< fraction of places with one to three lit pixels about them; these have no error
  double focus_mm = 0;  ///< the distance in focus, from plane_z_mm; may be infinite
  double widest_field_rad = 0;

  /// Names of the channels.
  PETZVAL_API std::vector<std::string_view> channels() const;
  /// The values of a channel: columns x rows.
  const float* channel(std::size_t lens_sample, std::size_t channel) const noexcept {
    return values.data() + (lens_sample * (layout == RayMapLayout::planes ? 5 : 7) + channel) *
                               static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  /// The interpolated ray of a raster position, with a unit direction; lost outside the picture, or unless the
  /// pixels about the position are lit.
  PETZVAL_API CameraRay ray(std::size_t lens_sample, double raster_x, double raster_y) const noexcept;
};

/// Computes the rays of a map. The layout is `directions` if a ray is more than 60 degrees from the axis.
///
/// Lens samples are points of a Fibonacci lattice. A single sample is the chief ray of exact models, found with the
/// stop closed to 1/32; for other models and lenses with an obscuration, the middle ray or a ray beside the
/// obscuration.
///
/// @throws Error if an option is out of range, the map has more than 2^28 values, or all rays are lost
PETZVAL_API RayMap ray_map(const Camera& camera, const RayMapOptions& options = {});

}  // namespace petzval
