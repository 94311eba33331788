// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval::pupil_detail {

/// `aim` for the point of a plane, of the scene or the film: the ray runs from it to the stop, and `end` lies beyond
/// the other side of the lens.
PETZVAL_API AimedRay aim(const Lens& lens, const PupilPlane& plane, const StopPoint& target, Wavelength wavelength);

}  // namespace petzval::pupil_detail
