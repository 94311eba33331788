// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/pupil/aim.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval::pupil_detail {

/// Aims a ray from the scene or film point of a plane at a point on the stop. `end` lies behind the opposite side of
/// the lens.
PETZVAL_API AimedRay aim(const Lens& lens, const PupilPlane& plane, const Vec2<double>& target, Wavelength wavelength);

}  // namespace petzval::pupil_detail
