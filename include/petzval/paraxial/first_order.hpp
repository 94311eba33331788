// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// The meridian in which a lens with cylinders is described. Without cylinders both meridians are equal.
enum class Meridian { y, x };

/// Signed index of the medium before surface `space`: negative if light runs backwards, after an odd number of mirrors.
PETZVAL_API double signed_index(const Lens& lens, std::size_t space, Wavelength wavelength = {});

/// The first-order data of a lens. All z are in the lens frame; lengths are signed and in mm.
///
/// The power is the sum of h_i phi_i over the surfaces, with h_i the height of a ray that enters parallel to the axis
/// at height 1, and phi_i the power of the surface. The lens is afocal if |power| is below 1e-12 times the sum of
/// |h_i phi_i|, if it is below 1e-100 / mm, or if the matrix of the lens exceeds the range of double. The power of an
/// afocal lens is 0, its focal length is infinite, and its focal, principal and nodal points are at infinity (front
/// -inf, rear +inf). No value is NaN.
struct FirstOrder {
  bool afocal = false;
  double power = 0;                   ///< 1/mm; exactly 0 if afocal
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

/// The first-order data of a lens at a wavelength, in one meridian.
PETZVAL_API FirstOrder first_order(const Lens& lens, Wavelength wavelength = {}, Meridian meridian = Meridian::y);

/// The meridian of focal length, f-number and focus: y, or x if the lens has power in x only.
PETZVAL_API Meridian main_meridian(const Lens& lens, Wavelength wavelength = {});

/// Anamorphic squeeze: the focal length in y divided by the focal length in x.
///
/// The picture is narrower along x by this factor; desqueezed() in image/image.hpp restores the proportions. 1 for a
/// lens of revolution; infinite, 0 or NaN if a section has no power.
PETZVAL_API double squeeze(const Lens& lens, Wavelength wavelength = {});

/// The paraxial image of a point on the axis (z in the lens frame, mm).
///
/// @param lens        the lens
/// @param object_z    z of the object (mm); counts as infinite beyond 1e100 mm
/// @param wavelength  the wavelength
/// @param meridian    the meridian
/// @return            z of the image; +inf if the object is within a few ulp of the front focal point, or at infinity
///                    in front of an afocal lens; NaN only if `object_z` is NaN
PETZVAL_API double paraxial_image_z(const Lens& lens, double object_z, Wavelength wavelength = {},
                                    Meridian meridian = Meridian::y);

/// Focal length of a single lens element in air: 1/f = (n-1) (c1 - c2 + (n-1) t c1 c2 / n).
///
/// @param n          index of the element
/// @param c1,c2      curvatures of its surfaces (1/mm, or the inverse of any unit); 0 for a plane
/// @param thickness  distance t of its vertices, in the same unit; 0 for a thin lens
/// @return           the focal length in the same unit; infinite if the power is 0
PETZVAL_API double lensmaker_focal_length(double n, double c1, double c2, double thickness = 0) noexcept;

/// A paraxial pupil: the image of the aperture stop.
///
/// z and diameter are infinite if the lens is telecentric on this side.
struct Pupil {
  double z = 0;         ///< lens frame, mm
  double diameter = 0;  ///< mm
};

/// Entrance pupil, exit pupil and stop of a lens.
struct Pupils {
  Pupil entrance;
  Pupil exit;
  std::size_t stop = 0;  ///< the marked stop, or the inferred stop
  /// True if no surface is marked as stop or the marked surface has no rim. `stop` is then the surface that clips the
  /// paraxial axial beam from infinity first.
  bool stop_inferred = false;
};

/// True if at least one surface has a finite semi-diameter. Otherwise the lens has no stop, and pupils() throws.
PETZVAL_API bool has_pupils(const Lens& lens) noexcept;

/// The paraxial pupils of a lens at a wavelength, in one meridian.
///
/// @throws Error if no surface limits the axial beam
PETZVAL_API Pupils pupils(const Lens& lens, Wavelength wavelength = {}, Meridian meridian = Meridian::y);

/// Paraxial f-number in the main meridian: |focal length| / entrance pupil diameter.
///
/// Infinite for an afocal lens or an empty pupil.
///
/// @throws Error if pupils() throws
PETZVAL_API double paraxial_f_number(const Lens& lens, Wavelength wavelength = {});

/// Working f-number on the film of the lens: the distance from exit pupil to film divided by the exit pupil diameter.
///
/// Infinite for an empty pupil. Equal to paraxial_f_number() if the exit pupil is at infinity.
///
/// @throws Error if pupils() throws
PETZVAL_API double film_side_f_number(const Lens& lens, Wavelength wavelength = {});

}  // namespace petzval
