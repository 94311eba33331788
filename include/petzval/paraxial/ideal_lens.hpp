// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

/// A point of the scene, or a direction to one at infinity.
struct ScenePoint {
  Vec3<double> position{0, 0, 0};  ///< lens frame, mm; at infinity: the direction towards it, of any length
  bool at_infinity = false;
};

/// The image of a scene point with its chief ray and the beam about it. Lens frame, mm.
struct ImagePoint {
  Vec3<double> position{0, 0, 0};
  double slope_x = 0, slope_y = 0;  ///< of the chief ray, per mm of z
  double cone = 0;                  ///< diameter of the beam, across the axis, per mm of z away from the image; > 0
};

/// The marginal ray of an axial point behind a lens.
struct MarginalRay {
  double height = 0;  ///< in the rear focal plane, mm
  double slope = 0;   ///< per mm of z
};

/// A lens that images points into points and planes into planes: a thin lens, or the cardinal points and pupils of a
/// real one. Light comes along +z; where the focal lengths differ in sign (behind an odd number of mirrors) it leaves
/// along -z. Lens frame, mm.
///
/// Everything is computed from the focal points (Newton's form), which is safe for objects and images at infinity: an
/// axial object at front_focal_z - p has its image at rear_focal_z + product() / p.
struct PETZVAL_API IdealLens {
  double front_focal_z = 0, rear_focal_z = 0;
  double front_focal_length = 0, rear_focal_length = 0;  ///< n / power and n' / power; equal in air; may be negative
  Pupils pupils;
  double front_z = 0;  ///< scene points lie in front of it: the first vertex, or the thin lens
  double rear_z = 0;   ///< films lie behind it: the last vertex, or the thin lens

  double front_principal_z() const noexcept { return front_focal_z + front_focal_length; }
  double rear_principal_z() const noexcept { return rear_focal_z - rear_focal_length; }
  /// Newton's constant n n' / power^2; negative where light leaves along -z.
  double product() const noexcept { return front_focal_length * rear_focal_length; }

  /// How far in front of the front focal point an axial object is that lies `separation` in front of its image, of two
  /// such objects the farther one. Nothing is lost next to the turning point, at which object and image are as near to
  /// each other as they can be; for smaller separations the result is that of the turning point.
  double object_at_separation(double separation) const noexcept;

  /// The marginal ray of an axial object p in front of the front focal point; p may be infinite if the entrance pupil
  /// is at a finite place.
  MarginalRay marginal_ray(double p) const noexcept;

  /// The image of a scene point. Nothing for points that are not in front of the lens and of its front focal plane (no
  /// real image), and for coordinates that are not finite (except z = -inf with finite x and y: at infinity on the
  /// axis).
  std::optional<ImagePoint> image(const ScenePoint& point) const noexcept;
  /// The scene point that is imaged to a position: at infinity for a position in the rear focal plane, behind the front
  /// focal plane (virtual) for one in front of it.
  ScenePoint scene_of(const Vec3<double>& image) const noexcept;

  /// Relative growth of images from a film at z = `before` to one at film_z, by the chief ray through the exit pupil: 0
  /// for a lens telecentric in image space, NaN if the first film lies in the exit pupil.
  double growth(double film_z, double before) const noexcept;

  /// The image of a plane of the scene, and the plane of the scene that is imaged to a film: Scheimpflug's. Nothing for
  /// the plane at infinity.
  std::optional<Plane> image_of(const Plane& scene) const noexcept;
  std::optional<Plane> scene_of(const Plane& film) const noexcept;
};

/// A thin lens at z in air. Throws Error unless focal_length is finite and not 0, f_number > 0 (may be infinite: no
/// blur) and z finite.
PETZVAL_API IdealLens thin_lens(double focal_length, double f_number, double z = 0);
/// The thin lens in place of another: its focal lengths and its rear focal point, and at its rear principal plane the
/// lens with a pupil as wide as the entrance pupil (FocusCriterion::thin).
PETZVAL_API IdealLens thin_lens(const IdealLens& lens);
/// The thin lens in place of thick_lens(lens, wavelength), which may throw Error.
PETZVAL_API IdealLens thin_lens(const Lens& lens, Wavelength wavelength = {});
/// Cardinal points and paraxial pupils, in the main meridian. Throws Error for an afocal lens, one that light leaves
/// along -z, and where pupils() does.
PETZVAL_API IdealLens thick_lens(const Lens& lens, Wavelength wavelength = {});

/// Diameter of the blur of an image point on a film, across the axis where the chief ray meets the film: negative in
/// front of the plane of focus (the image lies behind the film), positive beyond it. Infinite for a chief ray along the
/// film. Throws Error, as chief_point(), for a film without a place.
PETZVAL_API double signed_blur(const ImagePoint& image, const Film& film);
/// Where the chief ray of an image point meets a film. Nothing for a chief ray along the film.
PETZVAL_API std::optional<FilmPoint> chief_point(const ImagePoint& image, const Film& film);

// The thin lens in closed form, safe at infinity and next to the focus. Lengths in mm.

/// Blur diameter (circle of confusion) c = D f |U - Uf| / (U (Uf - f)) of a thin lens of focal length f and diameter D
/// focused at Uf, for a subject at U. Distances count from the lens; both may be infinite. Within 4 eps, also at
/// infinity, for Uf next to f and for U next to Uf. Throws Error unless U > 0, Uf > f > 0 and D >= 0.
/// Source: Wu et al. 2010, equation 1.
PETZVAL_API double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused);

/// Distance from the focal point to the image of a subject at U: V - f = f (f / (U - f)), 0 for infinity. Within 4 eps.
/// Throws Error unless U > f > 0.
PETZVAL_API double thin_lens_extension(double focal_length, double subject);

/// The inverse: the distance U = f + f (f / e) from the lens of the subject in focus on a film e behind the focal
/// point; infinite for e = 0. Within 4 eps. Throws Error unless e >= 0 and f > 0.
PETZVAL_API double thin_lens_subject(double focal_length, double extension);

/// Distance from the lens to the film if film and subject are T apart: the smaller V = 2 f T / (T + sqrt(T (T - 4 f)))
/// of the two, and f for infinity. Within 8 eps for T >= 4.001 f; nearer to 4 f the condition of the root, T / (T - 4
/// f), adds to that. Throws Error unless T >= 4 f > 0.
PETZVAL_API double thin_lens_film_distance(double focal_length, double subject_to_film);

}  // namespace petzval
