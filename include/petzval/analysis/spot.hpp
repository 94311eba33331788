// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// Centroid of a set of film points, and their moments and largest radius about it (mm). All 0 if there are no points.
struct SpotSize {
  Vec2<double> centroid{0, 0};
  double rms_radius = 0;
  double max_radius = 0;
  double xx = 0, yy = 0, xy = 0;  ///< mean squares and product, mm^2
};

/// The spot size of a set of film points.
///
/// @param x,y  film coordinates (mm); if the lengths differ, the surplus is ignored
PETZVAL_API SpotSize spot_size(std::span<const double> x, std::span<const double> y) noexcept;

/// Radius of the first dark ring of an ideal image on the film (mm); infinite if the stop is closed.
///
/// It is 1.22 wavelength N / n with the refractive index n in front of the film and N = film_side_f_number(lens).
PETZVAL_API double airy_radius(const Lens& lens, Wavelength wavelength = {});

/// The influence of diffraction on a blur.
enum class Diffraction : std::uint8_t {
  negligible,  ///< the Airy disc is at most a tenth as large as the geometric blur: the geometric shape is valid
  visible,     ///< diffraction softens edges and fine structure
  dominant,    ///< the Airy disc is at least as large as the blur: its geometric size and shape are meaningless
};
PETZVAL_API std::string_view name(Diffraction diffraction) noexcept;

/// Classifies a blur by its Airy radius and its geometric radius sqrt(2) rms_radius, the radius of a uniform disc.
PETZVAL_API Diffraction diffraction(double airy_radius_mm, const SpotSize& size) noexcept;

/// Values with two indices, grid[row][column]. Functions of several fields return a row for each field.
template <class T>
struct Grid {
  // No default values: with them, Clang 14 does not convert the vectors to std::span.
  std::vector<T> values;  ///< row by row
  std::size_t columns;

  /// Number of rows.
  std::size_t size() const noexcept { return columns > 0 ? values.size() / columns : 0; }
  std::span<const T> operator[](std::size_t row) const noexcept {
    return std::span(values).subspan(row * columns, columns);
  }
};

/// The spot of one field and wavelength.
struct Spot {
  FieldPoint point;
  std::size_t wavelength = 0;
  /// y on the film of the exact ray through the centre of the stop, regardless of clear apertures; nullopt if the ray
  /// does not reach the film.
  std::optional<double> chief_ray_height;
  /// relative_illumination() of the field; nullopt if the axis is dark or no chief ray reaches the film.
  std::optional<double> relative_illumination;
  std::vector<double> x{}, y{};              ///< film positions of the rays that pass the lens, mm
  std::vector<double> slope_x{}, slope_y{};  ///< dx/dz and dy/dz of these rays behind the lens
  std::size_t sent = 0;                      ///< rays started
  SpotSize size;
};

/// Spots of several fields on the film at every compiled wavelength: [field][wavelength].
///
/// @param lens        the focused lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad)
/// @param samples     rays per field and wavelength
/// @param threads     at least 1; the spots are the same for every number
/// @throws Error      under the conditions of scene_point(), or if threads is less than 1
PETZVAL_API Grid<Spot> spot_diagram(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                    std::uint32_t samples = 4096, int threads = 1);

/// The rays of one field, at all wavelengths, on a film that is moved along z.
struct ThroughFocusSpot {
  double field_rad = 0, film_shift_mm = 0;  ///< shift towards +z
  Vec2<double> centroid{0, 0};              ///< mm
  std::optional<double> rms_radius_mm{};    ///< about the centroid; nullopt if no ray passes
  double sampling_error_mm = 0;             ///< as MtfPoint::sampling_error
};

/// RMS radii on moved films: [field][film]. Follows from positions and slopes; no ray is traced.
///
/// @param spots               result of spot_diagram()
/// @param film_shifts_mm      shifts of the film towards +z (mm)
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @throws Error  if the number of weights differs, or spots have no slopes
PETZVAL_API Grid<ThroughFocusSpot> through_focus(const Grid<Spot>& spots, std::span<const double> film_shifts_mm,
                                                 std::span<const double> wavelength_weights = {});

/// A film step for through_focus(): two steps from the best film the RMS radius over all fields is about three times
/// its least value.
///
/// Two steps are at least the depth of focus 4 lambda N^2, and reach the best film. The step is rounded to 1, 1.5, 2,
/// 3, 4, 5, 6 or 8 times a power of ten.
///
/// @param lens   the lens of the spots
/// @param spots, wavelength_weights  as in through_focus()
/// @return       mm; nullopt if no ray passes or the rays of a field are parallel
/// @throws Error as through_focus()
PETZVAL_API std::optional<double> through_focus_step(const Lens& lens, const Grid<Spot>& spots,
                                                     std::span<const double> wavelength_weights = {});

/// Longitudinal and lateral colour: differences of each compiled wavelength from the primary wavelength (mm).
struct ChromaticAberration {
  /// Shift of the paraxial image of the subject, positive away from the lens; nullopt if the image is at infinity.
  std::vector<std::optional<double>> paraxial_focus_shift;
  /// Shift of the film with the least RMS radius of the axial point, which includes the variation of spherical
  /// aberration with the wavelength; nullopt if there is no such film.
  std::vector<std::optional<double>> sharpest_focus_shift;
  /// [field][wavelength]: shift of Spot::chief_ray_height on the film; nullopt if the chief ray is missing.
  std::vector<std::vector<std::optional<double>>> lateral;
};

/// Computes the chromatic aberration of a lens.
///
/// Lateral colour is measured on the film of the lens, which should be focused on the subject: see with_focus().
///
/// @param lens        the focused lens
/// @param subject_z   subject plane in front of the first vertex (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad) for lateral colour
/// @throws Error      under the conditions of chief_ray() and solve_focus()
PETZVAL_API ChromaticAberration chromatic_aberration(const Lens& lens, double subject_z,
                                                     std::span<const double> fields_rad);

}  // namespace petzval
