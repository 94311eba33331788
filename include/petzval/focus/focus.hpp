// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The meaning of "in focus", and of the diameter of a blur.
enum class FocusCriterion : std::uint8_t {
  thin,      ///< thin lens of the same focal length at the rear principal plane, as wide as the entrance pupil
  paraxial,  ///< thick lens: the cardinal points, and the cone of the paraxial pupil
  min_rms,  ///< exact rays: least RMS radius; the diameter of a blur is that of the uniform disc of the same RMS radius
  min_max,  ///< exact rays: least largest radius; the diameter of a blur is twice the largest radius
};

/// The origin of subject distances, which count towards the scene (positive, may be infinite).
enum class DistanceOrigin : std::uint8_t {
  front_vertex,
  film,             ///< as engraved on barrels: the film of the solution
  entrance_pupil,   ///< paraxial: the point from which a camera sees the scene
  front_principal,  ///< paraxial; that of the thick lens also for `thin`
};

enum class FocusStatus : std::uint8_t {
  solved,
  unreachable,  ///< no subject in front of the lens and film behind it: the subject too near or the film too far in
  no_rays,      ///< exact criteria: no ray of one of the fields passes the lens
  afocal,       ///< the lens has no focal length
  too_blurred,  ///< depth of field, hyperfocal distance: even the sharpest subject is blurred more than allowed
};

/// "thin", "paraxial", "min_rms" or "min_max"; "front_vertex", ...; "solved", ...
PETZVAL_API std::string_view name(FocusCriterion criterion) noexcept;
PETZVAL_API std::string_view name(DistanceOrigin origin) noexcept;
PETZVAL_API std::string_view name(FocusStatus status) noexcept;

/// The plane from which distances count, for the lens as it is: its own film, and paraxial planes of the primary
/// wavelength in the main meridian.
///
/// @return  z in the lens frame, mm
/// @throws Error  if the entrance pupil is at infinity or nothing limits the beam, and for a front principal plane of
///                an afocal lens
PETZVAL_API double origin_z(const Lens& lens, DistanceOrigin origin);

/// A field that counts in the focus, seen from the entrance pupil as in FieldPoint. The subjects of all fields lie in
/// one plane perpendicular to the axis.
struct FocusField {
  double field_rad = 0;
  double weight = 1;
};

struct FocusOptions {
  /// What a camera shows: every ray model of a lens is sharpest at one distance, that of min_rms. Lenses whose entrance
  /// pupil is at infinity have the paraxial criteria alone.
  FocusCriterion criterion = FocusCriterion::min_rms;
  DistanceOrigin origin = DistanceOrigin::front_vertex;
  /// min_rms: weights of the squared RMS radii, each about the centroid of its field. min_max: the largest weighted
  /// radius counts. thin and paraxial use the axis alone.
  std::vector<FocusField> fields = {FocusField{}};
  /// One per compiled wavelength, by the light in it; empty: the primary wavelength alone. min_max counts every
  /// wavelength with a weight. thin, paraxial and front_principal use the wavelength of largest weight, among equal
  /// ones the primary.
  std::vector<double> wavelength_weights = {};
};

