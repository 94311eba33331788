// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace petzval::fuzz {

/// A function to be fuzzed, and its seeds.
struct Target {
  std::string_view name;
  std::string_view program;  ///< libFuzzer program; several targets may share it
  int (*function)(const std::uint8_t* data, std::size_t size);
  std::vector<std::string> (*seeds)();  ///< inputs that reach deep code
  std::size_t largest;                  ///< largest input, bytes
  int changed_seeds;                    ///< number run by the test of every build
};

/// All targets: first the targets for files, then the targets that derive lenses from bytes.
std::span<const Target> targets();

}  // namespace petzval::fuzz
