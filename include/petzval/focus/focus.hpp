// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// The definition of "in focus" and of a blur diameter.
enum class FocusCriterion : std::uint8_t {
  thin,      ///< thin lens of the same focal length at the rear principal plane, as wide as the entrance pupil
  paraxial,  ///< thick lens: the cardinal points, and the cone of the paraxial pupil
  min_rms,   ///< exact rays: least RMS radius; blur diameter of the uniform disc with the same RMS radius
  min_max,   ///< exact rays: smallest maximum radius; blur diameter is twice the maximum radius
};

/// The origin of subject distances. Distances are positive towards the scene and may be infinite.
enum class DistanceOrigin : std::uint8_t {
  front_vertex,
  film,             ///< the film of the solution, as engraved on lens barrels
  entrance_pupil,   ///< paraxial; the viewpoint of a camera
  front_principal,  ///< paraxial; of the thick lens, even for FocusCriterion::thin
};

/// The result of a focus computation, of autofocus() or of fit_tilt(), or the reason for its failure.
enum class FocusStatus : std::uint8_t {
  solved,
  least_tilt,     ///< fit_tilt(): the targets do not determine a plane (TiltFit::rank); the best plane of least tilt
  limited,        ///< fit_tilt(): the tilt is at its limit; the best film within the limit
  unreachable,    ///< no real image: the subject is too near, or the film is too close to the lens or would touch it
  no_rays,        ///< exact criteria: for some field, no ray passes the lens
  afocal,         ///< the lens has no focal length
  too_blurred,    ///< depth of field, hyperfocal distance: even the sharpest subject exceeds the blur
  no_targets,     ///< autofocus(), fit_tilt(): no target is usable
  not_converged,  ///< fit_tilt()
};

/// The name of a value: "thin", ...; "front_vertex", ...; "solved", ...
PETZVAL_API std::string_view name(FocusCriterion criterion) noexcept;
PETZVAL_API std::string_view name(DistanceOrigin origin) noexcept;
PETZVAL_API std::string_view name(FocusStatus status) noexcept;

/// Position of the origin of subject distances (z in the lens frame, mm).
///
/// The film is the current film of the lens; paraxial planes are computed at the primary wavelength in the main
/// meridian.
///
/// @throws Error for the entrance pupil, if it is at infinity or no surface limits the beam; for the front principal
///               plane, if the lens is afocal
PETZVAL_API double origin_z(const Lens& lens, DistanceOrigin origin);

/// A field and its weight in the focus criterion.
///
/// The subjects of all fields lie in one plane perpendicular to the axis.
struct FocusField {
  double field_rad = 0;  ///< field angle at the entrance pupil, as in FieldPoint
  double weight = 1;
};

/// Criterion, origin of distances, fields and wavelengths of a focus computation.
struct FocusOptions {
  /// The default agrees with cameras: every ray model is sharpest at the distance of min_rms. A lens with its entrance
  /// pupil at infinity requires `paraxial` or `thin`.
  FocusCriterion criterion = FocusCriterion::min_rms;
  DistanceOrigin origin = DistanceOrigin::front_vertex;
  /// min_rms weights the squared RMS radii, each about the centroid of its field; min_max takes the maximum of the
  /// weighted radii; thin and paraxial use the axis only.
  std::vector<FocusField> fields = {FocusField{}};
  /// Spectral weight of each compiled wavelength; empty for the primary wavelength only. min_max uses all wavelengths
  /// with a positive weight. thin, paraxial and front_principal use the wavelength of largest weight, the primary
  /// wavelength if weights are equal.
  std::vector<double> wavelength_weights = {};
};

