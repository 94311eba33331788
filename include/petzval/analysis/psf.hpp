// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/ray_bundle.hpp"

namespace petzval {
class Camera;
}

namespace petzval {

/// Geometric image of a point light: how the light that enters the entrance pupil spreads over the film.
///
/// counts are exact integers: their sum is the number of rays that hit the picture, for any number of threads; rays
/// with weights count in units of 1 / units_per_ray. Each wavelength has one plane of counts, rows from the top
/// (largest y first), `pixels` squared.
struct Psf {
  int pixels = 0;
  double pixel_mm = 0;
  Vec2<double> centre{0, 0};  ///< of the picture, film, mm
  std::vector<double> wavelengths_nm;
  std::vector<std::uint64_t> counts;       ///< [wavelength][row][column]
  std::vector<std::uint64_t> sent;         ///< rays started, per wavelength
  std::vector<std::uint64_t> transmitted;  ///< counts of the rays that reached the film, on the picture or outside it
  std::uint32_t units_per_ray = 1;         ///< counts of a ray of weight 1
  std::vector<double> sampled_area;        ///< of the pupil plane where the rays start, mm^2, per wavelength
  double entrance_pupil_area = 0;  ///< of the paraxial entrance pupil, mm^2; an ellipse in a lens with cylinders

  /// The share of the light on the paraxial entrance pupil that a count of 1 carries. 0 for an empty pupil and for a
  /// wavelength that does not exist.
  PETZVAL_API double ray_weight(std::size_t wavelength) const noexcept;

  /// Area of the pupil plane that transmits to the film, over the area of the paraxial entrance pupil; the crop of the
  /// picture does not change it. (From 89 degrees on both areas face the point.) 0 for a wavelength that does not
  /// exist.
  PETZVAL_API double throughput(std::size_t wavelength) const noexcept;
};

struct PsfOptions {
  std::uint32_t samples = 1u << 20;  ///< rays per wavelength; at most, with a tolerance
  /// > 0: rays are sent until PointImage::error is at most that, or all have been: 2^14 first, then twice as many.
  double tolerance = 0;
  int pixels = 512;
  double half_width_mm = 0;                 ///< of the picture; 0: 5 % more than the hits need, at least 0.1 um
  std::optional<Vec2<double>> centre{};     ///< of the picture, film, mm; else the centroid
  std::optional<std::size_t> wavelength{};  ///< the only one, a position in Lens::wavelengths_nm(); else all
  std::uint32_t seed = 0;
  int threads = 1;  ///< results do not depend on it
};

/// The PSF together with the size of the blur over all wavelengths, every ray with the same weight.
struct PointImage {
  Psf psf;
  SpotSize size;
  /// Irradiance in 64 rings of equal width from the centroid to size.max_radius, mean over wavelengths: the share of
  /// the light on the paraxial entrance pupil, per mm^2. Times the areas of the rings it sums to the throughput.
  std::array<double, 64> radial_profile{};
  double throughput = 0;  ///< mean over wavelengths
  /// A bound of the relative error of the light in the rings of the profile (root of summed squares), which 95 of 100
  /// fresh runs keep (tests/analysis/psf_error_test.cpp). From eight parts of the samples that follow each other; as
  /// these complement each other, it is about twice the error off the axis and with blades, and four to five times the
  /// error on the axis of round pupils. Of a camera whose weights are uneven the bound is wider (times 2.25): where a
  /// bright rim ends depends on few rays. 0 where no ray passes.
  double error = 0;
};

/// The image that a camera makes of a point light, at every wavelength of its lens: by its ray model and with its
/// weights (BokehControls), from connections of the point to the entrance pupil. Rays that miss the film are lost, so
/// it has to hold the picture. A share is of the light on the lens's paraxial entrance pupil, as for a lens;
/// first-order models do not conserve etendue and have their own. A ray takes half a microsecond to two. Throws Error
/// as below, for a lens whose entrance pupil is infinite, and for another normalisation than irradiance.
PETZVAL_API PointImage point_image(const Camera& camera, const FieldPoint& point, const PsfOptions& options = {});

/// Traces a point light onto the lens's film at every compiled wavelength. All values are 0 where no ray passes. Throws
/// Error where pupil_boundary does, for 0 samples, pixels or threads, and for an invalid half width, tolerance or
/// centre.
PETZVAL_API PointImage point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options = {});

}  // namespace petzval
