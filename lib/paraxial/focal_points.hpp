// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::paraxial_detail {

/// The ideal lens with the cardinal points in `data`, without pupils. The lens must not be afocal; light may leave
/// along -z.
IdealLens focal_points(const Lens& lens, const FirstOrder& data) noexcept;

}  // namespace petzval::paraxial_detail
