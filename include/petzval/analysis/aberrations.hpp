// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// Errors of the rays of one field and wavelength in two sections of the pupil: transverse errors on the film (mm),
/// relative to the chief ray of the primary wavelength, and wavefront errors (waves), relative to the sphere of
/// wavefront().
struct RayFan {
  double field_rad = 0;
  std::size_t wavelength = 0;
  /// A position on the stop from -1 to 1 in semi-diameters, along y for the tangential ray and along x for the sagittal
  /// ray. nullopt: the lens clips the ray.
  struct Point {
    double pupil = 0;
    std::optional<double> tangential_mm{}, sagittal_mm{};
    std::optional<double> tangential_waves{}, sagittal_waves{};
  };
  std::vector<Point> points;
};

/// Ray fans of several fields at every compiled wavelength: [field][wavelength].
///
/// The tangential error is along y on the film, the sagittal error along x. Rays are aimed at the stop exactly (aim()).
///
/// @param lens        the focused lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles towards +y (rad), as in FieldPoint
/// @param count       positions on the stop, at least 2; evenly spaced from -1 to 1
/// @throws Error      if count is below 2, or under the conditions of aim()
PETZVAL_API Grid<RayFan> ray_fans(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                  std::size_t count = 33);

/// Foci of narrow beams about the chief ray of one field, as distances from the film along the axis (mm), positive away
/// from the lens. nullopt: no chief ray reaches the film, or the beam stays parallel.
struct FieldFocus {
  double field_rad = 0;
  std::optional<double> tangential_mm, sagittal_mm;
};

/// Field curvature and astigmatism. Clear apertures do not matter.
///
/// @param lens, subject_z, fields_rad  as in ray_fans()
/// @param wavelength  a compiled wavelength
/// @throws Error      under the conditions of aim()
///
/// Accuracy: central differences over 0.004, 0.002 and 0.001 semi-diameters of the stop, extrapolated to 0; 1e-6 of the
/// foci, also for aspheres with r^3 (tests/analysis/aberrations_test.cpp).
PETZVAL_API std::vector<FieldFocus> field_curvature(const Lens& lens, double subject_z,
                                                    std::span<const double> fields_rad, Wavelength wavelength = {});

/// The height of a chief ray on the film compared with two projections of the same scale on the axis.
struct FieldDistortion {
  double field_rad = 0;
  std::optional<double> height_mm;  ///< y on the film; nullopt: no chief ray reaches the film
  /// Per cent of f tan(theta), and of f theta; 0 on the axis; nullopt without a height, and for f tan(theta) at 90
  /// degrees and more.
  std::optional<double> f_tan_theta_percent, f_theta_percent;
};

/// Distortion in per cent. f is the ratio of height to field in the limit of small fields, on the film of the lens.
///
/// @param lens, subject_z, fields_rad, wavelength  as in field_curvature()
/// @throws Error  under the conditions of aim()
PETZVAL_API std::vector<FieldDistortion> distortion_percent(const Lens& lens, double subject_z,
                                                            std::span<const double> fields_rad,
                                                            Wavelength wavelength = {});

/// The modulation transfer of one field at one frequency: the contrast of lines perpendicular to y (tangential) and to
/// x (sagittal) on the film.
struct MtfPoint {
  double field_rad = 0, frequency_per_mm = 0;
  double tangential = 0, sagittal = 0;  ///< 0 to 1; 0 if no ray passes
  /// geometric_mtf(): largest deviation of a quarter of the rays from all rays, of both contrasts. Usually larger than
  /// the error. diffraction_mtf() of a lens: bound of the error.
  double sampling_error = 0;
  // The others are of diffraction_mtf() of a lens.
  double tangential_limit = 1, sagittal_limit = 1;  ///< contrast of the same vignetted pupil without wavefront error
  /// Distance of the chief ray from the axis on the film; NaN if there is no such ray.
  double image_height_mm = std::numeric_limits<double>::quiet_NaN();
  double film_shift_mm = 0;  ///< position of the film relative to the film of the lens
};

/// The f-number of a lens, and contrasts of several fields: [field][frequency].
using MtfChart = std::pair<double, Grid<MtfPoint>>;

/// Geometric MTF from spots: [field][frequency].
///
/// @param spots               result of spot_diagram()
/// @param frequencies_per_mm  spatial frequencies (line pairs per mm)
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @param threads             at least 1; they share the points, and the result is the same for every number
/// @throws Error  if the number of weights differs
///
/// Accuracy: 1e-3 with 32768 rays per field and wavelength, 0.01 with 4096 (tests/analysis/aberrations_test.cpp).
PETZVAL_API Grid<MtfPoint> geometric_mtf(const Grid<Spot>& spots, std::span<const double> frequencies_per_mm,
                                         std::span<const double> wavelength_weights = {}, int threads = 1);

/// The radius about the centroid that holds a fraction of the rays of one field, without diffraction.
struct EncircledEnergy {
  double field_rad = 0, fraction = 0;
  std::optional<double> radius_mm;  ///< nullopt if no ray passes
  double sampling_error_mm = 0;     ///< as MtfPoint::sampling_error
};

/// Geometric encircled energy: [field][fraction]. Centroid and fraction refer to all wavelengths.
///
/// @param spots, wavelength_weights, threads  as in geometric_mtf()
/// @param fractions  from 0 to 1; 1 is the largest radius
/// @throws Error     as geometric_mtf(), or if a fraction is outside 0 to 1
PETZVAL_API Grid<EncircledEnergy> encircled_energy(const Grid<Spot>& spots, std::span<const double> fractions,
                                                   std::span<const double> wavelength_weights = {}, int threads = 1);

