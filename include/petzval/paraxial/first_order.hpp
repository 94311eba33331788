// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/version.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// A ray-transfer (ABCD) matrix on (y, n u): height in mm and optical direction, n the signed index (negative while
/// light runs backwards after a mirror). Its determinant is 1.
///
/// Maps between other pairs that describe a ray have the same form, with any determinant: height and slope, or the
/// points where a ray meets two planes.
struct RayMatrix {
  double a = 1, b = 0, c = 0, d = 1;  ///< b in mm, c in 1/mm

  /// The matrix of `*this` followed by `next`.
  constexpr RayMatrix then(const RayMatrix& next) const noexcept {
    return {next.a * a + next.b * c, next.a * b + next.b * d, next.c * a + next.d * c, next.c * b + next.d * d};
  }
  constexpr RayMatrix inverse() const noexcept {
    const double determinant = a * d - b * c;
    return {d / determinant, -b / determinant, -c / determinant, a / determinant};
  }
  /// The same section on height and slope, between media of index n_in and n_out (signed).
  constexpr RayMatrix on_slopes(double n_in, double n_out) const noexcept {
    return {a, b * n_in, c / n_out, d * n_in / n_out};
  }
  /// Light power of the section: the negative of c, in 1/mm.
  constexpr double power() const noexcept { return -c; }
};

/// The meridian in which a lens with cylinders is described; without cylinders both are the same.
enum class Meridian { y, x };

/// Index of the medium before surface `space`, negative where light runs backwards, after an odd number of mirrors.
PETZVAL_API double signed_index(const Lens& lens, std::size_t space, Wavelength wavelength = {});

/// From the vertex of surface `first` (before refraction) to that of surface `last - 1` (after it); `last` beyond the
/// end means the whole rest. Surfaces act by their curvature at the vertex: terms of order 2 add to it, cylinders
/// have none along x or y.
PETZVAL_API RayMatrix ray_matrix(const Lens& lens, std::size_t first, std::size_t last, Wavelength wavelength = {},
                                 Meridian meridian = Meridian::y);

/// From the first vertex (before refraction) to the vertex of `surface`, before refraction there too.
PETZVAL_API RayMatrix ray_matrix_to(const Lens& lens, std::size_t surface, Wavelength wavelength = {},
                                    Meridian meridian = Meridian::y);
/// The same for each surface, in time proportional to their number.
PETZVAL_API std::vector<RayMatrix> ray_matrices_to(const Lens& lens, Wavelength wavelength = {},
                                                   Meridian meridian = Meridian::y);

/// The first-order data of a lens: all z in the lens frame, lengths and distances signed, all in mm.
///
/// power = sum of h_i phi_i over the surfaces, h_i the height of a ray that enters parallel to the axis at height 1 and
/// phi_i the power of the surface. If it is less than 1e-12 of the sum of |h_i phi_i|, or less than 1e-100 / mm, the
/// lens is afocal: power is 0, the focal length infinite, and the focal, principal and nodal points are at infinity
/// (front -inf, rear +inf). So is a lens whose matrix leaves the range of double. Never NaN.
struct FirstOrder {
  bool afocal = false;
  double power = 0;                   ///< 1/mm, exactly 0 when afocal
  double effective_focal_length = 0;  ///< 1 / power
  double front_focal_z = 0;
  double rear_focal_z = 0;
  double front_principal_z = 0;
  double rear_principal_z = 0;
  double front_nodal_z = 0;
  double rear_nodal_z = 0;
  double front_focal_distance = 0;           ///< first vertex to front focal point, signed along z
  double back_focal_distance = 0;            ///< last vertex to rear focal point, signed along z
  double petzval_sum = 0;                    ///< sum of (n' - n) c / (n n'), 1/mm, signed indices at mirrors
  double object_index = 1, image_index = 1;  ///< signed
};

PETZVAL_API FirstOrder first_order(const Lens& lens, Wavelength wavelength = {}, Meridian meridian = Meridian::y);

/// The meridian that focal length, f-number and focus refer to: y, or x where a lens has power in x only.
PETZVAL_API Meridian main_meridian(const Lens& lens, Wavelength wavelength = {});

/// How much narrower an anamorphic lens makes its picture along x than along y: the focal length along y over that
/// along x. 1 for a lens of revolution. Infinite, 0 or not a number where a section has no power. desqueezed() in
/// io/image.hpp makes the picture right again.
PETZVAL_API double squeeze(const Lens& lens, Wavelength wavelength = {});

/// The paraxial image of an axial point (z in the lens frame, mm). object_z may be infinite; beyond 1e100 mm it counts
/// as infinite. The result is +inf for an object within a few ulp of the front focal point and for a distant one in
/// front of an afocal lens. NaN only for NaN.
PETZVAL_API double paraxial_image_z(const Lens& lens, double object_z, Wavelength wavelength = {},
                                    Meridian meridian = Meridian::y);

/// Focal length of a single lens element of index n in air: 1/f = (n-1) (c1 - c2 + (n-1) t c1 c2 / n), in curvatures,
/// so that planes and equal radii are no special case; in mm and 1/mm, or any other unit. t = 0 gives the thin lens.
/// Infinite if the power is 0.
PETZVAL_API double lensmaker_focal_length(double n, double c1, double c2, double thickness = 0) noexcept;

/// A paraxial pupil: the image of the aperture stop. z and diameter are infinite where the lens is telecentric on that
/// side.
struct Pupil {
  double z = 0;         ///< lens frame, mm
  double diameter = 0;  ///< mm
};

/// Entrance and exit pupil of a lens, and the surface that limits it.
struct Pupils {
  Pupil entrance;
  Pupil exit;
  std::size_t stop = 0;
  /// No surface is marked as stop, or the one that is has no rim, so that it stops no ray: `stop` is the first that
  /// clips the axial beam from infinity (paraxially).
  bool stop_inferred = false;
};

/// Whether any surface limits the beam. Without one there is no stop, and pupils() throws.
PETZVAL_API bool has_pupils(const Lens& lens) noexcept;

/// Throws Error if no surface limits the axial beam.
PETZVAL_API Pupils pupils(const Lens& lens, Wavelength wavelength = {}, Meridian meridian = Meridian::y);

/// |EFL| / entrance pupil diameter, in the main meridian. Infinite for an afocal lens or an empty pupil.
PETZVAL_API double paraxial_f_number(const Lens& lens, Wavelength wavelength = {});

/// The f-number of the cone of light on the lens's film: distance of the exit pupil from the film over its diameter.
/// Infinite for an empty pupil.
PETZVAL_API double film_side_f_number(const Lens& lens, Wavelength wavelength = {});

}  // namespace petzval
