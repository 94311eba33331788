// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/instruction_set.hpp"

#include <cstddef>

namespace petzval::inline v0 {

std::string_view name(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::baseline: return "baseline";
    case InstructionSet::avx2: return "avx2";
    case InstructionSet::avx512: return "avx512";
  }
  return "unknown";
}

std::span<const InstructionSet> instruction_sets() noexcept {
  static constexpr InstructionSet all[] = {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512};
#if defined(__x86_64__)
  static const std::size_t count = [] {
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    return std::size_t{1} + (avx2 ? 1 : 0) + (avx2 && avx512 ? 1 : 0);
  }();
  return {all, count};
#else
  return {all, 1};
#endif
}

}  // namespace petzval::inline v0
