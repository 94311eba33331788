// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

// | f-number | beam | header |
// |---|---|---|
// | paraxial_f_number() | first order: focal length by entrance pupil | paraxial/first_order.hpp |
// | film_side_f_number() | first order: exit pupil to film by exit pupil | paraxial/first_order.hpp |
// | real_f_number() | exact ray at the rim of the stop; the number of with_f_number() | this |
// | fastest_f_number() | the same, wide open | this |
// | equal_area_f_number() | for with_f_number(): an iris with blades has the area of a round one | iris/iris.hpp |
// | area_f_number() | area of the exact pupil: with blades and obscurations | analysis/transmittance.hpp |
// | ApertureState::t_number | area_f_number() with losses | analysis/transmittance.hpp |

namespace petzval {

/// f-number |EFL| / (2 y), with the entrance height y of the axis-parallel ray that meets the rim of the stop.
///
/// The ray is traced exactly, in the main meridian, from the front to the stop, without clear apertures. If no ray
/// reaches the rim, y is the height of the last ray that reaches the stop. Infinite if the lens is afocal or the stop
/// has radius 0; 0 if y has no limit.
///
/// @throws Error  if pupils() does
PETZVAL_API double real_f_number(const Lens& lens, Wavelength wavelength = {});

/// f-number of the widest axial beam: the limit of with_f_number().
///
/// It equals real_f_number() if the stop has a rim. If the marked stop has no rim, the last axis-parallel ray that
/// reaches the stop sets the limit; 0 if every ray reaches the stop.
///
/// @throws Error  if the lens is afocal or no surface limits the axial beam
PETZVAL_API double fastest_f_number(const Lens& lens, Wavelength wavelength = {});

/// The lens stopped down to the f-number N.
///
/// The axis-parallel ray of height |EFL| / (2 N) meets the new rim of the stop; a marked stop without a rim gets a rim.
/// The lens stays wide open if N is too fast by up to 0.5 % (1e-9 if the marked stop has no rim), because declared
/// f-numbers are rounded; real_f_number() gives the exact value.
///
/// @throws Error  if N is faster than that (fastest_f_number() gives the limit), not positive or not finite; if the
///                lens is afocal or transmits no axial beam; if N is so slow that a central obscuration covers the
///                axial beam; or if no stop gives N, because spherical aberration folds the beam
///
/// Accuracy: real_f_number() returns N within 1e-12.
PETZVAL_API Lens with_f_number(const Lens& lens, double f_number, Wavelength wavelength = {});

}  // namespace petzval
