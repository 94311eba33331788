// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

/// A point of the scene, or the direction towards a point at infinity.
struct ScenePoint {
  Vec3<double> position{0, 0, 0};  ///< lens frame, mm; for a point at infinity, a direction of any length
  bool at_infinity = false;
};

/// The image of a scene point with its chief ray and its beam. Lens frame, mm.
struct ImagePoint {
  Vec3<double> position{0, 0, 0};
  double slope_x = 0, slope_y = 0;  ///< slope of the chief ray, per mm of z
  /// Growth of the beam diameter perpendicular to the axis, per mm of z from the image; >= 0
  double diameter_per_mm = 0;
};

/// A lens that images points to points and planes to planes. Lens frame, mm.
///
/// It is a thin lens, or a lens reduced to its cardinal points and pupils. Light enters along +z. If the focal lengths
/// differ in sign, light leaves along -z, after an odd number of mirrors. All results are computed from the focal
/// points (Newton's form), which is also valid at infinity: an axial object at front_focal_z - p has its image at
/// rear_focal_z + product() / p.
struct PETZVAL_API IdealLens {
  double front_focal_z = 0, rear_focal_z = 0;
  double front_focal_length = 0, rear_focal_length = 0;  ///< n / power and n' / power; equal in air; may be negative
  Pupils pupils;
  double front_z = 0;  ///< the first vertex, or the thin lens; scene points lie in front
  double rear_z = 0;   ///< the last vertex, or the thin lens; films lie behind

  double front_principal_z() const noexcept { return front_focal_z + front_focal_length; }
  double rear_principal_z() const noexcept { return rear_focal_z - rear_focal_length; }
  /// Newton's constant n n' / power^2; negative if light leaves along -z.
  double product() const noexcept { return front_focal_length * rear_focal_length; }

  /// Distance from the front focal point to the axial object that lies `separation` in front of its image (mm).
  ///
  /// If there are two such objects, the result is for the farther one. A separation below the smallest possible
  /// distance of object and image counts as the smallest distance. No digits are lost near the smallest distance.
  double object_at_separation(double separation) const noexcept;

  /// The image of a scene point; nullopt if the point has no real image.
  ///
  /// A point has a real image if it lies in front of the lens and of the front focal plane. Coordinates must be finite,
  /// except that z = -inf with finite x and y is the point at infinity on the axis; other values give nullopt.
  std::optional<ImagePoint> image(const ScenePoint& point) const noexcept;
  /// The scene point with its image at a position (lens frame, mm).
  ///
  /// The scene point is at infinity if the position is in the rear focal plane. It is virtual, behind the front focal
  /// plane, if the position is in front of the rear focal plane.
  ScenePoint scene_of(const Vec3<double>& image) const noexcept;

  /// Relative growth of the image if the film moves from z = `before` to film_z.
  ///
  /// The image grows along the chief ray through the exit pupil: 0 for a lens telecentric in image space; NaN if
  /// `before` lies in the exit pupil.
  double magnification_change(double film_z, double before) const noexcept;

  /// The image of a scene plane, and the scene plane that is imaged to a film plane (Scheimpflug).
  ///
  /// nullopt if the result is the plane at infinity.
  std::optional<Plane> image_of(const Plane& scene) const noexcept;
  std::optional<Plane> scene_of(const Plane& film) const noexcept;
};

