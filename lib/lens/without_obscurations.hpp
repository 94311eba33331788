// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/lens/lens.hpp"

namespace petzval {

/// True if a surface has a central obscuration.
PETZVAL_API bool has_obscurations(const Lens& lens) noexcept;

/// A copy of the lens without central obscurations. Its pupils contain the pupils of the lens and are never annular.
PETZVAL_API Lens without_obscurations(const Lens& lens);

}  // namespace petzval
