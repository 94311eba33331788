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
  std::string name{};
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

/// The two tables of Omniverse's lens distortion by look-up tables (OmniLensDistortionLutAPI), for any lens of
/// revolution up to fisheyes beyond 90 degrees.
///
/// Directions are unit vectors of the camera frame: +x to the right, +y up, -z forward. Positions are fractions of the
/// picture from its upper left corner. Textures are read between the centres of texels, rows from the top.
///
/// The meaning of the tables follows docs.omniverse.nvidia.com (omni.usd.schema.omni_lens_distortion 1.0.0) and
/// NVIDIA's answer at forums.developer.nvidia.com/t/365174: RGB is the direction into the scene for a position, RG is
/// the position for the octahedral coordinates of a direction. These pages leave some points open. Assumptions from
/// the exporter of github.com/Munna-Manoj/DS-MSP, whose authors report tests in Isaac Sim 6.0: texel (column, row) of
/// the exit table has the octahedral coordinates x = (2 column + 1) / size - 1 to the right and y = (2 row + 1) / size
/// - 1 up, with -z in the centre; (0, 0, 1) marks a dark position and -1 a direction without a position; the optical
/// centre is half of the nominal size. petzval's tests do not run Omniverse.
struct OmniverseTables {
  int columns = 0, rows = 0, exit_size = 0;
  std::vector<float> directions{};  ///< rayEnterDirectionTexture: x, y, z of columns x rows texels
  std::vector<float> positions{};   ///< rayExitPositionTexture: u, v of exit_size x exit_size texels
  /// "omniverse_lut": errors of a picture position that goes through both tables and back to a position, pixels. The
  /// value left_out is the fraction of lit positions next to a texel without a value.
  Calibration fit{};

  /// Attributes of a camera prim that name the two files.
  PETZVAL_API std::string usd(std::string_view enter_file, std::string_view exit_file) const;
};

/// Computes the tables from chief rays.
///
/// @param camera        as in calibrations()
/// @param subject_z_mm  as in LensDistortion; unset: the plane in focus
/// @param exit_size     texels along each side of the exit table, at least 3; an odd number puts centres of texels on
///                      the creases of the octahedron
/// @param threads       at least 1
/// @throws Error        if calibrations() does, or exit_size or threads is too small
PETZVAL_API OmniverseTables omniverse_tables(const Camera& camera, std::optional<double> subject_z_mm = {},
                                             int exit_size = 2049, int threads = 1);

}  // namespace petzval
