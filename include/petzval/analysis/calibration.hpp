// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

class Camera;

/// A camera in the model of another program: its parameters, with the error of the model over the picture.
///
/// Let theta be the field angle and t its tangent, f the focal length in pixels, and r the distance from the optical
/// centre in pixels. Tangential terms are 0. The optical centre (cx, cy) is a raster position; for models of OpenCV it
/// counts from the centre of the first pixel.
///
/// | name | model |
/// |---|---|
/// | opencv_5, opencv_8, opencv_12 | r = f t (1 + k1 t^2 + k2 t^4 + k3 t^6) / (1 + k4 t^2 + k5 t^4 + k6 t^6) |
/// | opencv_fisheye, kannala_brandt | r = f (theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9) |
/// | f_theta | theta = k0 + k1 r + k2 r^2 + k3 r^3 + k4 r^4 |
/// | colmap_radial, colmap_opencv | opencv_5 with k1 and k2 only |
/// | lensfun_ptlens | r' = q (a q^3 + b q^2 + c q + 1 - a - b - c), r' and q relative to half of the shorter side |
/// | lensfun_poly3 | r' = q (k1 q^2 + 1 - k1) |
/// | lensfun_pa | relative illumination 1 + k1 r^2 + k2 r^4 + k3 r^6, with r relative to half of the diagonal |
/// | lensfun_tca_NM | r'(NM) = r' (b r'^2 + c r' + v): lateral colour of one wavelength relative to the primary one |
///
/// For Lensfun, q is proportional to t, or to theta if the picture reaches a field of 85 degrees.
struct Calibration {
  std::string name;
  std::vector<std::pair<std::string, double>> values;  ///< parameters in the order and with the names of the program
  double rms = 0, largest = 0;                         ///< errors over the lit part of the picture, pixels
  bool of_irradiance = false;                          ///< true: errors are fractions of the irradiance on the axis
  double widest_field_rad = 0;                         ///< field angle of the farthest lit point of the picture

  /// The value with a name. @throws Error if there is no such value
  PETZVAL_API double value(std::string_view name) const;
};

/// Calibrations of a camera, computed from chief rays instead of photographs of a target.
///
/// Least squares over the area of the picture. Models of f tan theta are left out if the picture reaches a field of 85
/// degrees.
///
/// @param camera        an upright film without shift; a lens of revolution; square pixels
/// @param subject_z_mm  as in LensDistortion; unset: the plane in focus
/// @throws Error        if LensDistortion does, or if the camera does not meet these conditions
PETZVAL_API std::vector<Calibration> calibrations(const Camera& camera, std::optional<double> subject_z_mm = {});

/// A calibration in the format of its program, one or more lines; empty if the format does not have this model.
///
/// COLMAP: a line of cameras.txt with the number 1. Lensfun: an element of the database. OpenCV: YAML as written by
/// cv::FileStorage. kannala_brandt, f_theta, opencv_fisheye and opencv_12 for `usd`: attributes of a camera prim with
/// the applied schemas of Omniverse (docs.omniverse.nvidia.com, omni.usd.schema.omni_lens_distortion 1.0.0).
enum class CalibrationFormat { opencv, colmap, lensfun, usd };
PETZVAL_API std::string format_calibration(const Calibration& calibration, const Camera& camera,
                                           CalibrationFormat format);

}  // namespace petzval
