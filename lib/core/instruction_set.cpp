// SPDX-License-Identifier: Apache-2.0
#include "core/instruction_set.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace petzval {

std::string_view name(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::baseline: return "baseline";
    case InstructionSet::avx2: return "avx2";
    case InstructionSet::avx512: return "avx512";
  }
  return "unknown";
}

namespace {

thread_local InstructionSet limit_of_thread = InstructionSet::avx512;

constexpr InstructionSet all[] = {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512};

/// Number of sets allowed by PETZVAL_INSTRUCTION_SET, from the narrowest: all if not set, 1 if the value is unknown.
[[maybe_unused]] std::size_t allowed() noexcept {
  const char* widest = std::getenv("PETZVAL_INSTRUCTION_SET");
  if (!widest || !*widest) return std::size(all);
  const auto found =
      std::find_if(std::begin(all), std::end(all), [&](InstructionSet set) { return name(set) == widest; });
  return found == std::end(all) ? 1 : static_cast<std::size_t>(found - std::begin(all)) + 1;
}

}  // namespace

std::span<const InstructionSet> instruction_sets() noexcept {
#if defined(__x86_64__)
  static const std::size_t count = [] {
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    return std::min(allowed(), std::size_t{1} + (avx2 ? 1 : 0) + (avx2 && avx512 ? 1 : 0));
  }();
  return {all, count};
#else
  return {all, 1};
#endif
}

InstructionSet batch_instruction_set() noexcept { return std::min(limit_of_thread, instruction_sets().back()); }

InstructionSet limit_batches(InstructionSet widest) noexcept { return std::exchange(limit_of_thread, widest); }

}  // namespace petzval
