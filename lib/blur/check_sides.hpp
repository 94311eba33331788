// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/error.hpp"

namespace petzval::blur_detail {

/// Throws Error if a picture has no pixels or more than 32768 columns or rows.
/// @param what name of the picture, for the message
inline void check_sides(const std::string& what, int columns, int rows) {
  constexpr int max_side = 32768;
  if (columns >= 1 && rows >= 1 && columns <= max_side && rows <= max_side) return;
  throw Error(what + ": columns x rows = " + std::to_string(columns) + " x " + std::to_string(rows) +
              "; must be 1 to " + std::to_string(max_side) + " pixels a side");
}

}  // namespace petzval::blur_detail
