// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// What "in focus" means, and how large a blur is (its diameter).
enum class FocusCriterion : std::uint8_t {
  thin,      ///< thin lens of the same focal length at the rear principal plane, as wide as the entrance pupil
  paraxial,  ///< thick lens: the cardinal points, and the cone of the paraxial pupil
  min_rms,   ///< exact rays: least RMS radius; a blur's diameter is that of the even disc with the same RMS radius
  min_max,   ///< exact rays: least largest radius; a blur's diameter is twice that
};

/// From where a subject distance is measured, towards the scene (positive, may be infinite).
enum class DistanceOrigin : std::uint8_t {
  front_vertex,
  film,             ///< as engraved on barrels; where the film stands in the solution
  front_principal,  ///< paraxial, of the lens itself also for `thin`
};

enum class FocusStatus : std::uint8_t {
  solved,
  unreachable,  ///< no subject in front of the lens goes with a film behind it: too near, or the film too far in
  no_rays,      ///< exact criteria: of one of the fields nothing gets through
  afocal,       ///< the lens has no focal length
  too_blurred,  ///< depth of field, hyperfocal distance: even what is in focus is blurred more than asked for
};

/// "thin", "paraxial", "min_rms" or "min_max"; "front_vertex", ...; "solved", ...
PETZVAL_API std::string_view name(FocusCriterion criterion) noexcept;
PETZVAL_API std::string_view name(DistanceOrigin origin) noexcept;
PETZVAL_API std::string_view name(FocusStatus status) noexcept;

/// A field that has a say in the focus: seen from the entrance pupil, as in FieldPoint. All fields share the plane
/// perpendicular to the axis in which the subject lies.
struct FocusField {
  double field_rad = 0;
  double weight = 1;
};

struct FocusOptions {
  FocusCriterion criterion = FocusCriterion::paraxial;
  DistanceOrigin origin = DistanceOrigin::front_vertex;
  /// min_rms: weights of the squared RMS radii, each about the centroid of its field. min_max: the largest weighted
  /// radius counts. thin and paraxial look at the axis.
  std::vector<FocusField> fields = {FocusField{}};
  /// One per compiled wavelength, by the light in it; empty: the central wavelength alone. min_max counts every
  /// wavelength with a weight. thin, paraxial and front_principal look at the one of largest weight, of several the
  /// central one.
  std::vector<double> wavelength_weights = {};
};

/// A subject and its film. When unreachable, the nearest pair to the one asked for: infinity for a film too far in; the
/// nearest subject, its film at infinity or at the turning point of a distance from the film, for one too near. All
/// are infinite where the lens forms no real image of anything.
struct FocusSolution {
  FocusStatus status = FocusStatus::solved;
  double film_z = 0;     ///< lens frame, mm
  double subject_z = 0;  ///< lens frame, mm; -inf at infinity
  double distance = 0;   ///< of the subject from the origin of the options, mm

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Film position that brings a subject into focus (the lens stays, the film moves).
///
/// distance_mm: > 0 or +inf. Where two film positions serve one distance from the film, the one nearer to the rear
/// focus is given. A lens with cylinders is focused in its main meridian, by the exact criteria over all azimuths.
/// min_rms takes the position of least RMS radius in closed form from bundles through whatever passes every rim
/// (pupil_boundary), equally by area of the entrance pupil; min_max finds the least largest radius of the same bundles
/// and the edges and corners of their pupils to rounding; a largest radius is found within 0.2 %. Both must lie behind
/// the last vertex. Throws Error for NaN or a distance that is not positive; for fields and weights that are none; and
/// by the exact criteria where pupil_boundary does. Accuracy: paraxial and thin within rounding; of the exact criteria
/// the film is that of endlessly many rays within 1e-5 mm on the axis and 2e-4 mm off it (double Gauss 100 mm f/2, 10
/// degrees).
PETZVAL_API FocusSolution solve_focus(const Lens& lens, double distance_mm, const FocusOptions& options = {});

/// The inverse: the subject that is in focus on a film. Throws Error for a film_z that is not finite, and where
/// solve_focus does. The solution's distance, focused at, gives the film back within 4 eps of its place (1e-13 by the
/// exact criteria), unless it counts from the film and lies nearer than the turning point.
PETZVAL_API FocusSolution solve_subject(const Lens& lens, double film_z, const FocusOptions& options = {});

/// The limit of what solve_focus reaches; its distance itself may not be reached.
PETZVAL_API FocusSolution nearest_focus(const Lens& lens, const FocusOptions& options = {});

/// The lens with its film where solve_focus puts it. Throws Error, naming the nearest distance, where there is no
/// focus.
PETZVAL_API Lens with_focus(const Lens& lens, double distance_mm, const FocusOptions& options = {});

}  // namespace petzval::inline v0
