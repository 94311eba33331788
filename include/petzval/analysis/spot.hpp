// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/ray_bundle.hpp"

namespace petzval {

/// Centroid, and moments and largest radius about it, of a set of film points (mm); zeros for none.
struct SpotSize {
  Vec2<double> centroid{0, 0};
  double rms_radius = 0;
  double max_radius = 0;
  double xx = 0, yy = 0, xy = 0;  ///< mean squares and product, mm^2
};

/// x, y: N each; points without both coordinates are left out.
PETZVAL_API SpotSize spot_size(std::span<const double> x, std::span<const double> y) noexcept;

/// The same of all rays of several bundles, by their weights where they have some.
PETZVAL_API SpotSize spot_size(std::span<const RayBundle> sets) noexcept;

/// Radius of the first dark ring of an ideal image on the film, 1.22 wavelength N / n, mm, n: index in front of the
/// film, N = film_side_f_number (lens). Infinite for a closed stop.
PETZVAL_API double airy_radius(const Lens& lens, Wavelength wavelength = {});

/// How much of a blur is diffraction.
enum class Diffraction : std::uint8_t {
  negligible,  ///< the Airy disc is at most a tenth as large as the geometric blur: rays tell its shape
  visible,     ///< it softens edges and fine structure
  dominant,    ///< it is as large as the blur: rays tell neither size nor shape
};
PETZVAL_API std::string_view name(Diffraction diffraction) noexcept;

/// By airy_radius() and the geometric blur's rms_radius, of which a uniform disc has 1 / sqrt 2 of its radius.
PETZVAL_API Diffraction diffraction(double airy_radius_mm, const SpotSize& size) noexcept;

/// The spot of one field and wavelength.
struct Spot {
  FieldPoint point;
  std::size_t wavelength = 0;
  /// y on the film of the exact ray through the centre of the stop; clear apertures do not stop it. Unset where no such
  /// ray reaches the film.
  std::optional<double> chief_ray_height;
  /// relative_illumination() of the field. Unset where the axis is dark.
  std::optional<double> relative_illumination;
  RayBundle hits;
  SpotSize size;
};

/// Spots of several fields on the lens's film at every compiled wavelength, ordered by field, then by wavelength.
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does.
PETZVAL_API std::vector<Spot> spot_diagram(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                           std::uint32_t samples = 4096);

/// Longitudinal and lateral colour: what each compiled wavelength differs by from the primary one, mm; 0 at that one.
struct ChromaticAberration {
  /// z of the paraxial image of the subject. Positive: farther from the lens. Unset for an image at infinity.
  std::vector<std::optional<double>> paraxial_focus_shift;
  /// The same of the film on which the axial point has the least RMS radius: also spherical aberration varies with the
  /// wavelength. Unset where no such film exists.
  std::vector<std::optional<double>> sharpest_focus_shift;
  /// [field][wavelength]: y of the chief ray on the lens's film, as Spot::chief_ray_height. Unset without such a ray.
  std::vector<std::vector<std::optional<double>>> lateral;
};

/// For a subject at subject_z (lens frame, mm, in front of the first vertex, -inf at infinity). Lateral colour belongs
/// to a film on which the subject is in focus: see with_focus(). Throws Error where chief_ray() and solve_focus() do.
PETZVAL_API ChromaticAberration chromatic_aberration(const Lens& lens, double subject_z,
                                                     std::span<const double> fields_rad);

}  // namespace petzval
