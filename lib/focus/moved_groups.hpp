// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"

namespace petzval::focus_detail {

/// with_focus() of a lens with focus positions: the groups stand where the subject's film is the lens's own.
Lens with_moved_groups(const Lens& lens, double distance, const FocusOptions& options);

}  // namespace petzval::focus_detail
