// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/error.hpp"

namespace petzval::testing {

/// The message of the Error that `work` throws. Any other exception fails the test.
std::string message(const auto& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace petzval::testing
