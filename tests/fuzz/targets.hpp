// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace petzval::fuzz {

/// A function to be fuzzed, and where it starts.
struct Target {
  std::string_view name;
  std::string_view program;  ///< its libFuzzer program, which several targets may share
  int (*function)(const std::uint8_t* data, std::size_t size);
  std::vector<std::string> (*seeds)();  ///< inputs that reach far
  std::size_t largest;                  ///< input, bytes
  int changed_seeds;                    ///< that the test of every build runs
};

/// All of them: files first, then those that make lenses of bytes.
std::span<const Target> targets();

}  // namespace petzval::fuzz
