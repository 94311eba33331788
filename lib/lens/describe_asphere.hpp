// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/lens/lens.hpp"
#include "surface/asphere.hpp"

namespace petzval::inline v0::lens_detail {

kernel::Quadric<double> describe_quadric(const LensSurface& surface);

/// The shape of a surface with aspheric terms, with bounds of its rings.
kernel::Asphere<double> describe_asphere(const LensSurface& surface);

}  // namespace petzval::inline v0::lens_detail
