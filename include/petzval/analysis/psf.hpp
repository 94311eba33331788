// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {
class Camera;
}

namespace petzval {

/// Geometric image of a point light: the distribution over the film of the light that enters the entrance pupil.
///
/// Counts are exact integers. Their sum is the number of rays that hit the image, for any number of threads; weighted
/// rays count in units of 1 / units_per_ray. Each wavelength has one plane of `pixels` x `pixels` counts, rows from the
/// top (largest y first).
struct Psf {
  int pixels = 0;
  double pixel_mm = 0;
  Vec2<double> centre{0, 0};  ///< film position of the image centre, mm
  std::vector<double> wavelengths_nm;
  std::vector<std::uint64_t> counts;       ///< [wavelength][row][column]
  std::vector<std::uint64_t> sent;         ///< rays started, per wavelength
  std::vector<std::uint64_t> transmitted;  ///< counts of the rays that reached the film, inside or outside the image
  std::uint32_t units_per_ray = 1;         ///< counts of a ray of weight 1
  std::vector<double> sampled_area;        ///< area of the pupil plane where the rays start, mm^2, per wavelength
  double entrance_pupil_area = 0;  ///< area of the paraxial entrance pupil, mm^2; an ellipse for cylindrical lenses

  /// The fraction of the light on the paraxial entrance pupil that a count of 1 carries; 0 if the pupil is empty or the
  /// wavelength index is out of range.
  PETZVAL_API double ray_weight(std::size_t wavelength) const noexcept;

  /// Area of the pupil plane that transmits to the film, divided by the area of the paraxial entrance pupil.
  ///
  /// Does not depend on the crop of the image. For fields of 89 degrees and more both areas face the point. 0 if the
  /// wavelength index is out of range.
  PETZVAL_API double throughput(std::size_t wavelength) const noexcept;
};

/// Options of point_image().
struct PsfOptions {
  std::uint32_t samples = 1u << 20;  ///< rays per wavelength; an upper limit if `tolerance` is set
  /// If positive, rays are sent until PointImage::error is within the tolerance or all samples are used. Starts with
  /// 2^14 rays and doubles their number.
  double tolerance = 0;
  int pixels = 512;
  double half_width_mm = 0;                 ///< half the image width; 0: 5 % larger than the hits, at least 0.1 um
  std::optional<Vec2<double>> centre{};     ///< film position of the image centre, mm; unset: the centroid
  std::optional<std::size_t> wavelength{};  ///< wavelength index; unset: all compiled wavelengths
  std::uint32_t seed = 0;
  int threads = 1;  ///< does not change the results
};

/// The PSF of a point and the size of its blur. The size covers all wavelengths with equal weights.
struct PointImage {
  Psf psf;
  SpotSize size;
  /// Irradiance in 64 rings of equal width from the centroid to size.max_radius, averaged over wavelengths: fraction of
  /// the light on the paraxial entrance pupil, per mm^2. Multiplied by the ring areas it sums to the throughput.
  std::array<double, 64> radial_profile{};
  double throughput = 0;  ///< mean over wavelengths
  /// Bound of the relative error of the light in the rings (root of the summed squares); 0 if no ray passes.
  ///
  /// Accuracy: 95 of 100 new runs stay below the bound (tests/analysis/psf_error_test.cpp). It is estimated from eight
  /// consecutive parts of the samples, which complement each other. The bound is therefore about twice the error off
  /// axis and with blades, and four to five times the error of round pupils on the axis. If the weights of a camera
  /// vary strongly, it is 2.25 times as wide, because few rays determine the edge of a bright rim.
  double error = 0;
};

/// Computes the image of a point light in a camera at every compiled wavelength of its lens.
///
/// Uses the ray model and the weights (BokehControls) of the camera, with connections from the point to the entrance
/// pupil. Light is relative to the light on the paraxial entrance pupil, as for a lens. A ray takes 0.5 to 2
/// microseconds.
///
/// @throws Error under the conditions of point_image(Lens); also if the entrance pupil is infinite or the normalisation
///               of the camera is not irradiance
///
/// Limitations: rays that miss the film are lost, so the film must contain the image. First-order models do not
/// conserve etendue, so their throughput differs from the lens.
PETZVAL_API PointImage point_image(const Camera& camera, const FieldPoint& point, const PsfOptions& options = {});

/// Traces a point light to the film of a lens at every compiled wavelength. All values are 0 if no ray passes.
///
/// @throws Error if samples, pixels or threads are 0, or half_width_mm, tolerance or centre are invalid; also under the
///               conditions of scene_point()
PETZVAL_API PointImage point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options = {});

}  // namespace petzval
