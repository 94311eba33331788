// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/plane.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/pupils.hpp"

namespace petzval::inline v0 {

/// A point of the scene, or a direction to one at infinity.
struct ScenePoint {
  Vec3<double> position{0, 0, 0};  ///< lens frame, mm; at infinity: the direction towards it, of any length
  bool at_infinity = false;
};

/// What a lens makes of a scene point: its image, the chief ray through that, and the cone of light about it. Lens
/// frame, mm.
struct ImagePoint {
  Vec3<double> position{0, 0, 0};
  double slope_x = 0, slope_y = 0;  ///< of the chief ray, per mm of z
  double cone = 0;                  ///< diameter of the beam, across the axis, per mm of z away from the image; > 0
};

/// A lens that images points into points, planes into planes: thin, or the cardinal points and pupils of a real one.
/// Light runs towards +z. Lens frame, mm.
struct PETZVAL_API IdealLens {
  double front_focal_z = 0, rear_focal_z = 0;
  double front_focal_length = 0, rear_focal_length = 0;  ///< n / power and n' / power; equal in air; may be negative
  Pupils pupils;
  double front_z = 0;  ///< points of the scene lie before it: the first vertex, or the thin lens itself
  double rear_z = 0;   ///< films lie behind it: the last vertex, or the thin lens itself

  double front_principal_z() const noexcept { return front_focal_z + front_focal_length; }
  double rear_principal_z() const noexcept { return rear_focal_z - rear_focal_length; }

  /// The image of a place. Nothing for places that are not in front of the lens and of its front focal plane (no real
  /// image), and for coordinates that are not finite (but z = -inf with a finite x and y: at infinity on the axis).
  std::optional<ImagePoint> image(const ScenePoint& place) const noexcept;
  /// The place whose image lies there; at infinity for a point of the rear focal plane, behind the front focal plane
  /// (virtual) for one before that.
  ScenePoint scene_of(const Vec3<double>& image) const noexcept;

  /// How much larger images are on a film at film_z than at another place, as a fraction, by the chief ray through the
  /// exit pupil: 0 for a telecentric lens, NaN for a film that stood in the exit pupil.
  double growth(double film_z, double before) const noexcept;

  /// The plane in which the points of a scene plane are imaged, and back: Scheimpflug's. Nothing where that is the
  /// plane at infinity.
  std::optional<Plane> image_of(const Plane& scene) const noexcept;
  std::optional<Plane> scene_of(const Plane& film) const noexcept;
};

/// Throws Error unless focal_length is finite and not 0, f_number > 0 (may be infinite: no blur) and z finite.
PETZVAL_API IdealLens thin_lens(double focal_length, double f_number, double z = 0);
/// The thin lens in place of a real one: same focal lengths, all at the rear principal plane, which becomes the pupil
/// too, as wide as the entrance pupil (as FocusCriterion::thin has it). Throws Error for an afocal lens, one that light
/// leaves towards -z, and where pupils() does.
PETZVAL_API IdealLens thin_lens(const Lens& lens, Wavelength wavelength = {});
/// Cardinal points and paraxial pupils. Throws Error as thin_lens; for a lens with cylinders it is that of the main
/// meridian.
PETZVAL_API IdealLens thick_lens(const Lens& lens, Wavelength wavelength = {});

/// Diameter of the blur of an image point on a film, across the axis where the chief ray meets the film: negative in
/// front of the plane of focus (its image lies behind the film), positive beyond it. Infinite for a chief ray along the
/// film. Throws Error, as chief_point() and focus_plane(), for a film without a place.
PETZVAL_API double signed_blur(const ImagePoint& image, const Film& film);
/// Where the chief ray of an image point meets a film. Nothing for one along the film.
PETZVAL_API std::optional<FilmPoint> chief_point(const ImagePoint& image, const Film& film);

/// What of the scene is in focus on a film, and the two lines about which it turns: the hinge line, in the front focal
/// plane, when the film moves along the axis, Scheimpflug's, in the front principal plane, when the film turns about
/// the line that is conjugate to it. No lines for an upright film.
struct FocusPlane {
  Plane plane;  ///< normal.z >= 0
  std::optional<SpaceLine> hinge, scheimpflug;
};
/// Nothing for a film whose plane of focus is at infinity.
PETZVAL_API std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film);

}  // namespace petzval::inline v0
