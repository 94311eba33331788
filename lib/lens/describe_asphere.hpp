// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lens/asphere.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

kernel::Quadric<double> describe_quadric(const LensSurface& surface);

/// Height up to which an asphere is described: its semi-diameter, its equator or a slope of 4, whichever is smallest.
double described_height(const LensSurface& surface);

/// The shapes of all surfaces with aspheric terms, with the bounds over their rings.
std::vector<kernel::Asphere<double>> describe_aspheres(std::span<const LensSurface> surfaces);

}  // namespace petzval::lens_detail