/// A subject and its film. If unreachable, the nearest pair to the wanted one: infinity for a film too far in; for a
/// subject too near, the nearest subject, with its film at infinity or at the turning point of distances from the film.
/// All values are infinite if the lens forms no real image.
struct FocusSolution {
  FocusStatus status = FocusStatus::solved;
  double film_z = 0;     ///< lens frame, mm
  double subject_z = 0;  ///< lens frame, mm; -inf at infinity
  double distance = 0;   ///< of the subject from the origin of the options, mm

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Film position that brings a subject into focus (the lens stays, the film moves).
///
/// distance: > 0 or +inf. If two film positions serve one distance from the film, the one nearer to the rear focus. A
/// lens with cylinders is focused in its main meridian, by the exact criteria over all azimuths; where the other
/// section has little power, the film of least RMS radius turns back towards the lens as the subject comes nearer, and
/// nearer subjects count as too near. min_rms: the position of least RMS radius in closed form, from bundles through
/// everything that passes all rims, uniform in the area of the entrance pupil. min_max: the position of the least
/// largest radius of the same bundles and the edges and corners of their pupils, to rounding; a largest radius is found
/// within 0.2 %. Both lie behind the last vertex. Throws Error for a distance that is NaN or not positive; for invalid
/// options, fields and weights; and, by the exact criteria, where pupil_boundary does and for an entrance pupil at
/// infinity. Accuracy: paraxial and thin within rounding; by the exact criteria the film is that of infinitely many
/// rays within 1e-5 mm on the axis and 2e-4 mm off it (double Gauss 100 mm f/2, 10 degrees).
PETZVAL_API FocusSolution solve_focus(const Lens& lens, double distance, const FocusOptions& options = {});

/// The inverse: the subject that is in focus on a film. Focused at the distance of the solution, the film is the same
/// within 4 eps of its position (1e-13 by the exact criteria), except if the distance counts from the film and lies
/// nearer than the turning point. Throws Error for a film_z that is not finite, and where solve_focus does.
PETZVAL_API FocusSolution solve_subject(const Lens& lens, double film_z, const FocusOptions& options = {});

/// The nearest subject that solve_focus reaches, as a limit: its distance itself may be out of reach.
PETZVAL_API FocusSolution nearest_focus(const Lens& lens, const FocusOptions& options = {});

/// The lens in focus at a distance. If its groups move (Lens::focus_positions), they stand where the subject is sharp
/// on the film, which keeps its place behind them: where the table says, but for what the criterion of focus differs
/// from that of the table. Otherwise its film is where solve_focus puts it: by default, where a subject on the axis is
/// sharpest. A camera of
/// it, by whatever ray model, is sharpest there too, within the depth over which the RMS blur grows by 5 %
/// (tests/camera/focus_test.cpp). A stop moves the sharpest film of a lens with spherical aberration: set the f-number
/// first. Throws Error, which names the nearest distance, if there is no focus; groups move beyond either
/// end of their way by the length of the way at most.
PETZVAL_API Lens with_focus(const Lens& lens, double distance, const FocusOptions& options = {});

/// Diameter of the blur (circle of confusion) of a subject on the film of the lens, as the criterion measures it. For
/// several fields: the root of the weighted mean square (min_rms), or the largest weighted diameter, with the largest
/// weight as 1 (min_max).
///
/// thin, paraxial: D f |U - Uf| / (U (Uf - f)) and its thick counterpart, with the pupil of the marked stop, else of
/// the rim that limits the axial beam. Nothing if no ray passes, and for an afocal lens. Throws Error where solve_focus
/// does, for a subject that is not in front of the lens, and if nothing limits the beam.
PETZVAL_API std::optional<double> blur_diameter(const Lens& lens, double distance, const FocusOptions& options = {});

/// Distances of the nearest and the farthest subject whose blur on the film of the lens does not exceed a diameter. The
/// farthest may be infinite.
struct DepthOfField {
  FocusStatus status = FocusStatus::solved;
  double near_distance = 0;  ///< from the origin of the options, mm
  double far_distance = 0;

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Depth of field about the subject that is in focus on the film of the lens; if there is none, about the one that
/// comes nearest to it (infinity for a film too far in). The blur at the limits is blur_mm within 1e-9 of it, except
/// where the near limit is the front of the lens. Throws Error for a blur_mm that is not a positive length, and where
/// blur_diameter does.
PETZVAL_API DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// The nearest subject to focus at with infinity blurred by no more than blur_mm, and its film. For a stop of radius 0
/// (paraxially) nearest_focus(). Throws Error where depth_of_field does.
PETZVAL_API FocusSolution hyperfocal(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// Focus breathing: the relative growth of the image from the film of infinity focus to one at film_z, by the paraxial
/// chief ray through the exit pupil. 0 for lenses telecentric in image space. Nothing if infinity is not in focus on
/// any film, or if that film lies in the exit pupil.
PETZVAL_API std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options = {});

}  // namespace petzval