/// A thin lens in air.
///
/// @param focal_length  focal length (mm)
/// @param f_number      f-number; infinite for a lens without blur
/// @param z             position on the axis (lens frame, mm)
/// @throws Error unless `focal_length` is finite and not 0, `f_number` is positive and `z` is finite
PETZVAL_API IdealLens thin_lens(double focal_length, double f_number, double z = 0);
/// Two elements of N-BK7 without thickness, whose first-order model is a thin lens in air, for functions that need a
/// Lens: compiled, they have the focal length at the d line and the stop on the first surface.
///
/// The semi-diameter of the stop is limited to 1.86 focal lengths (f/0.27), where the surfaces end.
///
/// @throws Error unless `focal_length` and `f_number` are positive and finite
PETZVAL_API Prescription thin_elements(double focal_length, double f_number);
/// The thin equivalent of a lens, as used by FocusCriterion::thin.
///
/// It has the focal lengths and the rear focal point of `lens`, and lies at its rear principal plane, with a pupil as
/// wide as the entrance pupil.
PETZVAL_API IdealLens thin_lens(const IdealLens& lens);
/// The thin equivalent of thick_lens(lens, wavelength).
///
/// @throws Error if thick_lens() throws
PETZVAL_API IdealLens thin_lens(const Lens& lens, Wavelength wavelength = {});
/// The cardinal points and paraxial pupils of a lens, in the main meridian.
///
/// @throws Error if the lens is afocal, if light leaves the lens along -z, or if pupils() throws
PETZVAL_API IdealLens thick_lens(const Lens& lens, Wavelength wavelength = {});

/// The height of an upright film, at the film position of a lens, that shows a vertical angle (mm).
///
/// @param lens                the lens, focused
/// @param vertical_angle_rad  angle between the chief rays of the upper and the lower edge, at the entrance pupil
/// @throws Error unless the angle is in (0, pi); if thick_lens() throws
PETZVAL_API double film_height_for_angle(const Lens& lens, double vertical_angle_rad);

/// Signed blur diameter of an image point on a film (mm).
///
/// The diameter is measured perpendicular to the axis, where the chief ray meets the film. Negative for subjects in
/// front of the plane of focus (the image lies behind the film), positive for subjects beyond the plane. Infinite if
/// the chief ray is parallel to the film.
///
/// @throws Error if film.z_mm is not set
PETZVAL_API double signed_blur(const ImagePoint& image, const Film& film);
/// The film point of the chief ray of an image point; nullopt if the chief ray is parallel to the film.
///
/// @throws Error if film.z_mm is not set
PETZVAL_API std::optional<FilmPoint> chief_point(const ImagePoint& image, const Film& film);

// The thin lens in closed form, accurate at infinity and near the focus.

/// Blur diameter (circle of confusion) c = D f |U - Uf| / (U (Uf - f)) of a thin lens (mm).
///
/// @param focal_length  f (mm)
/// @param diameter      diameter D of the lens (mm)
/// @param subject       distance U from lens to subject (mm); may be infinite
/// @param focused       distance Uf from lens to the plane of focus (mm); may be infinite
/// @throws Error unless U > 0, Uf > f > 0 and D >= 0
///
/// Accuracy: within 4 eps, also at infinity, for Uf near f and for U near Uf.
/// Source: Wu et al. 2010, equation 1.
PETZVAL_API double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused);

/// Distance from the focal point to the image of a subject at distance U: f (f / (U - f)), 0 for infinity (mm).
///
/// @throws Error unless U > f > 0
///
/// Accuracy: within 4 eps.
PETZVAL_API double thin_lens_extension(double focal_length, double subject);

/// Distance from the lens to the subject in focus on a film at distance e behind the focal point: f + f (f / e) (mm).
///
/// Infinite for e = 0. The inverse of thin_lens_extension().
///
/// @throws Error unless e >= 0 and f > 0
///
/// Accuracy: within 4 eps.
PETZVAL_API double thin_lens_subject(double focal_length, double extension);

/// Distance from the lens to the film for a distance T from subject to film: 2 f T / (T + sqrt(T (T - 4 f))) (mm).
///
/// The smaller of the two solutions; f for infinity.
///
/// @throws Error unless T >= 4 f > 0
///
/// Accuracy: within 8 eps for T >= 4.001 f; nearer to 4 f the condition of the root, T / (T - 4 f), adds to the error.
PETZVAL_API double thin_lens_film_distance(double focal_length, double subject_to_film);

}  // namespace petzval
