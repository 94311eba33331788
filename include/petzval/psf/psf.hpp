// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/psf/bundle.hpp"
#include "petzval/psf/spot.hpp"

namespace petzval::inline v0 {

/// Geometric image of a point light: how the light that the entrance pupil takes in spreads over the film.
///
/// counts are exact integers, so that their sum is the number of rays that fell on the picture, whatever the order or
/// number of threads. One plane of counts a wavelength, rows from the top (largest y first), `pixels` squared.
struct Psf {
  int pixels = 0;
  double pixel_mm = 0;
  std::array<double, 2> centre{0, 0};  ///< of the picture, film, mm
  std::vector<double> wavelengths_nm;
  std::vector<std::uint64_t> counts;       ///< [wavelength][row][column]
  std::vector<std::uint64_t> sent;         ///< rays started, per wavelength
  std::vector<std::uint64_t> transmitted;  ///< rays that reached the film, on the picture or beside it
  std::vector<double> sampled_area;        ///< mm^2 of pupil plane the rays were spread over, per wavelength
  double entrance_pupil_area = 0;  ///< of the paraxial entrance pupil, mm^2; an ellipse in a lens with cylinders

  /// What one ray carries: its share of the light that falls onto the paraxial entrance pupil. 0 for an empty pupil.
  PETZVAL_API double ray_weight(std::size_t wavelength) const noexcept;

  /// Transmitted area of the PupilPlane over that of the paraxial entrance pupil, before the picture's crop. (From 89
  /// degrees on that plane faces the point, and so does the pupil it is compared with.)
  PETZVAL_API double throughput(std::size_t wavelength) const noexcept;
};

struct PsfOptions {
  std::uint32_t samples = 1u << 20;  ///< rays per wavelength
  int pixels = 512;
  double half_width_mm = 0;  ///< of the picture; 0: fits the hits, with 5 % around them and no less than 0.1 um
  std::uint32_t seed = 0;
  int threads = 1;  ///< results do not depend on it
};

/// The PSF together with the size of the blur over all wavelengths, every ray with the same weight.
struct PointImage {
  Psf psf;
  SpotSize size;
  /// Irradiance in 64 rings of equal width from the centroid to size.max_radius, per mm^2 and in units of the light
  /// that falls onto the paraxial entrance pupil, mean over wavelengths; times the rings' areas it sums to the
  /// throughput.
  std::array<double, 64> radial_profile{};
  double throughput = 0;  ///< mean over wavelengths
};

/// Traces a point light onto the lens's film at every compiled wavelength; the picture is centred on the centroid.
/// Where nothing gets through all is 0. Throws Error where pupil_boundary does, and for no samples, pixels or threads
/// and a half width that is no length.
PETZVAL_API PointImage point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options = {});

}  // namespace petzval::inline v0
