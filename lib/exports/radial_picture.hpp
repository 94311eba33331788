// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/camera/camera.hpp"

namespace petzval::exports_detail {

/// Distance in the picture of each field angle, from chief rays towards the upper right corner of the picture.
class ChiefProfile {
 public:
  ChiefProfile(const Camera& camera, double subject_distance, double pupil_z, Wavelength wavelength)
      : camera_(camera), distance_(subject_distance), pupil_z_(pupil_z), wavelength_(wavelength) {}

  /// Distance from the centre of the picture, pixels; nullopt if no chief ray arrives.
  std::optional<double> radius(double field) const;
  /// Field angle of a distance, by bisection below a field whose distance is larger.
  std::optional<double> field(double radius_px, double widest) const;

 private:
  Camera camera_;
  double distance_, pupil_z_;
  Wavelength wavelength_;
};

/// Irradiance of a film point towards the corner, at the primary wavelength.
double irradiance(const Camera& camera, double radius_mm);

/// A picture with symmetry of revolution about its centre.
struct RadialPicture {
  /// @throws Error if LensDistortion does, the lens has cylinders, the film is tilted, shifted or travels, or pixels
  ///               are not square
  RadialPicture(const Camera& camera, std::optional<double> subject_z_mm);

  ChiefProfile at(Wavelength wavelength) const { return {camera, distance, pupil_z, wavelength}; }

  Camera camera;
  double pupil_z = 0, distance = 0;  ///< distance: from the pupil to the subject, at most 1e9 mm
  double corner = 0;                 ///< distance from the centre to the corner, pixels
  ChiefProfile primary;
  double widest = 0;  ///< the first multiple of 0.5 degrees beyond the corner, or the last with a chief ray
};

}  // namespace petzval::exports_detail