/// A subject and the film that is conjugate to its plane.
///
/// If the request is unreachable, the values are the nearest possible pair: infinity if the film is too close to the
/// lens; the nearest subject if the subject is too near, with its film at infinity or, for distances from the film, at
/// the minimum distance. All values are infinite if the lens forms no real image.
struct FocusSolution {
  FocusStatus status = FocusStatus::solved;
  double film_z = 0;     ///< lens frame, mm
  double subject_z = 0;  ///< lens frame, mm; -inf at infinity
  double distance = 0;   ///< from FocusOptions::origin to the subject, mm

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Finds the film position that brings a subject into focus. The lens stays, the film moves.
///
/// min_rms is solved in closed form from ray bundles that fill the clipped pupil, uniformly in the area of the entrance
/// pupil. min_max adds the edges and corners of the pupil. Both films lie behind the last vertex.
///
/// @param lens      the lens
/// @param distance  subject distance from options.origin (mm); positive, may be infinite. If two film positions serve a
///                  distance from the film, the result is the position nearer to the rear focal point.
/// @param options   criterion, origin, fields and wavelengths
/// @return          the film position, or a status that tells why there is no solution
/// @throws Error    if `distance` is NaN or not positive, or if options are invalid; for exact criteria, also if the
///                  entrance pupil is at infinity or scene_point() throws
///
/// Accuracy: thin and paraxial to rounding. Exact criteria within 1e-5 mm of infinitely many rays on the axis and 2e-4
/// mm off axis (double Gauss 100 mm f/2, 10 degrees). The maximum radius of min_max is within 0.2 %.
///
/// Limitations: a lens with cylinders is focused in its main meridian by the paraxial criteria, and over all azimuths
/// by the exact criteria. If one section has little power, the film of least RMS radius turns back towards the lens as
/// the subject approaches; nearer subjects are unreachable.
PETZVAL_API FocusSolution solve_focus(const Lens& lens, double distance, const FocusOptions& options = {});

/// Finds the subject that is in focus on a film, the inverse of solve_focus().
///
/// @param lens     the lens
/// @param film_z   position of the film (lens frame, mm)
/// @param options  as for solve_focus()
/// @throws Error   if `film_z` is not finite, or if solve_focus() throws
///
/// Accuracy: solve_focus() at the resulting distance returns film_z with a relative error of 4 eps (1e-13 for exact
/// criteria), unless the distance is measured from the film and the subject is nearer than at the minimum of this
/// distance.
PETZVAL_API FocusSolution solve_subject(const Lens& lens, double film_z, const FocusOptions& options = {});

/// The limit of the subjects that solve_focus() can reach at near distances. The limit itself may be unreachable.
PETZVAL_API FocusSolution nearest_focus(const Lens& lens, const FocusOptions& options = {});

/// The lens, focused at a distance.
///
/// If the lens has moving groups (Lens::focus_positions()), the groups are set so that the subject is sharp on the film
/// at its tabulated distance from the last group. They may differ from their tabulated positions if the table uses
/// another focus criterion. Otherwise the film moves to the position of solve_focus().
///
/// Set the f-number first: stopping down a lens with spherical aberration shifts its sharpest film.
///
/// @param lens      the lens
/// @param distance  subject distance from options.origin (mm); positive, may be infinite
/// @param options   as for solve_focus()
/// @throws Error    with the nearest distance if the subject cannot be focused; groups move beyond each end of their
///                  tabulated range by at most the length of the range
///
/// Accuracy: cameras of all ray models are sharpest at this distance, within the depth over which the RMS blur grows by
/// 5 % (tests/camera/focus_test.cpp).
PETZVAL_API Lens with_focus(const Lens& lens, double distance, const FocusOptions& options = {});

/// Blur diameter (circle of confusion) of a subject on the film of the lens (mm).
///
/// For several fields, min_rms gives the root of the weighted mean square, and min_max the largest weighted diameter,
/// with the largest weight as 1. The paraxial criteria use D f |U - Uf| / (U (Uf - f)) and its counterpart for a thick
/// lens, with the pupil of the marked stop, else of the rim that limits the axial beam.
///
/// @param lens      the lens
/// @param distance  subject distance from options.origin (mm); positive, may be infinite
/// @param options   as for solve_focus()
/// @return          the diameter; nullopt if no ray passes or the lens is afocal
/// @throws Error    if solve_focus() throws, if the subject is not in front of the lens, or if no surface limits
///                  the beam
PETZVAL_API std::optional<double> blur_diameter(const Lens& lens, double distance, const FocusOptions& options = {});

/// The range of subject distances with a blur up to a given diameter.
struct DepthOfField {
  FocusStatus status = FocusStatus::solved;
  double near_distance = 0;  ///< from FocusOptions::origin, mm
  double far_distance = 0;   ///< from FocusOptions::origin, mm; may be infinite

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Depth of field around the subject that is in focus on the film of the lens.
///
/// If no subject is in focus, the depth of field is around the nearest possible subject: infinity if the film is too
/// close to the lens.
///
/// @param lens     the lens
/// @param blur_mm  largest blur diameter (mm)
/// @param options  as for solve_focus()
/// @throws Error   if `blur_mm` is not finite and positive, or if blur_diameter() throws
///
/// Accuracy: the blur at the limits is blur_mm to a relative 1e-9, unless the near limit is the front of the lens.
PETZVAL_API DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// The nearest subject to focus at so that infinity is blurred by at most `blur_mm`, and its film.
///
/// For a stop of radius 0 (paraxial criteria), the result of nearest_focus().
///
/// @throws Error if depth_of_field() throws
PETZVAL_API FocusSolution hyperfocal(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// Focus breathing: relative growth of the image from the film for infinity to a film at `film_z`.
///
/// The image grows along the paraxial chief ray through the exit pupil; 0 for a lens telecentric in image space.
///
/// @return  the growth; nullopt if no film focuses infinity, or if this film lies in the exit pupil
/// @throws Error if solve_subject() throws
PETZVAL_API std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options = {});

/// The plane of focus of a film, and the two lines about which the plane rotates.
struct FocusPlane {
  Plane plane;  ///< normal.z >= 0
  /// The plane rotates about `hinge`, in the front focal plane, if the film moves along the axis, and about
  /// `scheimpflug`, in the front principal plane, if the film rotates about the conjugate line. Both are nullopt for an
  /// upright film.
  std::optional<Line3> hinge, scheimpflug;
};
/// The plane of focus of a film; nullopt if the plane is at infinity.
///
/// @throws Error if film.z_mm is not set
PETZVAL_API std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film);

}  // namespace petzval
