// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/trace/batch.hpp"

/// The loops of a file that was compiled for every instruction set (petzval_loops in cmake/module.cmake): those for the
/// widest that this processor has. Type, name: of the constants that the objects define in petzval::detail.
#if defined(__x86_64__)
#define PETZVAL_WIDEST(Type, name)                               \
  extern const Type name##_baseline, name##_avx2, name##_avx512; \
  inline const Type& name() noexcept {                           \
    switch (instruction_sets().back()) {                         \
      case InstructionSet::avx512: return name##_avx512;         \
      case InstructionSet::avx2: return name##_avx2;             \
      case InstructionSet::baseline: break;                      \
    }                                                            \
    return name##_baseline;                                      \
  }
#else
#define PETZVAL_WIDEST(Type, name)   \
  extern const Type name##_baseline; \
  inline const Type& name() noexcept { return name##_baseline; }
#endif

/// Before a loop: what it writes is nothing that it reads in another turn, so that it can run on lanes.
#if defined(__clang__)
#define PETZVAL_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define PETZVAL_INDEPENDENT _Pragma("GCC ivdep")
#endif
