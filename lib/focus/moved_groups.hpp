// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"

namespace petzval::focus_detail {

/// with_focus() for a lens with focus positions: moves the groups until the image of the subject lies on the film.
Lens with_moved_groups(const Lens& lens, double distance, const FocusOptions& options);

}  // namespace petzval::focus_detail
