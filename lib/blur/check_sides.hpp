// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/error.hpp"

namespace petzval::blur_detail {

/// Throws Error for a picture without pixels or with more than 32768 a side. what: the picture, for the message.
inline void check_sides(const std::string& what, int columns, int rows) {
  constexpr int most = 32768;
  if (columns >= 1 && rows >= 1 && columns <= most && rows <= most) return;
  throw Error(what + " is " + std::to_string(columns) + " x " + std::to_string(rows) + ", wanted 1 to " +
              std::to_string(most) + " pixels a side");
}

}  // namespace petzval::blur_detail
