// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// |EFL| / (2 y), y the height of the axis-parallel ray (in the main meridian) whose exact trace meets the rim of the
/// stop; the ray is traced through the front part alone, whatever clips it elsewhere. Where rays end before they get as
/// high as the rim, y is the height of the last that reaches the stop. Infinite for an afocal lens or an empty stop, 0
/// where nothing limits y. Throws Error where pupils() does.
PETZVAL_API double real_f_number(const Lens& lens, Wavelength wavelength = {});

/// f-number of the widest axial beam, below which with_f_number() refuses: real_f_number() if the stop has a rim. If
/// the marked stop has no rim, the last axis-parallel ray that reaches the stop sets the limit, 0 if there is no last
/// ray.
///
/// @throws Error  if the lens is afocal or nothing limits the axial beam
PETZVAL_API double fastest_f_number(const Lens& lens, Wavelength wavelength = {});

/// The lens stopped down to an f-number (real_f_number, by exact rays): the stop gets the semi-diameter at which the
/// axis-parallel ray of height |EFL| / (2 N) passes it, so that real_f_number gives N back within 1e-12. A marked stop
/// without a rim gets one.
///
/// For N faster than wide open by up to 0.5 % the lens stays wide open, as it is: declared f-numbers are rounded, and
/// real_f_number tells the true one. Throws Error for N faster than that, naming the fastest possible (a program that
/// takes the f-number of the lens's name can ask fastest_f_number() first), for N <= 0 or
/// not finite, an afocal lens, N so slow that a central obscuration leaves nothing of the axial beam, naming the
/// surface and the f-number of the obscuration, and N that no stop gives, as spherical aberration folds the beam there.
PETZVAL_API Lens with_f_number(const Lens& lens, double f_number, Wavelength wavelength = {});

}  // namespace petzval
