// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/psf/bundle.hpp"

namespace petzval::inline v0 {

/// Centroid, RMS and largest radius of a set of film points (mm); zeros for none.
struct SpotSize {
  std::array<double, 2> centroid{0, 0};
  double rms_radius = 0;  ///< about the centroid
  double max_radius = 0;  ///< about the centroid
};

PETZVAL_API SpotSize spot_size(std::span<const double> x, std::span<const double> y) noexcept;

/// Of several sets as one, every ray with the same weight.
PETZVAL_API SpotSize spot_size(std::span<const FilmHits> sets) noexcept;

/// The spot of one field and wavelength.
struct Spot {
  FieldPoint point;
  std::size_t wavelength = 0;
  /// y on the film of the chief ray, exactly through the centre of the stop, clear apertures ignored. Nothing where no
  /// such ray reaches the film.
  std::optional<double> chief_ray_height;
  /// Of the film here to that on the axis, as relative_illumination gives it. Nothing where the axis is dark.
  std::optional<double> relative_illumination;
  FilmHits hits;
  SpotSize size;
};

/// Spots of several fields on the lens's film, at every compiled wavelength: field by field, and by wavelength within.
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does.
PETZVAL_API std::vector<Spot> spot_diagram(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                           std::uint32_t samples = 4096);

}  // namespace petzval::inline v0
