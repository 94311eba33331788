// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "petzval/core/config.hpp"

namespace petzval {

/// Thrown if an object cannot be built or read.
///
/// The message names the object, the parameter, its value and the rule, for example
/// `data/lenses/x.json: surface 4: thickness = nan; must be finite and below 1e10 mm`. A function that throws leaves no
/// half-built object. what() is one line of at most 1,000 bytes: control characters become spaces, and longer messages
/// lose their middle.
class PETZVAL_API Error : public std::runtime_error {
 public:
  explicit Error(std::string message);
  ~Error() override;
};

}  // namespace petzval
