// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/instruction_set.hpp"

/// PETZVAL_WIDEST(Type, name) defines name(): the loops compiled for the widest instruction set of this processor.
/// For files that petzval_loops (cmake/module.cmake) compiles for every instruction set. The objects define constants
/// of type `Type`, called name_baseline and so on, in the namespace in which the macro is used.
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

/// Lets the compiler vectorise the next loop, in which no iteration may read a value written by another.
#if defined(__clang__)
#define PETZVAL_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define PETZVAL_INDEPENDENT _Pragma("GCC ivdep")
#endif
