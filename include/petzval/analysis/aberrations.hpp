// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

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

/// Ray fans of several fields at every compiled wavelength, ordered by field, then by wavelength.
///
/// The tangential error is along y on the film, the sagittal error along x. Rays are aimed at the stop exactly (aim()).
///
/// @param lens        the focused lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles towards +y (rad), as in FieldPoint
/// @param count       positions on the stop, at least 2; evenly spaced from -1 to 1
/// @throws Error      if count is below 2, or under the conditions of aim()
PETZVAL_API std::vector<RayFan> ray_fans(const Lens& lens, double subject_z, std::span<const double> fields_rad,
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

/// The modulation transfer of one field at one frequency, without diffraction: the contrast of lines perpendicular to y
/// (tangential) and to x (sagittal) on the film.
struct MtfPoint {
  double field_rad = 0, frequency_per_mm = 0;
  double tangential = 0, sagittal = 0;  ///< 0 to 1; 0 if no ray passes
  /// Largest deviation of a quarter of the rays from all rays, of both contrasts. Usually larger than the error.
  double sampling_error = 0;
};

/// Geometric MTF from spots, ordered by field, then by frequency.
///
/// @param spots               result of spot_diagram(): all wavelengths of each field
/// @param wavelengths         number of wavelengths of each field
/// @param frequencies_per_mm  spatial frequencies (line pairs per mm)
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @param threads             at least 1; they share the points, and the result is the same for every number
/// @throws Error  if the number of spots is not a multiple of `wavelengths`, or the number of weights differs
///
/// Accuracy: 1e-3 with 32768 rays per field and wavelength (tests/analysis/aberrations_test.cpp).
PETZVAL_API std::vector<MtfPoint> geometric_mtf(std::span<const Spot> spots, std::size_t wavelengths,
                                                std::span<const double> frequencies_per_mm,
                                                std::span<const double> wavelength_weights = {}, int threads = 1);

/// Traces rays from several fields and computes their geometric_mtf(), ordered by field, then by frequency.
///
/// @param lens, subject_z, fields_rad  as in ray_fans()
/// @param frequencies_per_mm, wavelength_weights, threads  as in geometric_mtf()
/// @param samples  rays per field and wavelength
/// @throws Error   under the conditions of spot_diagram() and geometric_mtf()
///
/// Accuracy: 0.01 with 4096 rays (tests/analysis/aberrations_test.cpp).
PETZVAL_API std::vector<MtfPoint> mtf_over_field(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                                 std::span<const double> frequencies_per_mm,
                                                 std::span<const double> wavelength_weights = {},
                                                 std::uint32_t samples = 4096, int threads = 1);

/// The radius about the centroid that holds a fraction of the rays of one field, without diffraction.
struct EncircledEnergy {
  double field_rad = 0, fraction = 0;
  std::optional<double> radius_mm;  ///< nullopt if no ray passes
  double sampling_error_mm = 0;     ///< as MtfPoint::sampling_error
};

/// Geometric encircled energy, ordered by field, then by fraction. Centroid and fraction refer to all wavelengths.
///
/// @param spots, wavelengths, wavelength_weights, threads  as in geometric_mtf()
/// @param fractions  from 0 to 1; 1 is the largest radius
/// @throws Error     as geometric_mtf(), or if a fraction is outside 0 to 1
PETZVAL_API std::vector<EncircledEnergy> encircled_energy(std::span<const Spot> spots, std::size_t wavelengths,
                                                          std::span<const double> fractions,
                                                          std::span<const double> wavelength_weights = {},
                                                          int threads = 1);

/// The crossing of the axis by a ray of the axial point, as a distance from the film along z (mm).
struct AxialRayFocus {
  std::size_t wavelength = 0;
  double pupil = 0;  ///< position on the stop, 0 to 1, in semi-diameters; 0: the limit of rays near the axis
  /// Rays in the sections y-z and x-z; both are equal without cylinders. nullopt: the lens clips the ray, or the ray
  /// stays parallel to the axis.
  std::optional<double> tangential_mm, sagittal_mm;
};

/// Longitudinal aberration at every compiled wavelength, ordered by wavelength, then by position on the stop.
///
/// @param lens, subject_z  as in ray_fans()
/// @param count       positions on the stop, at least 2; evenly spaced from 0 to 1
/// @throws Error      if count is below 2, or under the conditions of aim()
///
/// Accuracy: rounding, and at 0 the ray at 0.001 semi-diameters.
PETZVAL_API std::vector<AxialRayFocus> longitudinal_aberration(const Lens& lens, double subject_z,
                                                               std::size_t count = 33);

/// MTF of an ideal lens with a round pupil on the axis.
///
/// @param frequency_per_mm  spatial frequency (line pairs per mm)
/// @param wavelength_nm     wavelength in the medium of the film: the wavelength in vacuum divided by the index
/// @param f_number          image-side f-number
/// @return                  1 at 0, 0 from 1 / (wavelength f_number) on
PETZVAL_API double diffraction_limited_mtf(double frequency_per_mm, double wavelength_nm, double f_number) noexcept;

}  // namespace petzval
