// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/instruction_set.hpp"

/// PETZVAL_WIDEST(Type, name) defines name(): the loops of a file that petzval_loops (cmake/module.cmake) compiles for
/// every instruction set, those of the widest set of this processor. Type, name: of the constants that the objects
/// define, in the namespace where the macro stands.
#if defined(__x86_64__)
#define PETZVAL_WIDEST(Type, name)                               \
  extern const Type name##_baseline, name##_avx2, name##_avx512; \
  inline const Type& name() noexcept {                           \
    static const Type& widest = []() -> const Type& {            \
      switch (instruction_sets().back()) {                       \
        case InstructionSet::avx512: return name##_avx512;       \
        case InstructionSet::avx2: return name##_avx2;           \
        case InstructionSet::baseline: break;                    \
      }                                                          \
      return name##_baseline;                                    \
    }();                                                         \
    return widest;                                               \
  }
#else
#define PETZVAL_WIDEST(Type, name)   \
  extern const Type name##_baseline; \
  inline const Type& name() noexcept { return name##_baseline; }
#endif

/// Stands before a loop in which no iteration reads what another one writes, so that the compiler may run it on lanes.
#if defined(__clang__)
#define PETZVAL_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define PETZVAL_INDEPENDENT _Pragma("GCC ivdep")
#endif
