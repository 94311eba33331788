// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval {

/// The vector instructions that a processor offers to loops over rays. Processors other than x86-64 have `baseline`
/// only.
enum class InstructionSet : std::uint8_t { baseline, avx2, avx512 };

/// "baseline", "avx2" or "avx512".
PETZVAL_API std::string_view name(InstructionSet set) noexcept;

/// The sets of this processor, narrowest first.
///
/// The environment variable PETZVAL_INSTRUCTION_SET, read by the first call, leaves out those wider than the one it
/// names (a name that is none of these leaves the baseline). Under `baseline` every batch, camera and gather has the
/// same bits on every processor and from every compiler, at about half the speed; wider sets round some results
/// otherwise, which reproducible batches (trace.hpp) and single calls do not.
PETZVAL_API std::span<const InstructionSet> instruction_sets() noexcept;

}  // namespace petzval
