// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "petzval/core/export.hpp"

namespace petzval {

/// Thrown when an object cannot be built or read. The message says where, what was found and what was wanted:
/// `data/lenses/x.json: surface 4: thickness is nan, wanted a finite length in mm`.
/// Functions that throw leave nothing half-built. what() is one line of at most 1,000 bytes, whatever a file contains:
/// control characters become spaces, and longer messages lose their middle.
class PETZVAL_API Error : public std::runtime_error {
 public:
  explicit Error(std::string message);
  ~Error() override;
};

}  // namespace petzval
