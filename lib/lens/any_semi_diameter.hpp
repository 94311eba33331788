// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"

namespace petzval {

/// with_semi_diameter() without the upper limit of the prescription.
PETZVAL_API Lens with_any_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter);

}  // namespace petzval
