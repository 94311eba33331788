// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "petzval/core/config.hpp"

namespace petzval {

/// The vector instructions that loops over rays can use. Processors other than x86-64 have `baseline` only.
enum class InstructionSet : std::uint8_t { baseline, avx2, avx512 };

/// "baseline", "avx2" or "avx512".
PETZVAL_API std::string_view name(InstructionSet set) noexcept;

/// The instruction sets of this processor, narrowest first.
///
/// The environment variable PETZVAL_INSTRUCTION_SET, read by the first call, excludes all sets wider than the named
/// set; an unknown name leaves `baseline`. With `baseline` the results of batches, cameras and gathers have the same
/// bits on every processor and from every compiler, at about half the speed. Wider sets round some results differently;
/// reproducible batches (trace.hpp) and single calls have the same bits with every set.
PETZVAL_API std::span<const InstructionSet> instruction_sets() noexcept;

/// The widest set that batches traced by the calling thread use.
PETZVAL_API InstructionSet batch_instruction_set() noexcept;
/// Limits the batches of the calling thread to a set, for tests and benchmarks. Returns the previous limit.
PETZVAL_API InstructionSet limit_batches(InstructionSet widest) noexcept;

}  // namespace petzval
