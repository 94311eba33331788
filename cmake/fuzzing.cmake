# SPDX-License-Identifier: Apache-2.0
# A build for fuzzing: all that is compiled below is instrumented, the loops of every instruction set too. Undefined behaviour
# ends the program, as a fault of memory does, and the standard library checks its own preconditions.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "PETZVAL_BUILD_FUZZERS: the compiler is ${CMAKE_CXX_COMPILER_ID}, wanted Clang (libFuzzer)")
endif()
set(petzval_sanitizers address,undefined)
# Traced comparisons tell the fuzzer the words of a format; in loops over numbers they take three quarters of the time and tell
# nothing. tests/fuzz has them for parsers.
add_compile_options(-fsanitize=fuzzer-no-link,${petzval_sanitizers} -fno-sanitize-coverage=trace-cmp
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer -gline-tables-only -O2 -D_GLIBCXX_ASSERTIONS)
add_link_options(-fsanitize=${petzval_sanitizers})
