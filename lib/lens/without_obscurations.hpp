// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/lens/lens.hpp"

namespace petzval {

/// The lens without its central obscurations: its pupils hold those of the lens, and none is a ring.
PETZVAL_API Lens without_obscurations(const Lens& lens);

}  // namespace petzval