/// The crossing of the axis by a ray of the axial point, as a distance from the film along z (mm).
struct AxialRayFocus {
  std::size_t wavelength = 0;
  double pupil = 0;  ///< position on the stop, 0 to 1, in semi-diameters; 0: the limit of rays near the axis
  /// Rays in the sections y-z and x-z; both are equal without cylinders. nullopt: the lens clips the ray, or the ray
  /// stays parallel to the axis.
  std::optional<double> tangential_mm, sagittal_mm;
};

/// Longitudinal aberration at every compiled wavelength: [wavelength][position on the stop].
///
/// @param lens, subject_z  as in ray_fans()
/// @param count       positions on the stop, at least 2; evenly spaced from 0 to 1
/// @throws Error      if count is below 2, or under the conditions of aim()
///
/// Accuracy: rounding, and at 0 the ray at 0.001 semi-diameters.
PETZVAL_API Grid<AxialRayFocus> longitudinal_aberration(const Lens& lens, double subject_z, std::size_t count = 33);

/// MTF of an ideal lens with a round pupil on the axis.
///
/// @param frequency_per_mm  spatial frequency (line pairs per mm)
/// @param wavelength_nm     wavelength in the medium of the film: the wavelength in vacuum divided by the index
/// @param f_number          image-side f-number
/// @return                  1 at 0, 0 from 1 / (wavelength f_number) on
PETZVAL_API double diffraction_limited_mtf(double frequency_per_mm, double wavelength_nm, double f_number) noexcept;

/// Object and field of paraxial_rays().
struct ParaxialField {
  /// Distance of the object in front of the first vertex (mm); negative for a virtual object; beyond 1e100 mm infinite.
  double object_distance = std::numeric_limits<double>::infinity();
  double field_rad = 0;  ///< angle of the chief ray in object space; positive if the ray rises along z
  /// Height of the object (mm), used instead of `field_rad`. The object must be at a finite distance.
  std::optional<double> object_height{};
  /// Diameter of the paraxial entrance pupil (mm), used instead of the rim of the stop.
  std::optional<double> entrance_pupil_diameter{};
};

/// The paraxial marginal ray and chief ray of a lens.
struct ParaxialRays {
  /// Heights (mm) at one surface, and slopes dy/dz behind the surface, also while light runs backwards.
  struct Pair {
    double marginal_y = 0, marginal_u = 0, chief_y = 0, chief_u = 0;
  };
  double object_marginal_u = 0, object_chief_u = 0;  ///< slopes in object space
  double invariant = 0;                              ///< optical invariant n (u ybar - ubar y), mm
  std::vector<Pair> surfaces;                        ///< in the order of the lens
};

/// Paraxial marginal ray and chief ray, surface by surface.
///
/// The marginal ray starts at the axial point of the object, passes the rim of the stop or of the given entrance
/// pupil, and has a positive height at the first vertex. The chief ray passes the centre of the stop. The stop is
/// pupils().stop.
///
/// @param lens        the lens
/// @param field       object and field
/// @param wavelength  the wavelength
/// @throws Error      if the lens has cylindrical surfaces or no stop, if a value of `field` is out of range, or if a
///                    ray does not exist, such as a chief ray by angle in front of a telecentric lens
PETZVAL_API ParaxialRays paraxial_rays(const Lens& lens, const ParaxialField& field = {}, Wavelength wavelength = {});

/// Third-order and chromatic aberrations, in mm.
struct SeidelTerms {
  double s1 = 0;  ///< spherical aberration
  double s2 = 0;  ///< coma
  double s3 = 0;  ///< astigmatism
  double s4 = 0;  ///< Petzval curvature
  double s5 = 0;  ///< distortion
  double c1 = 0;  ///< axial colour
  double c2 = 0;  ///< lateral colour
};

/// The terms of each surface and their sums.
struct SeidelSums {
  std::vector<SeidelTerms> surfaces;  ///< in the order of the lens
  SeidelTerms sums;
};

/// Seidel sums and chromatic sums of a lens, surface by surface.
///
/// Formulas and signs: W. T. Welford, Aberrations of Optical Systems (1986), chapters 8 and 10. The wavefront is
/// W = S1/8 r^4 + S2/2 h y r^2 + S3/2 h^2 y^2 + (S3 + S4)/4 h^2 r^2 + S5/2 h^3 y with pupil radius r and field h
/// relative to the marginal ray and the chief ray. S1 and C1 of a positive single lens are positive. C1 and C2 are
/// linear in the index differences n(`shorter`) - n(`longer`). Conic constants and terms of order 2 and 4 contribute,
/// and mirrors have signed indices.
///
/// @param lens        the lens
/// @param field       object and field of paraxial_rays()
/// @param wavelength  the wavelength of the rays and of S1 to S5
/// @param shorter     first wavelength of C1 and C2
/// @param longer      second wavelength of C1 and C2; equal wavelengths give 0
/// @throws Error      as paraxial_rays(); if a surface has an aspheric term of order 3, which has no third-order sums;
///                    if the lens has no index at a wavelength
///
/// Accuracy: sums equal limits of exact rays within 1e-4, and closed forms within 1e-9
/// (tests/analysis/seidel_test.cpp).
PETZVAL_API SeidelSums seidel_sums(const Lens& lens, const ParaxialField& field = {}, Wavelength wavelength = {},
                                   Wavelength shorter = {}, Wavelength longer = {});

}  // namespace petzval
